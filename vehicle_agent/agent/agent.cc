#include "vehicle_agent/agent/agent.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr double kDownIsBelow_rad = -std::numbers::pi / 4.0;  // Steeper looks use the downward camera.
constexpr double kStopDeceleration_mps2 = 2.0;
constexpr double kStopTimeout_s = 15.0;
constexpr double kPatience = 3.0;      // A path may take so many times as long as planned, and
constexpr double kPathGrace_s = 30.0;  // this much more.
constexpr double kClimbTolerance_m = 0.4;
constexpr double kClimbEndSpeed_mps = 0.4;
constexpr double kSlowDescent_mps = 0.25;  // Landing is given up when it takes longer than so.
constexpr double kDescentGrace_s = 60.0;
constexpr double kLostPosition_s = 3.0;
constexpr double kRivalTimeout_s = 3.0;
constexpr double kCrossTrackFilter_s = 0.4;
constexpr double kMaxStep_s = 0.25;
constexpr double kGimbalTolerance_rad = 0.05;
constexpr std::size_t kMaxAnswers = 256;
constexpr std::size_t kMaxOldMissions = 256;

double AngleBetween(double a_rad, double b_rad) {
  return std::abs(std::remainder(a_rad - b_rad, 2.0 * std::numbers::pi));
}

/// The nearest point to `position` between entry and exit.
Eigen::Vector3d NearestOnLine(const Eigen::Vector3d& position, const Eigen::Vector3d& entry,
                              const Eigen::Vector3d& exit) {
  const Eigen::Vector3d way = exit - entry;
  return entry + way * std::clamp((position - entry).dot(way) / way.squaredNorm(), 0.0, 1.0);
}

bool IsPathStage(Stage::Kind kind) {
  return kind == Stage::Kind::kFly || kind == Stage::Kind::kAlign || kind == Stage::Kind::kPass ||
         kind == Stage::Kind::kBackOut;
}

}  // namespace

Agent::Agent(AgentIdentity identity, AgentOptions options, GuardOptions guard, Instant now)
    : identity_(std::move(identity)),
      options_(options),
      guard_(std::move(guard)),
      began_(now),
      last_beat_(now),
      service_heard_(now) {}

AgentOutputs Agent::Step(const AgentEvent& event, Instant now) {
  outputs_ = {};
  std::visit([&](const auto& it) { Handle(it, now); }, event);
  return std::move(outputs_);
}

// ---- What is heard ----

void Agent::Handle(const Telemetry& telemetry, Instant now) {
  telemetry_ = telemetry;
  if (telemetry_.has_position) position_seen_ = now;
  if (!IsAirborne()) {
    greatest_height_m_ = 0.0;
  } else if (telemetry_.has_position) {
    greatest_height_m_ = std::max(greatest_height_m_, telemetry_.position_in_map_m.z());
  }
}

void Agent::Handle(const ServiceHeartbeat& heartbeat, Instant now) {
  const bool is_old =
      std::find(old_missions_.begin(), old_missions_.end(), heartbeat.mission_id) != old_missions_.end();
  if (!is_old) service_heard_ = now;
}

void Agent::Handle(const PictureOutcome& outcome, Instant) {
  if (progress_.request_id == outcome.request_id) progress_.picture = outcome;
}

void Agent::Handle(const CameraHealth& health, Instant) { cameras_ = health; }

void Agent::Handle(const RivalHeard& rival, Instant now) {
  const bool is_new =
      !rival_ || rival_->epoch != rival.epoch || !(SecondsBetween(rival_heard_, now) < kRivalTimeout_s);
  rival_ = rival;
  rival_heard_ = now;
  if (!is_new) return;
  Note(Say("another agent, '", rival.name, "', says that it flies vehicle ", identity_.vehicle_id, "; ",
           rival.epoch < identity_.epoch ? "it was there first: this one gives way and commands nothing"
                                         : "this one was there first and goes on"));
}

bool Agent::GivesWayToRival(Instant now) const {
  return rival_ && rival_->epoch < identity_.epoch && SecondsBetween(rival_heard_, now) < kRivalTimeout_s;
}

