#include "vehicle_agent/agent/agent.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr double kDownIsBelow_rad = -std::numbers::pi / 4.0;  // Steeper looks use the downward camera.
constexpr double kRivalTimeout_s = 3.0;
constexpr double kMaxStep_s = 0.25;
constexpr double kAnswerAgainFor_s = 5.0;  // A link that comes back needs some time until it carries answers.
constexpr double kAnswerAgainEvery_s = 1.0;

/// Whether a stage can be paused: the others bring the vehicle to safety, or the autopilot does them.
bool CanWait(Stage::Kind kind) {
  return kind == Stage::Kind::kFly || kind == Stage::Kind::kAlign || kind == Stage::Kind::kPass ||
         kind == Stage::Kind::kSettle || kind == Stage::Kind::kExpose;
}

}  // namespace

Agent::Agent(AgentIdentity identity, AgentOptions options, GuardOptions guard, Instant now)
    : identity_(std::move(identity)),
      options_(std::move(options)),
      guard_(std::move(guard)),
      reactions_(options_.on_failure),
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
  if (telemetry.is_connected) is_airborne_ = telemetry.is_armed && telemetry.is_in_air;
  if (telemetry.has_position) {
    located_ = telemetry;
    position_seen_ = now;
  }
  greatest_height_m_ = is_airborne_ ? std::max(greatest_height_m_, located_.position_in_map_m.z()) : 0.0;
}

void Agent::Handle(const ServiceHeartbeat& heartbeat, Instant now) {
  if (ledger_.IsOver(heartbeat.mission_id)) return;
  if (IsServiceSilent(now)) service_found_ = now;
  service_heard_ = now;
}

void Agent::Handle(const PictureOutcome& outcome, Instant) {
  if (exposure_.request_id == outcome.request_id) exposure_.outcome = outcome;
}

void Agent::Handle(const CameraHealth& health, Instant) { cameras_ = health; }

void Agent::Handle(const RivalHeard& rival, Instant now) {
  const bool is_new = !IsRivalHeard(now) || rival_->epoch != rival.epoch;
  rival_ = rival;
  rival_heard_ = now;
  if (!is_new) return;
  Note(Say("another agent, '", rival.name, "', says that it flies vehicle ", identity_.vehicle_id, "; ",
           rival.epoch < identity_.epoch ? "it was there first: this one gives way and commands nothing"
                                         : "this one was there first and goes on"));
}

bool Agent::IsRivalHeard(Instant now) const {
  return rival_ && SecondsBetween(rival_heard_, now) < kRivalTimeout_s;
}

bool Agent::GivesWayToRival(Instant now) const {
  return IsRivalHeard(now) && rival_->epoch < identity_.epoch;
}

bool Agent::IsServiceSilent(Instant now) const {
  return SecondsBetween(service_heard_, now) > options_.hold_after_silence_s;
}

std::optional<CameraId> Agent::ChooseCamera(double pitch_rad) const {
  const auto works = [&](CameraId id) {
    return std::ranges::find(identity_.cameras, id) != identity_.cameras.end() &&
           !cameras_.problems.contains(id);
  };
  if (works(CameraId::kGimbal)) return CameraId::kGimbal;
  const CameraId fixed = pitch_rad < kDownIsBelow_rad ? CameraId::kDown : CameraId::kForward;
  if (works(fixed)) return fixed;
  return std::nullopt;
}

// ---- Commands ----

