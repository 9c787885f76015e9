#include "service/mission/mission.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "service/mission/transit.h"

namespace soffit {
namespace {

constexpr std::size_t kMaxProblems = 32;
constexpr double kSameDimension_m = 1e-6;
constexpr double kSamePlace_m = 0.3;
constexpr double kSameAngle_rad = 0.1;
constexpr double kHigherOverview_ratio = 1.4;
constexpr int kMaxOverviews = 2;
constexpr double kCommandGrace_s = 60.0;

std::int64_t Nanoseconds(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

template <class... Parts>
std::string Say(const Parts&... parts) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(2);
  (text << ... << parts);
  return text.str();
}

template <class T>
bool Has(const std::vector<T>& items, const T& item) {
  return std::find(items.begin(), items.end(), item) != items.end();
}

bool IsSame(const VehicleEnvelope& a, const VehicleEnvelope& b) {
  return std::abs(a.radius_m - b.radius_m) <= kSameDimension_m &&
         std::abs(a.height_m - b.height_m) <= kSameDimension_m &&
         std::abs(a.safety_margin_m - b.safety_margin_m) <= kSameDimension_m;
}

bool IsSame(const Viewpoint& a, const Viewpoint& b) {
  return (a.position_in_map_m - b.position_in_map_m).norm() < kSamePlace_m &&
         std::abs(std::remainder(a.yaw_rad - b.yaw_rad, 2.0 * M_PI)) < kSameAngle_rad &&
         std::abs(a.pitch_rad - b.pitch_rad) < kSameAngle_rad;
}

double LeastMargin(const ClearanceDecision& d) {
  return std::min({d.margin_left_m, d.margin_right_m, d.margin_up_m, d.margin_down_m});
}

bool IsLanded(const VehicleState& vehicle) {
  return !vehicle.armed &&
         (vehicle.phase == VehiclePhase::kOnGround || vehicle.phase == VehiclePhase::kNotReady);
}

/// Begin of each step within the mission; the end is the begin of the next one.
double BeginOf(MissionStep step) {
  switch (step) {
    case MissionStep::kNone:
    case MissionStep::kWaitForVehicle:
      return 0.0;
    case MissionStep::kTakeOff:
      return 0.02;
    case MissionStep::kOverview:
      return 0.08;
    case MissionStep::kRecognize:
      return 0.18;
    case MissionStep::kTop:
      return 0.20;
    case MissionStep::kWalls:
      return 0.30;
    case MissionStep::kDecide:
      return 0.62;
    case MissionStep::kLookAgain:
      return 0.65;
    case MissionStep::kEnter:
      return 0.75;
    case MissionStep::kReturn:
      return 0.86;
    case MissionStep::kLand:
      return 0.95;
    case MissionStep::kDone:
      break;
  }
  return 1.0;
}

MissionStep Next(MissionStep step) { return static_cast<MissionStep>(static_cast<int>(step) + 1); }

/// One call of Advance(): the mission, the moment, and what is to be sent.
class Conductor {
 public:
  Conductor(Mission mission, std::int64_t now_utc_ns, const ViewpointOptions& viewpoints,
            const MissionOptions& options)
      : m_(std::move(mission)), now_(now_utc_ns), viewpoints_(viewpoints), options_(options) {}

  MissionUpdate Run(const MissionEvent& event) && {
    if (m_.status.state != MissionState::kEnded) {
      std::visit([this](const auto& happened) { On(happened); }, event);
      Proceed();
      TellProgress();
    }
    return {std::move(m_), std::move(commands_), wants_findings_};
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
        return BeginStep(MissionStep::kOverview);
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
        m_.intruder_utc_ns == 0 || now_ - m_.intruder_utc_ns > Nanoseconds(options_.state_timeout_s);
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
    if (m_.has_overrun) return Send(Command(CommandKind::kHold));
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
        return Return();
      case MissionStep::kLand:
        return Send(Command(CommandKind::kLand));
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
    const double silent_s = static_cast<double>(now_ - m_.heard_utc_ns) * 1e-9;
    Tell(Say(who, " is silent for ", silent_s, " s"));
    if (m_.status.step != MissionStep::kWaitForVehicle && silent_s > options_.vehicle_lost_s) {
      End(MissionOutcome::kFailed, Say(who, " is lost: silent for ", silent_s, " s"));
    }
  }