bool Agent::IsServiceSilent(Instant now) const {
  return SecondsBetween(service_heard_, now) > options_.hold_after_silence_s;
}

// ---- Commands ----

void Agent::Handle(const FlightCommand& command, Instant now) {
  if (command.vehicle_id != identity_.vehicle_id || GivesWayToRival(now)) return;
  if (SecondsBetween(began_, now) < options_.rival_listen_s) return;
  if (command.mission_id == mission_id_ && mission_id_ != 0) {
    const auto known = answers_.find(command.sequence);
    if (known != answers_.end()) {
      service_heard_ = now;
      known->second.stamp_utc_ns = now.utc_ns;
      outputs_.acks.push_back(known->second);
      return;
    }
  }
  const GuardContext context = MakeContext(command, now);
  const std::string misaddressed = FindAddressProblem(command, context);
  if (!misaddressed.empty()) return Answer(command, AckStatus::kRefused, misaddressed, now);
  if (command.mission_id != mission_id_) BeginMission(command.mission_id);
  service_heard_ = now;
  last_sequence_ = command.sequence;
  const std::string reason = FindReasonToRefuse(command, context, guard_, now.utc_ns);
  if (!reason.empty()) {
    Note(Say("refused command ", command.sequence, " (", ToString(command.kind), "): ", reason));
    return Answer(command, AckStatus::kRefused, reason, now);
  }
  if (command.permit)
    newest_scene_revision_ = std::max(newest_scene_revision_, command.permit->scene_revision);
  Begin(command, now);
}

GuardContext Agent::MakeContext(const FlightCommand& command, Instant now) const {
  GuardContext context;
  context.vehicle_id = identity_.vehicle_id;
  context.envelope = identity_.envelope;
  context.phase = PhaseOf(now);
  if (context.phase == VehiclePhase::kNotReady)
    context.not_ready = "the vehicle is not ready; " + MessageOf(now);
  context.is_in_air = IsAirborne();
  context.is_in_corridor = corridor_.has_value();
  context.is_busy = command_.has_value();
  context.position_in_map_m = telemetry_.position_in_map_m;
  context.battery_ratio = telemetry_.battery_ratio;
  context.mission_id = mission_id_;
  context.last_sequence = last_sequence_;
  context.old_missions = old_missions_;
  context.newest_scene_revision = newest_scene_revision_;
  context.has_camera = ChooseCamera(command.camera_pitch_rad).has_value();
  for (const auto& [camera, problem] : cameras_.problems) {
    context.missing_cameras.push_back(std::string(ToString(camera)) + " camera: " + problem);
  }
  return context;
}

void Agent::BeginMission(std::uint64_t mission_id) {
  if (mission_id_ != 0) old_missions_.push_back(mission_id_);
  if (old_missions_.size() > kMaxOldMissions) old_missions_.erase(old_missions_.begin());
  mission_id_ = mission_id;
  last_sequence_ = 0;
  newest_scene_revision_ = 0;
  answers_.clear();
}

void Agent::Answer(const FlightCommand& command, AckStatus status, const std::string& reason, Instant now) {
  CommandAck ack;
  ack.vehicle_id = identity_.vehicle_id;
  ack.mission_id = command.mission_id;
  ack.sequence = command.sequence;
  ack.agent_epoch = identity_.epoch;
  ack.stamp_utc_ns = now.utc_ns;
  ack.status = status;
  ack.reason = reason;
  outputs_.acks.push_back(ack);
  if (command.mission_id != mission_id_ || command.sequence > last_sequence_) return;
  if (status == AckStatus::kRefused && answers_.contains(command.sequence)) return;
  answers_[command.sequence] = ack;
  if (answers_.size() > kMaxAnswers) answers_.erase(answers_.begin());
}

void Agent::FinishCommand(AckStatus status, const std::string& reason, Instant now) {
  if (!command_) return;
  const FlightCommand finished = *std::exchange(command_, std::nullopt);
  Note(Say("command ", finished.sequence, " (", ToString(finished.kind), ") ", ToString(status),
           reason.empty() ? "" : ": ", reason));
  Answer(finished, status, reason, now);
}

