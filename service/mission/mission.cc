#include "service/mission/mission.h"

#include <algorithm>

#include "service/mission/course.h"
#include "service/mission/errands.h"
#include "service/mission/progress.h"
#include "service/mission/views.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr std::size_t kMaxProblems = 32;

template <class T>
bool Has(const std::vector<T>& items, const T& item) {
  return std::find(items.begin(), items.end(), item) != items.end();
}

bool IsLanded(const VehicleState& vehicle) {
  return !vehicle.armed &&
         (vehicle.phase == VehiclePhase::kOnGround || vehicle.phase == VehiclePhase::kNotReady);
}

/// One call of Advance(): what happened, and what is to be done now.
class Conductor {
 public:
  Conductor(MissionUpdate& update, std::int64_t now_utc_ns, const ViewpointOptions& viewpoints,
            const MissionOptions& options)
      : update_(update),
        m_(update.mission),
        now_(now_utc_ns),
        options_(options),
        views_(update.mission, viewpoints, options),
        errands_(update, now_utc_ns, views_, options) {}

  void Take(const MissionEvent& event) {
    if (m_.status.state == MissionState::kEnded) return;
    std::visit([this](const auto& happened) { On(happened); }, event);
    Proceed();
    TellProgress(m_);
  }

 private:
  // ---- What happened ----

  void On(const Tick&) {}

  void On(const VehicleState& state) {
    if (state.vehicle_id != m_.order.vehicle_id) return;
    if (m_.vehicle && state.agent_epoch != m_.vehicle->agent_epoch) {
      if (!IsSilent()) return MeetIntruder(state);
      MeetRestartedAgent();
    }
    m_.vehicle = state;
    m_.heard_utc_ns = now_;
    if (!IsLanded(state)) m_.landed_utc_ns = 0;
    if (IsLanded(state) && m_.landed_utc_ns == 0) m_.landed_utc_ns = now_;
  }

  void On(const CommandAck& ack) {
    if (!m_.errand || !m_.vehicle || ack.agent_epoch != m_.vehicle->agent_epoch) return;
    const FlightCommand& command = m_.errand->command;
    if (ack.vehicle_id != command.vehicle_id || ack.mission_id != command.mission_id ||
        ack.sequence != command.sequence)
      return;
    switch (ack.status) {
      case AckStatus::kAccepted:
        return OnAccepted();
      case AckStatus::kDone:
        return OnDone();
      case AckStatus::kRefused:
        return Fail(Say(ToString(command.kind), " refused: ", ack.reason));
      case AckStatus::kFailed:
        return OnFailed(ack.reason);
      case AckStatus::kUnknown:
        return;
    }
  }

  void On(const PictureResult& picture) { m_.pictures.push_back(picture); }

  void On(const Findings& findings) {
    if (!m_.is_waiting_for_findings) return;
    m_.is_waiting_for_findings = false;
    if (!findings.failure.empty()) return GoHome(MissionOutcome::kFailed, findings.failure);
    m_.findings = findings;
    m_.findings_utc_ns = now_;
    for (const std::string& problem : findings.problems) Note(problem);
    if (IsGoingHome()) return;
    const bool is_lost = m_.status.object_id != 0 && !Has(findings.wanted, m_.status.object_id);
    const bool is_recognizing = m_.status.step == MissionStep::kOverview || is_lost;
    if (is_recognizing) return BeginStep(MissionStep::kRecognize);
    if (m_.status.step == MissionStep::kTop) return BeginWalls();
    BeginStep(MissionStep::kDecide);
  }

  void On(const OperatorWish& wish) {
    if (wish == OperatorWish::kAbort) return Abort(MissionOutcome::kAborted, "aborted by the operator");
    if (wish == OperatorWish::kPause && m_.status.state != MissionState::kPaused)
      return Pause("paused by the operator");
    if (wish == OperatorWish::kResume && m_.status.state == MissionState::kPaused) return Resume();
  }

  void OnAccepted() {
    if (m_.errand->is_answered) return;
    m_.errand->is_answered = true;
    m_.errand->since_utc_ns = now_;
    if (m_.errand->command.kind == CommandKind::kFlyCorridor) m_.is_in_corridor = true;
  }

  void OnFailed(const std::string& reason) {
    const std::string what = Say(ToString(m_.errand->command.kind), " failed: ", reason);
    if (m_.errand->command.kind != CommandKind::kFlyCorridor) return Fail(what);
    m_.errand.reset();
    m_.is_in_corridor = false;  // The agent has backed out before it says so.
    GoHome(MissionOutcome::kFailed, what);
  }