void Agent::Handle(const FlightCommand& command, Instant now) {
  if (command.vehicle_id != identity_.vehicle_id || GivesWayToRival(now)) return;
  if (SecondsBetween(began_, now) < options_.rival_listen_s) return;
  if (CommandAck* const known = ledger_.FindAnswer(command)) {
    service_heard_ = now;
    known->stamp_utc_ns = now.utc_ns;
    outputs_.acks.push_back(*known);
    return;
  }
  const GuardContext context = MakeContext(command, now);
  const std::string misaddressed = FindAddressProblem(command, context);
  if (!misaddressed.empty()) return Answer(command, AckStatus::kRefused, misaddressed, now);
  ledger_.Begin(command);
  service_heard_ = now;
  const std::string reason = FindReasonToRefuse(command, context, guard_, now.utc_ns);
  if (!reason.empty()) {
    Note(Say("refused command ", command.sequence, " (", ToString(command.kind), "): ", reason));
    return Answer(command, AckStatus::kRefused, reason, now);
  }
  if (command.permit) ledger_.NoteSceneRevision(command.permit->scene_revision);
  Begin(command, now);
}

GuardContext Agent::MakeContext(const FlightCommand& command, Instant now) const {
  GuardContext context;
  context.vehicle_id = identity_.vehicle_id;
  context.envelope = identity_.envelope;
  context.phase = PhaseOf(now);
  if (context.phase == VehiclePhase::kNotReady)
    context.not_ready = "the vehicle is not ready; " + MessageOf(now);
  context.is_in_air = is_airborne_;
  context.is_in_corridor = corridor_.has_value();
  context.is_busy = command_.has_value();
  context.position_in_map_m = telemetry_.position_in_map_m;
  context.battery_ratio = telemetry_.battery_ratio;
  context.mission_id = ledger_.mission_id();
  context.last_sequence = ledger_.last_sequence();
  context.old_missions = ledger_.old_missions();
  context.newest_scene_revision = ledger_.newest_scene_revision();
  context.has_camera = ChooseCamera(command.camera_pitch_rad).has_value();
  for (const auto& [camera, problem] : cameras_.problems) {
    context.missing_cameras.push_back(std::string(ToString(camera)) + " camera: " + problem);
  }
  return context;
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
  answered_ = now;
  ledger_.Keep(ack);
}

/// The newest answer may have been lost while the service could not be reached.
void Agent::AnswerAgain(Instant now) {
  if (!service_found_ || SecondsBetween(*service_found_, now) > kAnswerAgainFor_s) return;
  if (SecondsBetween(answered_, now) < kAnswerAgainEvery_s) return;
  answered_ = now;
  if (CommandAck* const newest = ledger_.FindNewestAnswer()) {
    newest->stamp_utc_ns = now.utc_ns;
    outputs_.acks.push_back(*newest);
  }
}

void Agent::Begin(const FlightCommand& command, Instant now) {
  FinishCommand(AckStatus::kFailed,
                Say("superseded by command ", command.sequence, " (", ToString(command.kind), ")"), now);
  Note(Say("command ", command.sequence, " (", ToString(command.kind), ") accepted"));
  Answer(command, AckStatus::kAccepted, {}, now);
  command_ = command;
  trouble_.reset();
  began_in_bounds_ = FindBoundsProblem(telemetry_, corridor_.has_value(), guard_).empty();
  if (IsStopping(command.kind) && !is_airborne_) {
    StayOnGround();
    return FinishCommand(AckStatus::kDone, {}, now);
  }
  SetPlan(MakePlan(command, telemetry_.position_in_map_m, corridor_));
}

void Agent::FinishCommand(AckStatus status, const std::string& reason, Instant now) {
  if (!command_) return;
  const FlightCommand finished = *std::exchange(command_, std::nullopt);
  Note(Say("command ", finished.sequence, " (", ToString(finished.kind), ") ", ToString(status),
           reason.empty() ? "" : ": ", reason));
  Answer(finished, status, reason, now);
}

// ---- What is watched ----

void Agent::Handle(const Beat&, Instant now) {
  const double dt_s = std::clamp(SecondsBetween(last_beat_, now), 0.0, kMaxStep_s);
  last_beat_ = now;
  FollowCorridor();
  if (GivesWayToRival(now)) {
    command_.reset();
    return LetGo();
  }
  const std::string loss = FindLossOfControl();
  if (!loss.empty() && loss != last_loss_ && (command_ || is_airborne_)) Note(loss);
  last_loss_ = loss;
  AnswerAgain(now);
  if (!loss.empty()) {
    FinishCommand(AckStatus::kFailed, loss, now);
    trouble_.reset();
    return LetGo();
  }
  WatchForTrouble(now);
  const bool is_unled = is_airborne_ && plan_.empty() && intent_.kind == Intent::Kind::kNone && !trouble_;
  if (is_unled) SetPlan({Stage{Stage::Kind::kStop}});
  RunPlan(dt_s, now);
}