void Agent::Begin(const FlightCommand& command, Instant now) {
  FinishCommand(AckStatus::kFailed,
                Say("superseded by command ", command.sequence, " (", ToString(command.kind), ")"), now);
  Note(Say("command ", command.sequence, " (", ToString(command.kind), ") accepted"));
  Answer(command, AckStatus::kAccepted, {}, now);
  command_ = command;
  return_reason_.clear();
  if (IsStopping(command.kind) && !IsAirborne()) {
    SetPlan({});
    intent_ = {};
    if (telemetry_.is_armed) SetPlan({Stage{Stage::Kind::kDescend}});  // It may be about to lift off.
    return FinishCommand(AckStatus::kDone, {}, now);
  }
  SetPlan(MakePlan(command));
}

std::deque<Stage> Agent::MakePlan(const FlightCommand& command) const {
  Stage fly{Stage::Kind::kFly, command.path_in_map_m};
  fly.speed_mps = command.speed_mps;
  fly.yaw_rad = command.yaw_rad;
  switch (command.kind) {
    case CommandKind::kTakeOff: {
      Stage climb{Stage::Kind::kClimb};
      climb.height_m = command.path_in_map_m.front().z();
      return {climb};
    }
    case CommandKind::kGoTo:
      return {fly};
    case CommandKind::kLook: {
      fly.camera_pitch_rad = command.camera_pitch_rad;
      Stage settle = fly;
      settle.kind = Stage::Kind::kSettle;
      Stage expose = fly;
      expose.kind = Stage::Kind::kExpose;
      return {fly, settle, expose};
    }
    case CommandKind::kFlyCorridor: {
      const Eigen::Vector3d& exit = command.path_in_map_m.back();
      const Eigen::Vector3d start =
          NearestOnLine(telemetry_.position_in_map_m, command.path_in_map_m.front(), exit);
      Stage align = fly;
      align.kind = Stage::Kind::kAlign;
      align.path = {start};
      Stage pass = fly;
      pass.kind = Stage::Kind::kPass;
      pass.path = {exit};
      return {align, pass};
    }
    case CommandKind::kLand: {
      if (command.path_in_map_m.empty()) return {Stage{Stage::Kind::kDescend}};
      return {fly, Stage{Stage::Kind::kDescend}};
    }
    case CommandKind::kAbort: {
      if (corridor_) return {Stage{Stage::Kind::kStop}, MakeBackOut()};
      return {Stage{Stage::Kind::kStop}};
    }
    case CommandKind::kHold:
      break;
  }
  return {Stage{Stage::Kind::kStop}};
}

Agent::CorridorLine Agent::MakeCorridorLine(const FlightCommand& command) const {
  const VehicleEnvelope& envelope = identity_.envelope;
  const double kept_m = (1.0 - options_.corridor_margin_ratio) * envelope.safety_margin_m;
  CorridorLine line;
  line.entry_m = command.path_in_map_m.front();
  line.exit_m = command.path_in_map_m.back();
  line.yaw_rad = command.yaw_rad;
  line.speed_mps = command.speed_mps;
  line.lateral_limit_m = 0.5 * command.permit->free_width_m - envelope.radius_m - kept_m;
  line.vertical_limit_m = 0.5 * (command.permit->free_height_m - envelope.height_m) - kept_m;
  return line;
}

Stage Agent::MakeBackOut() const {
  Stage back{Stage::Kind::kBackOut};
  back.path = {NearestOnLine(telemetry_.position_in_map_m, corridor_->entry_m, corridor_->exit_m),
               corridor_->entry_m};
  back.speed_mps = corridor_->speed_mps;
  back.yaw_rad = corridor_->yaw_rad;
  return back;
}

std::deque<Stage> Agent::MakeReturnPlan() const {
  const double height_m =
      std::min(std::max({options_.return_height_m, greatest_height_m_, telemetry_.position_in_map_m.z()}),
               std::max(guard_.ceiling_m, telemetry_.position_in_map_m.z()));
  std::deque<Stage> plan{Stage{Stage::Kind::kStop}};
  Eigen::Vector3d above = telemetry_.position_in_map_m;
  if (corridor_) {
    plan.push_back(MakeBackOut());
    above = corridor_->entry_m;
  }
  above.z() = height_m;
  Stage fly{Stage::Kind::kFly, {above, Eigen::Vector3d(0.0, 0.0, height_m)}};
  fly.speed_mps = options_.return_speed_mps;
  plan.push_back(fly);
  plan.push_back(Stage{Stage::Kind::kDescend});
  return plan;
}