  void OnDone() {
    m_.errand->is_answered = m_.errand->is_ended = true;
    m_.errand->since_utc_ns = now_;
    const CommandKind kind = m_.errand->command.kind;
    const std::vector<Eigen::Vector3d>& path = m_.errand->command.path_in_map_m;
    if (!path.empty()) m_.vehicle->position_in_map_m = path.back();  // Newer than the last state.
    if (kind == CommandKind::kLook) return;                          // Its picture is awaited.
    m_.errand.reset();
    if (kind == CommandKind::kHold || kind == CommandKind::kAbort) {
      m_.has_overrun = false;
      if (kind == CommandKind::kAbort) m_.is_in_corridor = false;
      return;
    }
    m_.failures = 0;
    switch (kind) {
      case CommandKind::kTakeOff:
        return BeginOverview();
      case CommandKind::kFlyCorridor:
        m_.is_in_corridor = false;
        return GoHome(MissionOutcome::kFlown, Say("flown through building ", m_.leave->object_id));
      case CommandKind::kGoTo:
        if (m_.status.step == MissionStep::kReturn) return BeginStep(MissionStep::kLand);
        m_.is_at_entry = true;
        return;
      case CommandKind::kLand:
        return End(m_.outcome, m_.reason);
      default:
        return;
    }
  }

  void MeetIntruder(const VehicleState& state) {
    const bool is_new =
        m_.intruder_utc_ns == 0 || now_ - m_.intruder_utc_ns > ToNanoseconds(options_.state_timeout_s);
    m_.intruder_utc_ns = now_;
    if (!is_new) return;
    Note(Say("a second agent ('", state.name, "') has the vehicle id ", state.vehicle_id,
             ": give every vehicle an id of its own; it is not listened to"));
  }

  void MeetRestartedAgent() {
    Note("the agent was restarted");
    m_.errand.reset();
    m_.has_overrun = false;
    if (m_.is_in_corridor) {
      End(MissionOutcome::kFailed,
          "the agent was restarted inside the corridor: its vehicle holds there, take over by hand");
    }
  }

  // ---- What to do now ----

  void Proceed() {
    if (m_.status.state == MissionState::kEnded) return;
    if (!m_.vehicle || IsSilent()) return AwaitVehicle();
    if (m_.status.step == MissionStep::kWaitForVehicle) return AwaitReadiness();
    if (WasLandedByOthers()) return EndOnGround();
    if (m_.vehicle->phase == VehiclePhase::kPilotInControl) return YieldToPilot();
    if (m_.errand) return Watch();
    if (m_.vehicle->phase == VehiclePhase::kNotReady)
      return Tell("the vehicle is not ready: " + m_.vehicle->message);
    if (m_.status.state == MissionState::kPaused || m_.is_waiting_for_findings || now_ < m_.retry_utc_ns)
      return;
    if (m_.has_overrun) return errands_.Hold();
    Act();
  }

  void Act() {
    switch (m_.status.step) {
      case MissionStep::kTakeOff:
        return TakeOff();
      case MissionStep::kOverview:
      case MissionStep::kTop:
      case MissionStep::kWalls:
      case MissionStep::kLookAgain:
        return LookOrAsk();
      case MissionStep::kRecognize:
        return Recognize();
      case MissionStep::kDecide:
        return Decide();
      case MissionStep::kEnter:
        return FlyThrough();
      case MissionStep::kReturn:
        return errands_.GoHome();
      case MissionStep::kLand:
        return errands_.Land();
      case MissionStep::kNone:
      case MissionStep::kWaitForVehicle:
      case MissionStep::kDone:
        return;
    }
  }

  void AwaitVehicle() {
    const std::string who = Say("vehicle ", m_.order.vehicle_id);
    if (!m_.vehicle) {
      Tell(who + ": no agent is heard");
      return;
    }
    const double silent_s = ToSeconds(now_ - m_.heard_utc_ns);
    Tell(Say(who, " is silent for ", silent_s, " s"));
    if (m_.status.step != MissionStep::kWaitForVehicle && silent_s > options_.vehicle_lost_s) {
      End(MissionOutcome::kFailed, Say(who, " is lost: silent for ", silent_s, " s"));
    }
  }