std::string Agent::FindLossOfControl() const {
  if (IsPilotInControl()) {
    return Say(telemetry_.is_in_failsafe ? "the autopilot's failsafe took over" : "the pilot took over",
               ": mode ", telemetry_.mode);
  }
  const bool needs_motors =
      run_ && run_->stage().kind != Stage::Kind::kClimb && run_->stage().kind != Stage::Kind::kDescend;
  if (telemetry_.is_connected && !telemetry_.is_armed && needs_motors) return "the motors were stopped";
  return {};
}

/// A vehicle that stands on the ground, or that the pilot has flown away, is in no corridor any more.
void Agent::FollowCorridor() {
  if (!corridor_ || !telemetry_.has_position) return;
  const Eigen::Vector3d& position = telemetry_.position_in_map_m;
  const double edge_m = identity_.envelope.NeededWidth_m() + corridor_->lateral_limit_m;
  const bool is_away = (position - corridor_->Nearest(position)).norm() > edge_m;
  if (!is_airborne_ || (IsPilotInControl() && is_away)) corridor_.reset();
}

std::string Agent::FindCameraProblem() const {
  if (SituationNow() == Situation::kLooking && command_ && ChooseCamera(command_->camera_pitch_rad))
    return {};
  if (cameras_.problems.empty()) return {};
  const auto& [camera, problem] = *cameras_.problems.begin();
  return Say("the ", ToString(camera), " camera does not work (", problem, ")");
}

FailureSigns Agent::FindSigns(Instant now) const {
  FailureSigns signs;
  const double silent_s = SecondsBetween(service_heard_, now);
  if (silent_s > options_.return_after_silence_s) {
    signs[Failure::kServiceGone] = Say("the service was silent for ", silent_s, " s");
  } else if (IsServiceSilent(now)) {
    signs[Failure::kServiceSilent] = Say("the service is silent for ", silent_s, " s");
  }
  if (const std::string problem = FindCameraProblem(); !problem.empty()) {
    signs[Failure::kCameraLost] = problem;
  }
  if (telemetry_.battery_ratio >= 0.0 && telemetry_.battery_ratio < guard_.min_battery_ratio) {
    signs[Failure::kBatteryLow] = Say("battery is at ", 100.0 * telemetry_.battery_ratio, " %");
  }
  if (const std::string problem = FindBoundsProblem(telemetry_, corridor_.has_value(), guard_);
      began_in_bounds_ && !problem.empty()) {
    signs[Failure::kOutOfBounds] = problem;
  }
  if (!telemetry_.position_doubt.empty()) signs[Failure::kPositionDoubtful] = telemetry_.position_doubt;
  if (!telemetry_.is_connected) {
    signs[Failure::kAutopilotSilent] = "the autopilot fell silent";
  } else if (is_airborne_ && !(SecondsBetween(position_seen_, now) < options_.lost_position_s)) {
    signs[Failure::kPositionLost] = "no position";
  }
  return signs;
}

Situation Agent::SituationNow() const {
  if (plan_.empty()) return Situation::kAtRest;
  const Stage::Kind kind = plan_.front().kind;
  if (kind == Stage::Kind::kStop) return Situation::kAtRest;
  if (kind == Stage::Kind::kSettle || kind == Stage::Kind::kExpose) return Situation::kLooking;
  return corridor_ ? Situation::kInCorridor : Situation::kInTransit;
}