void Agent::SetPlan(std::deque<Stage> plan) {
  plan_ = std::move(plan);
  progress_ = {};
}

// ---- What is done ----

void Agent::Handle(const Beat&, Instant now) {
  const double dt_s = std::clamp(SecondsBetween(last_beat_, now), 0.0, kMaxStep_s);
  last_beat_ = now;
  if (GivesWayToRival(now)) {
    command_.reset();
    SetPlan({});
    intent_ = {};
    return;
  }
  WatchVehicle(now);
  WatchForReturn(now);
  RunPlan(dt_s, now);
}

void Agent::WatchVehicle(Instant now) {
  std::string problem;
  if (!telemetry_.is_connected) {
    problem = "the autopilot fell silent";
  } else if (IsPilotInControl()) {
    problem = Say(telemetry_.is_in_failsafe ? "the autopilot's failsafe took over" : "the pilot took over",
                  ": mode ", telemetry_.mode);
  } else if (IsAirborne() && !(SecondsBetween(position_seen_, now) < kLostPosition_s)) {
    problem = "no position";
  } else if (!telemetry_.is_armed && progress_.has_begun && plan_.front().kind != Stage::Kind::kClimb &&
             plan_.front().kind != Stage::Kind::kDescend) {
    problem = "the motors were stopped";
  }
  if (!problem.empty() && problem != last_problem_ && (command_ || !plan_.empty() || IsAirborne()))
    Note(problem);
  last_problem_ = problem;
  if (!problem.empty()) {
    FinishCommand(AckStatus::kFailed, problem, now);
    SetPlan({});
    intent_ = {};
    return_reason_.clear();
  }
  if (corridor_ && telemetry_.has_position) {
    const Eigen::Vector3d& position = telemetry_.position_in_map_m;
    const double away_m = (position - NearestOnLine(position, corridor_->entry_m, corridor_->exit_m)).norm();
    const double edge_m = identity_.envelope.NeededWidth_m() + corridor_->lateral_limit_m;
    if (!IsAirborne() || (IsPilotInControl() && away_m > edge_m)) corridor_.reset();
  }
  if (problem.empty() && IsAirborne() && plan_.empty() && intent_.kind == Intent::Kind::kNone) {
    SetPlan({Stage{Stage::Kind::kStop}});  // In the air, in our mode, and nobody leads: take charge of it.
  }
}

void Agent::WatchForReturn(Instant now) {
  if (!IsAirborne() || IsPilotInControl() || !telemetry_.is_connected || !telemetry_.has_position) return;
  if (!return_reason_.empty()) return;
  const bool is_landing = !plan_.empty() && plan_.back().kind == Stage::Kind::kDescend;
  const bool is_passing = !plan_.empty() && plan_.front().kind == Stage::Kind::kPass;
  const double silent_s = SecondsBetween(service_heard_, now);
  const bool is_empty =
      telemetry_.battery_ratio >= 0.0 && telemetry_.battery_ratio < guard_.min_battery_ratio;
  const bool is_lonely = silent_s > options_.return_after_silence_s;
  if (is_passing && !options_.finish_corridor_in_silence && IsServiceSilent(now)) {
    Note("the service is silent: backing out of the corridor");
    const Stage back = MakeBackOut();
    FinishCommand(AckStatus::kFailed, "the service was silent: backed out of the corridor", now);
    return SetPlan({Stage{Stage::Kind::kStop}, back});
  }
  if (is_landing || is_passing || !(is_empty || is_lonely)) return;
  return_reason_ = is_empty ? Say("battery is at ", 100.0 * telemetry_.battery_ratio, " %: returning home")
                            : Say("the service was silent for ", silent_s, " s: returning home");
  Note(return_reason_);
  FinishCommand(AckStatus::kFailed, return_reason_, now);
  SetPlan(MakeReturnPlan());
}