  void AwaitReadiness() {
    const VehicleState& vehicle = *m_.vehicle;
    const bool is_disputed =
        m_.intruder_utc_ns != 0 && now_ - m_.intruder_utc_ns < ToNanoseconds(options_.state_timeout_s);
    if (is_disputed) return Tell("two agents have the same vehicle id: stop one of them");
    if (!IsValid(vehicle.envelope)) return Tell("the vehicle does not state its dimensions");
    if (!IsValid(vehicle.camera)) return Tell("the vehicle does not state its camera");
    if (m_.status.state == MissionState::kPaused) return;
    const bool is_on_ground = vehicle.phase == VehiclePhase::kOnGround;
    if (!is_on_ground && vehicle.phase != VehiclePhase::kHolding) {
      return Tell(Say("vehicle ", vehicle.vehicle_id, " is ", ToString(vehicle.phase),
                      vehicle.message.empty() ? "" : ": ", vehicle.message));
    }
    m_.status.state = MissionState::kFlying;
    is_on_ground ? BeginStep(MissionStep::kTakeOff) : BeginOverview();
    Act();
  }

  /// A state may be older than the answer that ended a take-off, so only a lasting one counts.
  bool WasLandedByOthers() const {
    const bool is_lasting =
        m_.landed_utc_ns != 0 && now_ - m_.landed_utc_ns > ToNanoseconds(options_.state_timeout_s);
    return is_lasting && m_.status.step != MissionStep::kTakeOff;
  }

  void EndOnGround() {
    const bool was_meant = IsGoingHome() && m_.outcome != MissionOutcome::kNone;
    if (was_meant) return End(m_.outcome, m_.reason);
    End(MissionOutcome::kAborted, Say("the vehicle was landed by its pilot or autopilot",
                                      m_.vehicle->message.empty() ? "" : ": ", m_.vehicle->message));
  }

  void YieldToPilot() {
    m_.errand.reset();
    m_.is_at_entry = false;
    if (m_.status.state == MissionState::kPaused) return;
    m_.status.state = MissionState::kPaused;
    Tell("the pilot or a failsafe is in control: resume when the vehicle is given back");
  }

  void Pause(const std::string& why) {
    m_.status.state = MissionState::kPaused;
    m_.is_at_entry = false;
    const bool is_flying = m_.errand && !m_.errand->is_ended;
    if (is_flying && m_.status.step != MissionStep::kWaitForVehicle) errands_.Hold();
    Tell(why);
  }

  void Resume() {
    if (m_.vehicle && m_.vehicle->phase == VehiclePhase::kPilotInControl)
      return Note("not resumed: the pilot is in control");
    m_.status.state = m_.status.step == MissionStep::kWaitForVehicle ? MissionState::kWaiting
                      : IsGoingHome()                                ? MissionState::kReturning
                                                                     : MissionState::kFlying;
    Tell("resumed");
  }

  void Abort(MissionOutcome outcome, const std::string& why) {
    const bool is_on_ground = m_.status.step == MissionStep::kWaitForVehicle;
    if (is_on_ground) return End(outcome, why);
    GoHome(outcome, why);
    errands_.Abort();
  }

  /// From here on the mission is about to come home, and ends as said.
  void GoHome(MissionOutcome outcome, const std::string& why) {
    if (m_.outcome == MissionOutcome::kNone) {
      m_.outcome = outcome;
      m_.reason = why;
    }
    m_.is_waiting_for_findings = false;
    m_.status.state = MissionState::kReturning;
    BeginStep(MissionStep::kReturn);
    Tell(why + "; coming home");
  }

  void End(MissionOutcome outcome, const std::string& why) {
    m_.status.state = MissionState::kEnded;
    m_.status.outcome = outcome;
    m_.errand.reset();
    BeginStep(MissionStep::kDone);
    Tell(why);
  }

  // ---- How the errand goes ----

  void Watch() {
    const Errands::Watched watched = errands_.Watch();
    if (!watched.failure.empty()) return Fail(watched.failure);
    if (!watched.is_viewed) return;
    OnViewed();
    if (m_.status.state != MissionState::kPaused) Act();
  }

  void OnViewed() {
    m_.errand.reset();
    m_.failures = 0;
    const Viewpoint view = m_.views.front();
    m_.views.erase(m_.views.begin());
    m_.viewed.push_back(view);
    if (m_.status.step != MissionStep::kLookAgain || !m_.leave) return;
    m_.looked_along.push_back(view.position_in_map_m);
  }

  void Fail(const std::string& why) {
    m_.errand.reset();
    m_.is_at_entry = false;
    m_.retry_utc_ns = now_ + ToNanoseconds(options_.retry_delay_s);
    Note(why);
    if (++m_.failures >= options_.tries) GiveUp(why);
  }