/// Whether a reaction would change nothing, or for the worse.
bool Agent::IsMoot(const Trouble& trouble) const {
  const bool is_blind =
      trouble.failure == Failure::kPositionLost || trouble.failure == Failure::kAutopilotSilent;
  if (plan_.empty()) {
    return is_airborne_ && intent_.kind != Intent::Kind::kNone &&
           (trouble.reaction <= Reaction::kHold || (trouble.reaction == Reaction::kBackOut && !corridor_));
  }
  if (plan_.front().kind == Stage::Kind::kDescend) return trouble.reaction != Reaction::kRelease;
  if (is_blind) return false;
  if (plan_.back().kind == Stage::Kind::kDescend) return trouble.reaction < Reaction::kLand;
  return plan_.front().kind == Stage::Kind::kClimb && trouble.reaction < Reaction::kReturn;
}

void Agent::WatchForTrouble(Instant now) {
  const FailureSigns signs = is_airborne_ || !plan_.empty() ? FindSigns(now) : FailureSigns{};
  std::optional<Trouble> worst = reactions_.FindGravest(signs, SituationNow());
  if (worst && IsMoot(*worst)) worst.reset();
  is_waiting_ = worst && worst->reaction == Reaction::kWait && !trouble_;
  if (worst && worst->reaction > (trouble_ ? trouble_->reaction : Reaction::kWait)) {
    React(*worst, now);
  } else if (trouble_ && plan_.empty() && !signs.contains(trouble_->failure)) {
    trouble_.reset();
  }
}

void Agent::React(const Trouble& trouble, Instant now) {
  Note(trouble.words);
  FinishCommand(AckStatus::kFailed, trouble.words, now);
  if (!is_airborne_) return StayOnGround();
  trouble_ = trouble;
  if (trouble.reaction == Reaction::kRelease) return LetGo();
  if (trouble.reaction == Reaction::kLand) {
    SetPlan({Stage{Stage::Kind::kDescend}});
    intent_.kind = Intent::Kind::kLand;
    return;
  }
  if (trouble.reaction == Reaction::kReturn) {
    SetPlan(
        MakeReturnPlan(located_.position_in_map_m, corridor_, ReturnHeight_m(), options_.return_speed_mps));
  } else {
    SetPlan(trouble.reaction == Reaction::kBackOut ? MakeBackOutPlan(corridor_)
                                                   : Plan{Stage{Stage::Kind::kStop}});
  }
  HoldAt(FindStoppingPoint(located_, corridor_), located_.yaw_rad, intent_);  // Also when nothing is heard.
}

double Agent::ReturnHeight_m() const {
  const double height_m = located_.position_in_map_m.z();
  return std::min(std::max({options_.return_height_m, greatest_height_m_, height_m}),
                  std::max(guard_.ceiling_m, height_m));
}

// ---- What is done ----

void Agent::SetPlan(Plan plan) {
  plan_ = std::move(plan);
  run_.reset();
  exposure_ = {};
  ++intent_.order;
}

void Agent::LetGo() {
  SetPlan({});
  intent_.kind = Intent::Kind::kNone;
  intent_.camera_pitch_rad.reset();
}

void Agent::StayOnGround() {
  LetGo();
  if (telemetry_.is_armed) SetPlan({Stage{Stage::Kind::kDescend}});  // It may be about to lift off.
}

void Agent::RunPlan(double dt_s, Instant now) {
  if (plan_.empty() || !telemetry_.is_connected) return;
  const Stage::Kind kind = plan_.front().kind;
  const bool needs_position = kind != Stage::Kind::kClimb && kind != Stage::Kind::kDescend;
  if (needs_position && !telemetry_.has_position) return;
  if (!run_) {
    const std::string problem = kind == Stage::Kind::kPass ? EnterCorridor(now) : "";
    if (!problem.empty()) return EndStage({problem}, now);
    run_.emplace(plan_.front(), corridor_, identity_.envelope, options_, telemetry_, intent_);
  }
  if (is_waiting_ && CanWait(kind)) return run_->Halt();
  std::optional<StageEnd> end = run_->Go(telemetry_, dt_s, intent_);
  if (!end && kind == Stage::Kind::kExpose) end = TakePicture();
  if (end) EndStage(*end, now);
}