void Agent::RunPlan(double dt_s, Instant now) {
  if (plan_.empty() || !telemetry_.is_connected) return;
  const Stage stage = plan_.front();
  if (stage.kind != Stage::Kind::kClimb && !telemetry_.has_position) return;
  if (!progress_.has_begun) BeginStage(stage, now);
  const bool waits = stage.kind == Stage::Kind::kFly && return_reason_.empty() && IsServiceSilent(now);
  if (waits) {
    progress_.run.Halt();
    return;
  }
  progress_.active_s += dt_s;
  std::optional<StageEnd> end = RunStage(stage, dt_s, now);
  if (!end && progress_.active_s > progress_.allowed_s) {
    end = StageEnd{
        Say("gave up after ", progress_.active_s, " s", IsPathStage(stage.kind) ? ": did not arrive, " : "")};
    if (IsPathStage(stage.kind)) {
      end->problem += Say((telemetry_.position_in_map_m - progress_.run.End()).norm(), " m missing");
    }
  }
  if (end) EndStage(stage, *end, now);
}

Eigen::Vector3d Agent::PathStart() const {
  const Eigen::Vector3d& is = telemetry_.position_in_map_m;
  const Eigen::Vector3d& wanted = intent_.position_in_map_m;
  const bool is_there = intent_.kind == Intent::Kind::kFlyTo && (wanted - is).norm() < 1.0;
  return is_there ? wanted : is;
}

void Agent::BeginStage(const Stage& stage, Instant) {
  progress_.has_begun = true;
  progress_.run = PathRun(PathStart(), stage.path);
  const double length_m = progress_.run.RemainingLength_m();
  switch (stage.kind) {
    case Stage::Kind::kFly:
    case Stage::Kind::kAlign:
    case Stage::Kind::kBackOut:
    case Stage::Kind::kPass: {
      const double legs = static_cast<double>(stage.path.size());
      progress_.allowed_s = kPatience * (length_m / stage.speed_mps + 5.0 * legs) + kPathGrace_s;
      if (stage.kind == Stage::Kind::kPass && command_) corridor_ = MakeCorridorLine(*command_);
      break;
    }
    case Stage::Kind::kClimb:
      progress_.allowed_s = options_.takeoff_timeout_s;
      break;
    case Stage::Kind::kSettle:
      progress_.allowed_s = options_.settle_timeout_s;
      break;
    case Stage::Kind::kExpose:
      progress_.allowed_s = options_.picture_timeout_s * static_cast<double>(options_.picture_tries);
      break;
    case Stage::Kind::kDescend:
      progress_.allowed_s =
          std::max(telemetry_.position_in_map_m.z(), 0.0) / kSlowDescent_mps + kDescentGrace_s;
      break;
    case Stage::Kind::kStop: {
      progress_.allowed_s = kStopTimeout_s;
      const Eigen::Vector3d& velocity = telemetry_.velocity_in_map_mps;
      Eigen::Vector3d stop =
          telemetry_.position_in_map_m + velocity * (0.5 * velocity.norm() / kStopDeceleration_mps2);
      // Under a soffit: never above the line.
      if (corridor_) stop = NearestOnLine(stop, corridor_->entry_m, corridor_->exit_m);
      HoldAt(stop);
      break;
    }
  }
}

void Agent::HoldAt(const Eigen::Vector3d& position_in_map_m) {
  if (intent_.kind != Intent::Kind::kFlyTo) intent_.yaw_rad = telemetry_.yaw_rad;
  intent_.kind = Intent::Kind::kFlyTo;
  intent_.position_in_map_m = position_in_map_m;
}

bool Agent::IsAtRest() const {
  const bool is_aimed =
      !intent_.camera_pitch_rad || !telemetry_.gimbal_pitch_rad ||
      std::abs(*intent_.camera_pitch_rad - *telemetry_.gimbal_pitch_rad) < kGimbalTolerance_rad;
  return is_aimed && telemetry_.velocity_in_map_mps.norm() < options_.settle_speed_mps &&
         telemetry_.rotation_rate_radps < options_.settle_rate_radps &&
         AngleBetween(telemetry_.yaw_rad, intent_.yaw_rad) < options_.settle_yaw_rad &&
         (telemetry_.position_in_map_m - intent_.position_in_map_m).norm() < options_.arrival_tolerance_m;
}