  void GiveUp(const std::string& why) {
    m_.failures = 0;
    switch (m_.status.step) {
      case MissionStep::kTop:
      case MissionStep::kWalls:
      case MissionStep::kLookAgain:
        Note("view left out: " + (m_.views.empty() ? "" : m_.views.front().reason));
        if (!m_.views.empty()) m_.views.erase(m_.views.begin());
        return;
      case MissionStep::kOverview:
      case MissionStep::kRecognize:
      case MissionStep::kDecide:
        return GoHome(MissionOutcome::kFailed, why);
      case MissionStep::kEnter:
        if (m_.is_in_corridor) return Abort(MissionOutcome::kFailed, why);
        return GoHome(MissionOutcome::kFailed, why);
      default:
        // On the ground, or on the way home: the agent's own rule for a silent service is what is left.
        return End(m_.outcome == MissionOutcome::kNone ? MissionOutcome::kFailed : m_.outcome,
                   m_.reason.empty() ? why : m_.reason + "; " + why);
    }
  }

  // ---- Steps ----

  void BeginStep(MissionStep step) {
    m_.status.step = step;
    m_.status.step_progress_ratio = 0.0;
    m_.failures = 0;
    m_.is_at_entry = false;
    m_.landed_utc_ns = 0;
    m_.views.clear();
    m_.views_planned = 0;
  }

  void BeginOverview() {
    BeginStep(MissionStep::kOverview);
    PlanViews({views_.Overview()});
  }

  /// A step that is made of pictures, begun at once.
  void Look(MissionStep step, std::vector<Viewpoint> views) {
    BeginStep(step);
    PlanViews(std::move(views));
    Act();
  }

  void PlanViews(std::vector<Viewpoint> views) {
    m_.views = std::move(views);
    m_.views_planned = m_.views.size();
  }

  void TakeOff() {
    Tell(Say("taking off to ", views_.Overview().position_in_map_m.z(), " m"));
    errands_.TakeOff();
  }

  void LookOrAsk() {
    if (m_.views.empty()) return AskForFindings();
    const Viewpoint& view = m_.views.front();
    const std::size_t number = m_.views_planned - m_.views.size() + 1;
    Tell(Say("picture ", number, " of ", m_.views_planned, ": ", ToString(view.purpose),
             view.reason.empty() ? "" : ", ", view.reason));
    errands_.Look(view);
  }

  void AskForFindings() {
    Tell(Say("working on ", m_.viewed.size(), m_.viewed.size() == 1 ? " picture" : " pictures"));
    m_.is_waiting_for_findings = true;
    update_.wants_findings = true;
  }

  void Recognize() {
    const Findings& findings = *m_.findings;
    if (BeginNextBuilding()) return;
    if (!m_.settled.empty()) return GoHomeUnflown();
    std::vector<Viewpoint> views = views_.ToRecognize();
    if (!views.empty()) return Look(MissionStep::kOverview, std::move(views));
    if (findings.is_ambiguous) {
      return GoHome(MissionOutcome::kAmbiguous,
                    "the wanted building was found in several places that fit about as well");
    }
    GoHome(MissionOutcome::kNoMatch,
           Say("the wanted building is not among the ", findings.map.size(), " that were seen"));
  }

  /// False when all wanted buildings are settled.
  bool BeginNextBuilding() {
    for (const std::uint32_t id : m_.findings->wanted) {
      if (Has(m_.settled, id)) continue;
      BeginBuilding(id);
      return true;
    }
    return false;
  }

  void BeginBuilding(std::uint32_t object_id) {
    m_.status.object_id = object_id;
    m_.more_views_used = 0;
    m_.leave.reset();
    Look(MissionStep::kTop, {views_.Top(object_id)});
  }

  /// The vehicle goes down beside a building only where a picture from above showed what else stands there.
  void BeginWalls() {
    const std::uint32_t id = m_.status.object_id;
    const std::vector<Viewpoint> walls = views_.Walls(id);
    std::vector<Viewpoint> safe = views_.OverSeenGround(walls);
    if (safe.size() < walls.size() && m_.looked_around_id != id) {
      m_.looked_around_id = id;
      return PlanViews({views_.Around(id, walls)});
    }
    BeginStep(MissionStep::kWalls);
    PlanViews(std::move(safe));
  }

  void Decide() {
    const Course course = ChooseCourse(m_);
    if (course.leave && course.was_looked_along) return BeginCorridor(*course.leave);
    if (course.leave) return LookAlong(*course.leave);
    for (const Viewpoint& view : course.wanted) {
      if (views_.CanLookAt(view)) return LookAgain(view);
    }
    Settle(course.is_blocked, course.reasons);
  }