std::string Agent::EnterCorridor(Instant now) {
  std::string problem =
      FindPermitProblem(*command_->permit, identity_.envelope, ledger_.newest_scene_revision(), now.utc_ns);
  if (problem.empty()) {
    corridor_ = MakeCorridorLine(*command_, identity_.envelope, options_.corridor_margin_ratio);
  }
  return problem;
}

std::optional<StageEnd> Agent::TakePicture() {
  if (exposure_.outcome) {
    const std::string problem = std::exchange(exposure_.outcome, std::nullopt)->problem;
    if (problem.empty()) return StageEnd{};
    Note(Say("picture ", command_->capture_id, ", try ", exposure_.tries, ": ", problem));
    if (exposure_.tries >= options_.picture_tries) {
      return StageEnd{Say("no picture after ", exposure_.tries, " tries: ", problem)};
    }
    exposure_.request_id.reset();
  }
  if (exposure_.request_id) return std::nullopt;
  const std::optional<CameraId> camera = ChooseCamera(command_->camera_pitch_rad);
  if (!camera) return StageEnd{"the camera does not work"};
  exposure_.request_id = next_request_id_++;
  ++exposure_.tries;
  outputs_.exposure = ExposureRequest{*exposure_.request_id, *camera, command_->mission_id,
                                      command_->capture_id, command_->purpose};
  return std::nullopt;
}

void Agent::EndStage(const StageEnd& end, Instant now) {
  const Stage::Kind kind = plan_.front().kind;
  if (!end.problem.empty()) {
    std::string outcome = end.problem;
    Plan rescue;
    if (kind == Stage::Kind::kPass && corridor_) {
      rescue = MakeBackOutPlan(corridor_);
      outcome += "; backing out the way it came";
    } else if (kind != Stage::Kind::kStop) {
      rescue = {Stage{Stage::Kind::kStop}};
    }
    if (!command_) Note(outcome);
    trouble_.reset();  // When it is still there, the next beat finds it again.
    FinishCommand(AckStatus::kFailed, outcome, now);
    return is_airborne_ ? SetPlan(std::move(rescue)) : LetGo();
  }
  if (kind == Stage::Kind::kPass || kind == Stage::Kind::kBackOut) corridor_.reset();
  if (kind == Stage::Kind::kDescend) LetGo();
  if (!plan_.empty()) plan_.pop_front();
  run_.reset();
  exposure_ = {};
  if (plan_.empty()) FinishCommand(AckStatus::kDone, {}, now);
}

// ---- What is told ----

VehiclePhase Agent::PhaseOf(Instant now) const {
  if (GivesWayToRival(now) || !telemetry_.is_connected) return VehiclePhase::kNotReady;
  if (IsPilotInControl()) return VehiclePhase::kPilotInControl;
  const bool is_resting = plan_.empty() || plan_.front().kind == Stage::Kind::kStop;
  if (is_resting && is_airborne_) {
    return telemetry_.has_position ? VehiclePhase::kHolding : VehiclePhase::kNotReady;
  }
  if (is_resting) {
    return telemetry_.not_ready.empty() && telemetry_.has_position ? VehiclePhase::kOnGround
                                                                   : VehiclePhase::kNotReady;
  }
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
      break;
  }
  return VehiclePhase::kHolding;
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
  } else if (!is_airborne_ && plan_.empty()) {
    add(telemetry_.not_ready.empty() && !telemetry_.has_position ? "no position" : telemetry_.not_ready);
  } else if (!telemetry_.has_position) {
    add("no position");
  }
  if (IsRivalHeard(now)) {
    add(Say("a second agent ('", rival_->name, "') claims this vehicle; it has to give way"));
  }
  if (trouble_) {
    add(trouble_->words);
  } else if (is_airborne_ && IsServiceSilent(now)) {
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