  void AwaitReadiness() {
    const VehicleState& vehicle = *m_.vehicle;
    const bool is_disputed =
        m_.intruder_utc_ns != 0 && now_ - m_.intruder_utc_ns < Nanoseconds(options_.state_timeout_s);
    if (is_disputed) return Tell("two agents have the same vehicle id: stop one of them");
    if (!IsValid(vehicle.envelope)) return Tell("the vehicle does not state its dimensions");
    if (!IsValid(vehicle.camera)) return Tell("the vehicle does not state its camera");
    if (m_.status.state == MissionState::kPaused) return;
    if (vehicle.phase == VehiclePhase::kOnGround) return StartFlying(MissionStep::kTakeOff);
    if (vehicle.phase == VehiclePhase::kHolding) return StartFlying(MissionStep::kOverview);
    Tell(Say("vehicle ", vehicle.vehicle_id, " is ", ToString(vehicle.phase),
             vehicle.message.empty() ? "" : ": ", vehicle.message));
  }

  void StartFlying(MissionStep step) {
    m_.status.state = MissionState::kFlying;
    BeginStep(step);
    Act();
  }

  /// A state may be older than the answer that ended a take-off, so only a lasting one counts.
  bool WasLandedByOthers() const {
    const bool is_lasting =
        m_.landed_utc_ns != 0 && now_ - m_.landed_utc_ns > Nanoseconds(options_.state_timeout_s);
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
    if (is_flying && m_.status.step != MissionStep::kWaitForVehicle) Send(Command(CommandKind::kHold));
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
    Send(Command(CommandKind::kAbort));
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

  // ---- Errands: one command at a time ----

  FlightCommand Command(CommandKind kind) const {
    FlightCommand command;
    command.vehicle_id = m_.order.vehicle_id;
    command.mission_id = m_.order.mission_id;
    command.kind = kind;
    command.yaw_rad = m_.vehicle ? m_.vehicle->yaw_rad : 0.0;
    return command;
  }

  FlightCommand FlyTo(CommandKind kind, std::vector<Eigen::Vector3d> path, double yaw_rad,
                      double speed_mps) const {
    FlightCommand command = Command(kind);
    command.path_in_map_m = std::move(path);
    command.yaw_rad = yaw_rad;
    const double limit_mps = m_.vehicle->max_speed_mps;
    command.speed_mps = limit_mps > 0.0 ? std::min(speed_mps, limit_mps) : speed_mps;
    return command;
  }

  void Send(FlightCommand command) {
    command.sequence = ++m_.last_sequence;
    Errand errand;
    errand.since_utc_ns = now_;
    if (!command.path_in_map_m.empty() && m_.vehicle) {
      errand.start_distance_m = (command.path_in_map_m.back() - m_.vehicle->position_in_map_m).norm();
    }
    errand.command = std::move(command);
    m_.errand = std::move(errand);
    SendAgain();
  }

  void SendAgain() {
    m_.errand->command.issued_utc_ns = now_;
    m_.errand->command.valid_until_utc_ns = now_ + Nanoseconds(options_.answer_timeout_s);
    m_.errand->sent_utc_ns = now_;
    commands_.push_back(m_.errand->command);
  }

  void Watch() {
    const Errand& errand = *m_.errand;
    const double waited_s = static_cast<double>(now_ - errand.since_utc_ns) * 1e-9;
    if (errand.is_ended) return WatchPicture(waited_s);
    if (!errand.is_answered) {
      if (waited_s > options_.answer_timeout_s) {
        m_.has_overrun = true;
        return Fail(Say("no answer to '", ToString(errand.command.kind), "' for ", waited_s, " s"));
      }
      if (now_ - errand.sent_utc_ns >= Nanoseconds(options_.resend_s)) SendAgain();
      return;
    }
    if (waited_s > LongestTime_s(errand.command)) {
      m_.has_overrun = true;
      Fail(Say("'", ToString(errand.command.kind), "' is not done after ", waited_s, " s"));
    }
  }

  void WatchPicture(double waited_s) {
    const std::uint32_t capture_id = m_.errand->command.capture_id;
    const auto picture = std::find_if(m_.pictures.begin(), m_.pictures.end(),
                                      [&](const PictureResult& p) { return p.capture_id == capture_id; });
    if (picture != m_.pictures.end()) {
      if (!picture->problem.empty()) return Fail(Say("picture ", capture_id, ": ", picture->problem));
      OnViewed();
      if (m_.status.state != MissionState::kPaused) Act();
    } else if (waited_s > options_.picture_timeout_s) {
      Fail(Say("picture ", capture_id, " did not arrive within ", options_.picture_timeout_s, " s"));
    }
  }

  void OnViewed() {
    m_.errand.reset();
    m_.failures = 0;
    const Viewpoint view = m_.views.front();
    m_.views.erase(m_.views.begin());
    m_.viewed.push_back(view);
    if (m_.status.step != MissionStep::kLookAgain || !m_.leave) return;
    m_.looked_along.emplace_back(m_.leave->object_id, m_.leave->side);
    m_.look_place = view.position_in_map_m;
  }

  double LongestTime_s(const FlightCommand& command) const {
    double length_m = 0.0;
    Eigen::Vector3d from = m_.vehicle->position_in_map_m;
    for (const Eigen::Vector3d& to : command.path_in_map_m) {
      length_m += (to - from).norm();
      from = to;
    }
    const double height_m = m_.vehicle->position_in_map_m.z();
    const double speed_mps = command.speed_mps > 0.0 ? command.speed_mps : 0.5;
    return kCommandGrace_s + 3.0 * (length_m + height_m) / speed_mps;
  }

  void Fail(const std::string& why) {
    m_.errand.reset();
    m_.is_at_entry = false;
    m_.retry_utc_ns = now_ + Nanoseconds(options_.retry_delay_s);
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
    if (step == MissionStep::kOverview) PlanViews({OverviewOf(Radius_m())});
  }

  void PlanViews(std::vector<Viewpoint> views) {
    m_.views = std::move(views);
    m_.views_planned = m_.views.size();
  }

  double Radius_m() const {
    return m_.order.area_radius_m > 0.0 ? m_.order.area_radius_m : options_.area_radius_m;
  }

  Viewpoint OverviewOf(double radius_m) const {
    return PlanOverview(m_.order.area_center_in_map_m, radius_m, m_.vehicle->camera, viewpoints_);
  }

  double TransitAltitude_m() const {
    static const std::vector<Footprint> kNothing;
    return TransitAltitude(m_.findings ? m_.findings->map : kNothing, m_.vehicle->envelope,
                           options_.transit_clearance_m, OverviewOf(Radius_m()).position_in_map_m.z());
  }

  std::vector<Eigen::Vector3d> WayTo(const Eigen::Vector3d& place) const {
    return FlyOver(m_.vehicle->position_in_map_m, place, TransitAltitude_m());
  }

  void TakeOff() {
    FlightCommand command = Command(CommandKind::kTakeOff);
    const Eigen::Vector3d& home = m_.vehicle->position_in_map_m;
    command.path_in_map_m = {{home.x(), home.y(), OverviewOf(Radius_m()).position_in_map_m.z()}};
    Tell(Say("taking off to ", command.path_in_map_m[0].z(), " m"));
    Send(std::move(command));
  }

  void LookOrAsk() {
    if (m_.views.empty()) return AskForFindings();
    const Viewpoint& view = m_.views.front();
    FlightCommand command =
        FlyTo(CommandKind::kLook, WayTo(view.position_in_map_m), view.yaw_rad, options_.transit_speed_mps);
    command.camera_pitch_rad = view.pitch_rad;
    command.purpose = view.purpose;
    command.capture_id = ++m_.last_capture_id;
    const std::size_t number = m_.views_planned - m_.views.size() + 1;
    Tell(Say("picture ", number, " of ", m_.views_planned, ": ", ToString(view.purpose),
             view.reason.empty() ? "" : ", ", view.reason));
    Send(std::move(command));
  }

  void AskForFindings() {
    Tell(Say("working on ", m_.viewed.size(), m_.viewed.size() == 1 ? " picture" : " pictures"));
    m_.is_waiting_for_findings = true;
    wants_findings_ = true;
  }

  void Recognize() {
    const Findings& findings = *m_.findings;
    if (BeginNextBuilding()) return;
    if (!m_.settled.empty()) return GoHomeUnflown();
    const auto overviews = std::count_if(m_.viewed.begin(), m_.viewed.end(), [](const Viewpoint& view) {
      return view.purpose == Purpose::kOverview;
    });
    if (overviews < kMaxOverviews) return LookFromHigher();
    if (LookAtEachFromAbove()) return;
    if (findings.is_ambiguous) {
      return GoHome(MissionOutcome::kAmbiguous,
                    "the wanted building was found in several places that fit about as well");
    }
    GoHome(MissionOutcome::kNoMatch,
           Say("the wanted building is not among the ", findings.map.size(), " that were seen"));
  }

  /// Over the middle of all that was seen, and from higher: walls lean less there, nothing is cut off, and
  /// heights follow from the two places.
  void LookFromHigher() {
    Eigen::AlignedBox2d seen;
    for (const Footprint& object : m_.findings->map) {
      for (const Eigen::Vector2d& corner : object.polygon_in_map_m.outer) seen.extend(corner);
    }
    const Eigen::Vector2d center =
        seen.isEmpty() ? m_.order.area_center_in_map_m : Eigen::Vector2d(seen.center());
    const double radius_m = seen.isEmpty() ? Radius_m() : std::max(Radius_m(), seen.diagonal().norm() / 2.0);
    Viewpoint view = PlanOverview(center, radius_m, m_.vehicle->camera, viewpoints_);
    const double higher_m = OverviewOf(Radius_m()).position_in_map_m.z() * kHigherOverview_ratio;
    view.position_in_map_m.z() =
        std::min(std::max(view.position_in_map_m.z(), higher_m), viewpoints_.max_altitude_m);
    view.reason = "again from higher, over the middle of what was seen";
    BeginStep(MissionStep::kOverview);
    PlanViews({view});
    Act();
  }

  /// A building that leans or hides its foot shows its true shape from straight above. False when none is left that has
  /// not been looked at so.
  bool LookAtEachFromAbove() {
    const auto from_above = static_cast<int>(std::count_if(
        m_.viewed.begin(), m_.viewed.end(), [](const Viewpoint& view) { return view.purpose == Purpose::kTop; }));
    std::vector<Viewpoint> views;
    for (const Footprint& object : m_.findings->map) {
      if (from_above + static_cast<int>(views.size()) >= options_.candidate_views) break;
      const Viewpoint view = PlanTop(object, m_.vehicle->camera, m_.vehicle->envelope, viewpoints_);
      const bool was_viewed = std::any_of(m_.viewed.begin(), m_.viewed.end(), [&](const Viewpoint& old) {
        return old.purpose == Purpose::kTop && old.object_id == object.object_id;
      });
      if (!was_viewed) views.push_back(view);
    }
    if (views.empty()) return false;
    BeginStep(MissionStep::kOverview);
    PlanViews(std::move(views));
    Act();
    return true;
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
    BeginStep(MissionStep::kTop);
    PlanViews({PlanTop(*Find(object_id), m_.vehicle->camera, m_.vehicle->envelope, viewpoints_)});
    Act();
  }

  /// The vehicle goes down beside a building only where a picture from above showed what else stands there.
  void BeginWalls() {
    const Footprint& object = *Find(m_.status.object_id);
    std::vector<Viewpoint> walls =
        PlanWalls(object, m_.findings->map, m_.vehicle->camera, m_.vehicle->envelope, viewpoints_);
    const auto is_unseen = [&](const Viewpoint& view) { return !WasSeenFromAbove(view.position_in_map_m); };
    const bool has_unseen = std::any_of(walls.begin(), walls.end(), is_unseen);
    if (has_unseen && m_.looked_around_id != object.object_id) return LookAround(object, walls);
    std::erase_if(walls, is_unseen);
    BeginStep(MissionStep::kWalls);
    PlanViews(std::move(walls));
  }

  /// From so high that the building and the places of `walls` are in one picture.
  void LookAround(const Footprint& object, const std::vector<Viewpoint>& walls) {
    const Eigen::Vector2d center = Centroid(object.polygon_in_map_m);
    double radius_m = 0.0;
    for (const Viewpoint& wall : walls) {
      radius_m = std::max(radius_m, (wall.position_in_map_m.head<2>() - center).norm());
    }
    Viewpoint view = PlanOverview(center, radius_m + 2.0 * KeepOff_m(), m_.vehicle->camera, viewpoints_);
    view.purpose = Purpose::kTop;
    view.object_id = object.object_id;
    view.reason = "the ground around it, where wall views are planned";
    m_.looked_around_id = object.object_id;
    PlanViews({view});
    Act();
  }

  double KeepOff_m() const { return m_.vehicle->envelope.radius_m + m_.vehicle->envelope.safety_margin_m; }

  bool WasSeenFromAbove(const Eigen::Vector3d& place) const {
    const Intrinsics& camera = m_.vehicle->camera;
    const double reach_ratio =
        0.5 * std::min(camera.width_px / camera.fx_px, camera.height_px / camera.fy_px);
    return std::any_of(m_.viewed.begin(), m_.viewed.end(), [&](const Viewpoint& view) {
      if (view.purpose != Purpose::kOverview && view.purpose != Purpose::kTop) return false;
      const double reach_m = view.position_in_map_m.z() * reach_ratio;
      return (place - view.position_in_map_m).head<2>().norm() + KeepOff_m() <= reach_m;
    });
  }

  const Footprint* Find(std::uint32_t object_id) const {
    const auto& map = m_.findings->map;
    const auto found =
        std::find_if(map.begin(), map.end(), [&](const Footprint& f) { return f.object_id == object_id; });
    if (found == map.end()) throw ContractViolation("Findings: a wanted building is not in the map");
    return &*found;
  }

  void Decide() {
    std::vector<const ClearanceDecision*> open;
    const ClearanceDecision* best = nullptr;
    std::string reasons;
    for (const ClearanceDecision& decision : m_.findings->decisions) {
      if (decision.object_id != m_.status.object_id) continue;
      if (GivesLeave(decision) && (!best || IsBetter(decision, *best))) best = &decision;
      if (decision.verdict != Verdict::kBlocked) open.push_back(&decision);
      if (reasons.find(decision.reason) == std::string::npos)
        reasons += (reasons.empty() ? "" : "; ") + decision.reason;
    }
    if (best && WasLookedAlong(*best)) return BeginCorridor(*best);
    if (best) return LookAlong(*best);
    for (const ClearanceDecision* decision : open) {
      if (decision->wanted && CanLookAt(*decision->wanted)) return LookAgain(*decision->wanted);
    }
    Settle(open.empty() && !reasons.empty(), reasons.empty() ? "no decision could be made" : reasons);
  }

  bool GivesLeave(const ClearanceDecision& decision) const {
    return decision.verdict == Verdict::kClear && decision.corridor && decision.decision_id != 0 &&
           decision.scene_revision == m_.findings->scene_revision &&
           IsSame(decision.vehicle, m_.vehicle->envelope);
  }

  bool WasLookedAlong(const ClearanceDecision& decision) const {
    return Has(m_.looked_along, std::make_pair(decision.object_id, decision.side));
  }

  bool IsBetter(const ClearanceDecision& a, const ClearanceDecision& b) const {
    if (WasLookedAlong(a) != WasLookedAlong(b)) return WasLookedAlong(a);
    return LeastMargin(a) > LeastMargin(b);
  }

  bool CanLookAt(const Viewpoint& view) const {
    if (m_.more_views_used >= options_.more_views) return false;
    if (std::any_of(m_.viewed.begin(), m_.viewed.end(),
                    [&](const Viewpoint& old) { return IsSame(old, view); }))
      return false;
    if (!WasSeenFromAbove(view.position_in_map_m)) return false;
    const double keep_off_m = KeepOff_m();
    const Eigen::Vector2d place = view.position_in_map_m.head<2>();
    return std::all_of(m_.findings->map.begin(), m_.findings->map.end(), [&](const Footprint& f) {
      const bool is_above =
          view.position_in_map_m.z() > f.height_m + m_.vehicle->envelope.NeededHeight_m() && f.height_m > 0.0;
      const Ring& ring = f.polygon_in_map_m.outer;
      return is_above || (!Contains(ring, place) && DistanceToRing(place, ring) >= keep_off_m);
    });
  }

  void LookAgain(const Viewpoint& view) {
    ++m_.more_views_used;
    m_.leave.reset();
    BeginStep(MissionStep::kLookAgain);
    PlanViews({view});
    Act();
  }

  void LookAlong(const ClearanceDecision& decision) {
    if (m_.more_views_used >= options_.more_views) {
      return Settle(false, "no picture along the corridor could be taken");
    }
    ++m_.more_views_used;
    const Corridor& corridor = *decision.corridor;
    const Viewpoint view = PlanCorridorLook(corridor.entry_in_map_m, corridor.exit_in_map_m, m_.findings->map,
                                            m_.vehicle->camera, m_.vehicle->envelope, viewpoints_);
    m_.leave = decision;
    BeginStep(MissionStep::kLookAgain);
    PlanViews({view});
    Act();
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
    const Corridor& corridor = *m_.leave->corridor;
    const std::int64_t valid_until = m_.findings_utc_ns + Nanoseconds(options_.permit_valid_s);
    const Eigen::Vector3d way = corridor.exit_in_map_m - corridor.entry_in_map_m;
    const double yaw_rad = std::atan2(way.y(), way.x());
    const Eigen::Vector3d& position = m_.vehicle->position_in_map_m;
    if (!m_.is_at_entry && !m_.is_in_corridor) {
      const bool is_straight = m_.look_place && (position - *m_.look_place).norm() < 2.0 * kSamePlace_m;
      std::vector<Eigen::Vector3d> path;
      if (!is_straight && m_.look_place) path = WayTo(*m_.look_place);
      path.push_back(corridor.entry_in_map_m);
      Tell(Say("going to the corridor's entry of building ", m_.leave->object_id));
      return Send(FlyTo(CommandKind::kGoTo, std::move(path), yaw_rad, options_.corridor_speed_mps));
    }
    if (now_ > valid_until && !m_.is_in_corridor) {
      Note("the decision has expired: looking again");
      std::erase(m_.looked_along, std::make_pair(m_.leave->object_id, m_.leave->side));
      return LookAlong(ClearanceDecision(*m_.leave));
    }
    FlightCommand command =
        FlyTo(CommandKind::kFlyCorridor, {corridor.entry_in_map_m, corridor.exit_in_map_m}, yaw_rad,
              options_.corridor_speed_mps);
    command.permit =
        CorridorPermit{m_.leave->decision_id, m_.leave->object_id,   m_.leave->scene_revision, valid_until,
                       m_.leave->vehicle,     corridor.free_width_m, corridor.free_height_m};
    Tell(Say("flying through building ", m_.leave->object_id, ": ", corridor.free_width_m, " m wide, ",
             corridor.free_height_m, " m high"));
    Send(std::move(command));
  }

  void Return() {
    const Eigen::Vector3d home(0.0, 0.0, TransitAltitude_m());
    Send(FlyTo(CommandKind::kGoTo, WayTo(home), m_.vehicle->yaw_rad, options_.transit_speed_mps));
  }

  // ---- Small things ----

  bool IsSilent() const { return now_ - m_.heard_utc_ns > Nanoseconds(options_.state_timeout_s); }
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

  void TellProgress() {
    MissionStatus& status = m_.status;
    double ratio = 0.0;
    if (m_.errand && m_.vehicle && !m_.errand->command.path_in_map_m.empty() &&
        m_.errand->start_distance_m > 0.1) {
      const double left_m = (m_.errand->command.path_in_map_m.back() - m_.vehicle->position_in_map_m).norm();
      ratio = std::clamp(1.0 - left_m / m_.errand->start_distance_m, 0.0, 1.0);
    }
    if (m_.views_planned > 0) {
      const auto done = static_cast<double>(m_.views_planned - m_.views.size());
      ratio = std::min(1.0, (done + ratio) / static_cast<double>(m_.views_planned));
    }
    status.step_progress_ratio = std::max(status.step_progress_ratio, ratio);
    if (status.step == MissionStep::kDone) status.step_progress_ratio = 1.0;
    const double begin = BeginOf(status.step);
    const double end = status.step == MissionStep::kDone ? 1.0 : BeginOf(Next(status.step));
    status.progress_ratio =
        std::max(status.progress_ratio, begin + (end - begin) * status.step_progress_ratio);
  }

  Mission m_;
  std::int64_t now_;
  const ViewpointOptions& viewpoints_;
  const MissionOptions& options_;
  std::vector<FlightCommand> commands_;
  bool wants_findings_ = false;
};

}  // namespace

const char* ToString(MissionState state) {
  switch (state) {
    case MissionState::kNone:
      return "none";
    case MissionState::kWaiting:
      return "waiting";
    case MissionState::kFlying:
      return "flying";
    case MissionState::kPaused:
      return "paused";
    case MissionState::kReturning:
      return "returning";
    case MissionState::kEnded:
      return "ended";
  }
  return "none";
}

const char* ToString(MissionStep step) {
  switch (step) {
    case MissionStep::kNone:
      return "none";
    case MissionStep::kWaitForVehicle:
      return "wait for vehicle";
    case MissionStep::kTakeOff:
      return "take off";
    case MissionStep::kOverview:
      return "overview";
    case MissionStep::kRecognize:
      return "recognize";
    case MissionStep::kTop:
      return "top";
    case MissionStep::kWalls:
      return "walls";
    case MissionStep::kDecide:
      return "decide";
    case MissionStep::kLookAgain:
      return "look again";
    case MissionStep::kEnter:
      return "enter";
    case MissionStep::kReturn:
      return "return";
    case MissionStep::kLand:
      return "land";
    case MissionStep::kDone:
      return "done";
  }
  return "none";
}

const char* ToString(MissionOutcome outcome) {
  switch (outcome) {
    case MissionOutcome::kNone:
      return "none";
    case MissionOutcome::kFlown:
      return "flown";
    case MissionOutcome::kBlocked:
      return "blocked";
    case MissionOutcome::kInsufficientData:
      return "insufficient data";
    case MissionOutcome::kNoMatch:
      return "no match";
    case MissionOutcome::kAmbiguous:
      return "ambiguous";
    case MissionOutcome::kAborted:
      return "aborted";
    case MissionOutcome::kFailed:
      return "failed";
  }
  return "none";
}

Mission StartMission(const MissionOrder& order) {
  Mission mission;
  mission.order = order;
  mission.status.state = MissionState::kWaiting;
  mission.status.step = MissionStep::kWaitForVehicle;
  mission.status.message = "waiting for vehicle " + std::to_string(order.vehicle_id);
  return mission;
}

MissionUpdate Advance(Mission mission, const MissionEvent& event, std::int64_t now_utc_ns,
                      const ViewpointOptions& viewpoints, const MissionOptions& options) {
  return Conductor(std::move(mission), now_utc_ns, viewpoints, options).Run(event);
}

}  // namespace soffit