  void LookAgain(const Viewpoint& view) {
    ++m_.more_views_used;
    m_.leave.reset();
    Look(MissionStep::kLookAgain, {view});
  }

  void LookAlong(const ClearanceDecision& decision) {
    if (m_.more_views_used > options_.more_views) {
      return Settle(false, "no picture along the corridor could be taken");
    }
    ++m_.more_views_used;
    m_.leave = decision;
    Look(MissionStep::kLookAgain, {views_.Along(*decision.corridor)});
  }

  void BeginCorridor(const ClearanceDecision& decision) {
    m_.leave = decision;
    BeginStep(MissionStep::kEnter);
    Act();
  }

  /// No way through this building: on to the next one, or home.
  void Settle(bool is_blocked, const std::string& why) {
    m_.settled.push_back(m_.status.object_id);
    m_.settled_reasons.push_back(Say("building ", m_.status.object_id, ": ", why));
    m_.is_any_unsettled = m_.is_any_unsettled || !is_blocked;
    if (!BeginNextBuilding()) GoHomeUnflown();
  }

  void GoHomeUnflown() {
    std::string reasons;
    for (const std::string& reason : m_.settled_reasons) reasons += (reasons.empty() ? "" : "; ") + reason;
    GoHome(m_.is_any_unsettled ? MissionOutcome::kInsufficientData : MissionOutcome::kBlocked, reasons);
  }

  void FlyThrough() {
    const ClearanceDecision leave = *m_.leave;
    const Corridor& corridor = *leave.corridor;
    if (!m_.is_at_entry && !m_.is_in_corridor) {
      Tell(Say("going to the corridor's entry of building ", leave.object_id));
      return errands_.GoToEntry(corridor);
    }
    const std::int64_t valid_until_utc_ns = m_.findings_utc_ns + ToNanoseconds(options_.permit_valid_s);
    if (now_ > valid_until_utc_ns && !m_.is_in_corridor) {
      Note("the decision has expired: looking again");
      if (const auto place = PlaceOfLookAlong(corridor, m_)) std::erase(m_.looked_along, *place);
      return LookAlong(leave);
    }
    Tell(Say("flying through building ", leave.object_id, ": ", corridor.free_width_m, " m wide, ",
             corridor.free_height_m, " m high"));
    errands_.FlyThrough(leave, valid_until_utc_ns);
  }

  // ---- Small things ----

  bool IsSilent() const { return now_ - m_.heard_utc_ns > ToNanoseconds(options_.state_timeout_s); }
  bool IsGoingHome() const {
    return m_.status.step == MissionStep::kReturn || m_.status.step == MissionStep::kLand;
  }

  void Tell(const std::string& message) { m_.status.message = message; }

  void Note(const std::string& problem) {
    auto& problems = m_.status.problems;
    if (!problems.empty() && problems.back() == problem) return;
    problems.push_back(problem);
    if (problems.size() > kMaxProblems) problems.erase(problems.begin());
  }

  MissionUpdate& update_;
  Mission& m_;
  std::int64_t now_;
  const MissionOptions& options_;
  ViewPlanner views_;
  Errands errands_;
};

}  // namespace

Mission StartMission(const MissionOrder& order) {
  Mission mission;
  mission.order = order;
  mission.status.state = MissionState::kWaiting;
  mission.status.step = MissionStep::kWaitForVehicle;
  mission.status.message = "waiting for vehicle " + std::to_string(order.vehicle_id);
  return mission;
}

Mission ContinueMission(Mission mission, std::int64_t now_utc_ns, const MissionOptions& options) {
  mission.heard_utc_ns = now_utc_ns - ToNanoseconds(options.state_timeout_s) - 1;
  mission.landed_utc_ns = 0;
  mission.intruder_utc_ns = 0;
  if (!mission.errand) return mission;
  mission.errand->since_utc_ns = now_utc_ns;
  mission.errand->sent_utc_ns = 0;
  if (!mission.errand->is_ended) mission.errand->is_answered = false;
  return mission;
}

MissionUpdate Advance(Mission mission, const MissionEvent& event, std::int64_t now_utc_ns,
                      const ViewpointOptions& viewpoints, const MissionOptions& options) {
  MissionUpdate update;
  update.mission = std::move(mission);
  Conductor(update, now_utc_ns, viewpoints, options).Take(event);
  return update;
}

}  // namespace soffit