std::optional<Agent::StageEnd> Agent::RunStage(const Stage& stage, double dt_s, Instant now) {
  switch (stage.kind) {
    case Stage::Kind::kClimb:
      return RunClimb(stage);
    case Stage::Kind::kFly:
    case Stage::Kind::kAlign:
    case Stage::Kind::kPass:
    case Stage::Kind::kBackOut:
      return RunPath(stage, dt_s, now);
    case Stage::Kind::kSettle:
      return RunSettle(dt_s);
    case Stage::Kind::kExpose:
      return RunExposure(now);
    case Stage::Kind::kStop:
      if (telemetry_.velocity_in_map_mps.norm() < options_.settle_speed_mps) return StageEnd{};
      return std::nullopt;
    case Stage::Kind::kDescend:
      intent_.kind = Intent::Kind::kLand;
      if (!telemetry_.is_armed) return StageEnd{};
      if (!telemetry_.intent_problem.empty()) return StageEnd{telemetry_.intent_problem};
      return std::nullopt;
  }
  return std::nullopt;
}

std::optional<Agent::StageEnd> Agent::RunClimb(const Stage& stage) {
  if (intent_.kind != Intent::Kind::kTakeOff) {
    intent_.kind = Intent::Kind::kTakeOff;
    intent_.position_in_map_m = telemetry_.position_in_map_m;
    intent_.position_in_map_m.z() = stage.height_m;
    intent_.yaw_rad = telemetry_.yaw_rad;
  }
  if (!telemetry_.intent_problem.empty()) return StageEnd{telemetry_.intent_problem};
  const bool is_there = IsAirborne() && telemetry_.has_position &&
                        std::abs(telemetry_.position_in_map_m.z() - stage.height_m) < kClimbTolerance_m &&
                        std::abs(telemetry_.velocity_in_map_mps.z()) < kClimbEndSpeed_mps;
  if (!is_there) return std::nullopt;
  HoldAt(intent_.position_in_map_m);
  return StageEnd{};
}

std::optional<Agent::StageEnd> Agent::RunPath(const Stage& stage, double dt_s, Instant) {
  const PathPace pace{stage.speed_mps, options_.acceleration_mps2, options_.lead_s * stage.speed_mps + 0.5,
                      options_.corner_tolerance_m};
  progress_.run.Advance(telemetry_.position_in_map_m, dt_s, pace);
  HoldAt(progress_.run.Carrot());
  if (stage.yaw_rad) intent_.yaw_rad = *stage.yaw_rad;
  intent_.camera_pitch_rad = stage.camera_pitch_rad;
  if (stage.kind == Stage::Kind::kPass) {
    if (auto end = WatchCorridor(dt_s)) return end;
  }
  if (!progress_.run.IsAtEnd()) return std::nullopt;
  const double tolerance_m =
      stage.kind == Stage::Kind::kAlign ? options_.corridor_align_m : options_.arrival_tolerance_m;
  const bool is_there = (telemetry_.position_in_map_m - progress_.run.End()).norm() < tolerance_m &&
                        telemetry_.velocity_in_map_mps.norm() < options_.settle_speed_mps &&
                        AngleBetween(telemetry_.yaw_rad, intent_.yaw_rad) < options_.settle_yaw_rad;
  progress_.calm_s = is_there ? progress_.calm_s + dt_s : 0.0;
  if (stage.kind == Stage::Kind::kAlign ? progress_.calm_s >= options_.settle_s : is_there) return StageEnd{};
  return std::nullopt;
}

std::optional<Agent::StageEnd> Agent::WatchCorridor(double dt_s) {
  const CrossTrack off = progress_.run.MeasureCrossTrack(telemetry_.position_in_map_m);
  const double share = dt_s / (dt_s + kCrossTrackFilter_s);
  progress_.lateral_m += share * (off.lateral_m - progress_.lateral_m);
  progress_.vertical_m += share * (off.vertical_m - progress_.vertical_m);
  const double gross_m = 0.5 * options_.corridor_margin_ratio * identity_.envelope.safety_margin_m;
  const auto is_beyond = [&](double smoothed_m, double now_m, double limit_m) {
    return std::abs(smoothed_m) > limit_m || std::abs(now_m) > limit_m + gross_m;
  };
  if (is_beyond(progress_.lateral_m, off.lateral_m, corridor_->lateral_limit_m)) {
    return StageEnd{Say(std::abs(off.lateral_m), " m beside the corridor's line, allowed are ",
                        corridor_->lateral_limit_m, " m")};
  }
  if (is_beyond(progress_.vertical_m, off.vertical_m, corridor_->vertical_limit_m)) {
    return StageEnd{Say(std::abs(off.vertical_m), " m above or below the corridor's line, allowed are ",
                        corridor_->vertical_limit_m, " m")};
  }
  return std::nullopt;
}

std::optional<Agent::StageEnd> Agent::RunSettle(double dt_s) {
  progress_.calm_s = IsAtRest() ? progress_.calm_s + dt_s : 0.0;
  if (progress_.calm_s < options_.settle_s) return std::nullopt;
  return StageEnd{};
}

std::optional<CameraId> Agent::ChooseCamera(double pitch_rad) const {
  const auto works = [&](CameraId id) {
    return std::find(identity_.cameras.begin(), identity_.cameras.end(), id) != identity_.cameras.end() &&
           !cameras_.problems.contains(id);
  };
  if (works(CameraId::kGimbal)) return CameraId::kGimbal;
  const CameraId fixed = pitch_rad < kDownIsBelow_rad ? CameraId::kDown : CameraId::kForward;
  if (works(fixed)) return fixed;
  return std::nullopt;
}

std::optional<Agent::StageEnd> Agent::RunExposure(Instant) {
  if (progress_.picture) {
    if (progress_.picture->problem.empty()) return StageEnd{};
    Note(Say("picture ", command_->capture_id, ", try ", progress_.picture_tries, ": ",
             progress_.picture->problem));
    if (progress_.picture_tries >= options_.picture_tries) {
      return StageEnd{
          Say("no picture after ", progress_.picture_tries, " tries: ", progress_.picture->problem)};
    }
    progress_.picture.reset();
    progress_.request_id.reset();
  }
  if (progress_.request_id) return std::nullopt;
  const std::optional<CameraId> camera = ChooseCamera(command_->camera_pitch_rad);
  if (!camera) return StageEnd{"the camera does not work"};
  progress_.request_id = next_request_id_++;
  ++progress_.picture_tries;
  outputs_.exposure = ExposureRequest{*progress_.request_id, *camera, command_->mission_id,
                                      command_->capture_id, command_->purpose};
  return std::nullopt;
}

void Agent::EndStage(const Stage& stage, const StageEnd& end, Instant now) {
  if (!end.problem.empty()) {
    std::deque<Stage> rescue;
    std::string outcome = end.problem;
    if (stage.kind == Stage::Kind::kPass) {
      rescue = {Stage{Stage::Kind::kStop}, MakeBackOut()};
      outcome += "; backing out the way it came";
    } else if (stage.kind == Stage::Kind::kClimb && !IsAirborne()) {
      intent_ = {};
    } else if (stage.kind != Stage::Kind::kStop && IsAirborne()) {
      rescue = {Stage{Stage::Kind::kStop}};
    }
    if (!command_) Note(outcome);
    return_reason_.clear();  // When there is reason to return, the next tick finds it again.
    FinishCommand(AckStatus::kFailed, outcome, now);
    return SetPlan(std::move(rescue));
  }
  if (stage.kind == Stage::Kind::kPass || stage.kind == Stage::Kind::kBackOut) corridor_.reset();
  if (stage.kind == Stage::Kind::kDescend) {
    intent_ = {};
    return_reason_.clear();
  }
  plan_.pop_front();
  progress_ = {};
  if (plan_.empty()) FinishCommand(AckStatus::kDone, {}, now);
}

// ---- What is told ----

VehiclePhase Agent::PhaseOf(Instant now) const {
  if (GivesWayToRival(now) || !telemetry_.is_connected) return VehiclePhase::kNotReady;
  if (IsPilotInControl()) return VehiclePhase::kPilotInControl;
  if (!plan_.empty()) {
    switch (plan_.front().kind) {
      case Stage::Kind::kClimb:
        return VehiclePhase::kTakingOff;
      case Stage::Kind::kFly:
      case Stage::Kind::kAlign:
        return VehiclePhase::kInTransit;
      case Stage::Kind::kPass:
      case Stage::Kind::kBackOut:
        return VehiclePhase::kInCorridor;
      case Stage::Kind::kSettle:
      case Stage::Kind::kExpose:
        return VehiclePhase::kLooking;
      case Stage::Kind::kDescend:
        return VehiclePhase::kLanding;
      case Stage::Kind::kStop:
        return VehiclePhase::kHolding;
    }
  }
  if (IsAirborne()) return telemetry_.has_position ? VehiclePhase::kHolding : VehiclePhase::kNotReady;
  return telemetry_.not_ready.empty() && telemetry_.has_position ? VehiclePhase::kOnGround
                                                                 : VehiclePhase::kNotReady;
}

std::string Agent::MessageOf(Instant now) const {
  if (GivesWayToRival(now)) {
    return Say("another agent ('", rival_->name, "') flies vehicle ", identity_.vehicle_id,
               "; this one commands nothing. Stop one of them, or give it another vehicle id");
  }
  std::string text;
  const auto add = [&text](const std::string& part) {
    if (!part.empty()) text += (text.empty() ? "" : "; ") + part;
  };
  if (!telemetry_.is_connected) {
    add(telemetry_.not_ready.empty() ? "the autopilot is silent" : telemetry_.not_ready);
  } else if (IsPilotInControl()) {
    add(Say(telemetry_.is_in_failsafe ? "failsafe of the autopilot" : "the pilot flies", ", mode ",
            telemetry_.mode));
  } else if (!IsAirborne() && plan_.empty()) {
    add(telemetry_.not_ready.empty() && !telemetry_.has_position ? "no position" : telemetry_.not_ready);
  } else if (!telemetry_.has_position) {
    add("no position");
  }
  if (rival_ && SecondsBetween(rival_heard_, now) < kRivalTimeout_s) {
    add(Say("a second agent ('", rival_->name, "') claims this vehicle; it has to give way"));
  }
  add(return_reason_);
  if (IsAirborne() && IsServiceSilent(now) && return_reason_.empty()) {
    add(Say("the service is silent for ", SecondsBetween(service_heard_, now), " s"));
  }
  if (corridor_ && plan_.empty()) add("at rest inside a corridor");
  if (command_) add(Say("command ", command_->sequence, ": ", ToString(command_->kind)));
  for (const auto& [camera, problem] : cameras_.problems) add(Say(ToString(camera), " camera: ", problem));
  return text;
}

VehicleState Agent::Describe(Instant now) const {
  VehicleState state;
  state.vehicle_id = identity_.vehicle_id;
  state.agent_epoch = identity_.epoch;
  state.name = identity_.name;
  state.stamp_utc_ns = now.utc_ns;
  state.phase = PhaseOf(now);
  state.message = MessageOf(now);
  state.autopilot = telemetry_.autopilot;
  state.autopilot_mode = telemetry_.mode;
  state.armed = telemetry_.is_armed;
  state.position_in_map_m = telemetry_.position_in_map_m;
  state.velocity_in_map_mps = telemetry_.velocity_in_map_mps;
  state.yaw_rad = telemetry_.yaw_rad;
  state.position_std_m = telemetry_.position_std_m;
  state.orientation_std_rad = telemetry_.orientation_std_rad;
  state.battery_ratio = telemetry_.battery_ratio;
  state.origin = telemetry_.origin;
  state.envelope = identity_.envelope;
  state.camera = identity_.camera;
  state.max_speed_mps = guard_.max_speed_mps;
  return state;
}

}  // namespace soffit
