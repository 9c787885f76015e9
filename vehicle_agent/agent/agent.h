#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "shared/flight/flight.h"
#include "vehicle_agent/agent/agent_options.h"
#include "vehicle_agent/agent/command_ledger.h"
#include "vehicle_agent/agent/failure_policy.h"
#include "vehicle_agent/agent/plan.h"
#include "vehicle_agent/agent/stage_run.h"
#include "vehicle_agent/guard/guard.h"
#include "vehicle_agent/vehicle/vehicle.h"

namespace soffit {

/// What the agent is told of itself when it starts.
struct AgentIdentity {
  std::uint32_t vehicle_id = 0;
  std::uint64_t epoch = 0;  ///< UTC nanoseconds of its start: of two agents the later one gives way.
  std::string name;
  VehicleEnvelope envelope;
  Intrinsics camera;              ///< Of the forward camera, or of the one on the gimbal.
  std::vector<CameraId> cameras;  ///< That the vehicle has.
};

/// The service lives and leads this vehicle.
struct ServiceHeartbeat {
  std::uint64_t mission_id = 0;
};

/// How the taking of a picture ended; `problem` is empty when the picture was handed over whole.
struct PictureOutcome {
  std::uint64_t request_id = 0;
  std::string problem;
};

/// Which cameras do not work, and why.
struct CameraHealth {
  std::map<CameraId, std::string> problems;
};

/// Another agent says that it flies this vehicle.
struct RivalHeard {
  std::uint64_t epoch = 0;
  std::string name;
};

/// Time passes; said 20 times a second or more often.
struct Beat {};

using AgentEvent =
    std::variant<Beat, Telemetry, FlightCommand, ServiceHeartbeat, PictureOutcome, CameraHealth, RivalHeard>;

struct ExposureRequest {
  std::uint64_t request_id = 0;
  CameraId camera = CameraId::kForward;
  std::uint64_t mission_id = 0;
  std::uint32_t capture_id = 0;
  Purpose purpose = Purpose::kUnknown;
};

struct AgentOutputs {
  std::vector<CommandAck> acks;
  std::optional<ExposureRequest> exposure;
  std::vector<std::string> notes;  ///< For the log: what happened, in words.
};

/// The agent's mind: what it heard, what it is doing, what it wants of the autopilot and the cameras.
///
/// Pure: it knows no clock, bus, file or thread; time comes with each event, and the same events give the
/// same outputs. Commands are idempotent by mission id and number: a resent one is answered again and not
/// done again. What happens in silence, at takeover and in every other trouble is the table in
/// vehicle_agent/README.md.
class Agent {
 public:
  Agent(AgentIdentity identity, AgentOptions options, GuardOptions guard, Instant now);

  AgentOutputs Step(const AgentEvent& event, Instant now);

  const Intent& intent() const { return intent_; }
  VehicleState Describe(Instant now) const;
  bool GivesWayToRival(Instant now) const;  ///< An older agent flies this vehicle: say nothing of commands.

 private:
  void Handle(const Beat&, Instant now);
  void Handle(const Telemetry& telemetry, Instant now);
  void Handle(const FlightCommand& command, Instant now);
  void Handle(const ServiceHeartbeat& heartbeat, Instant now);
  void Handle(const PictureOutcome& outcome, Instant now);
  void Handle(const CameraHealth& health, Instant now);
  void Handle(const RivalHeard& rival, Instant now);

  bool IsPilotInControl() const {
    return telemetry_.is_connected && telemetry_.is_armed && !telemetry_.is_in_our_mode;
  }
  bool IsRivalHeard(Instant now) const;
  bool IsServiceSilent(Instant now) const;
  std::optional<CameraId> ChooseCamera(double pitch_rad) const;
  std::string FindCameraProblem() const;

  // Commands
  GuardContext MakeContext(const FlightCommand& command, Instant now) const;
  void Answer(const FlightCommand& command, AckStatus status, const std::string& reason, Instant now);
  void AnswerAgain(Instant now);
  void Begin(const FlightCommand& command, Instant now);
  void FinishCommand(AckStatus status, const std::string& reason, Instant now);

  // Watching
  std::string FindLossOfControl() const;
  void FollowCorridor();
  FailureSigns FindSigns(Instant now) const;
  Situation SituationNow() const;
  bool IsMoot(const Trouble& trouble) const;
  void WatchForTrouble(Instant now);
  void React(const Trouble& trouble, Instant now);
  double ReturnHeight_m() const;

  // Doing
  void SetPlan(Plan plan);
  void LetGo();         ///< Commands nothing.
  void StayOnGround();  ///< The same; motors that run are stopped.
  void RunPlan(double dt_s, Instant now);
  std::string EnterCorridor(Instant now);
  std::optional<StageEnd> TakePicture();
  void EndStage(const StageEnd& end, Instant now);

  // Telling
  VehiclePhase PhaseOf(Instant now) const;
  std::string MessageOf(Instant now) const;
  void Note(std::string text) { outputs_.notes.push_back(std::move(text)); }

  /// The tries at the picture of the present look.
  struct Exposure {
    int tries = 0;
    std::optional<std::uint64_t> request_id;  ///< Of the try that is going on.
    std::optional<PictureOutcome> outcome;
  };

  AgentIdentity identity_;
  AgentOptions options_;
  GuardOptions guard_;
  ReactionTable reactions_;

  // What was heard
  Telemetry telemetry_;
  Telemetry located_;         ///< The newest with a position.
  bool is_airborne_ = false;  ///< As last heard: a silent autopilot still flies.
  CameraHealth cameras_;
  Instant began_;
  Instant last_beat_;
  Instant service_heard_;
  std::optional<Instant> service_found_;  ///< Heard again after silence.
  Instant position_seen_;
  std::optional<RivalHeard> rival_;
  Instant rival_heard_;
  double greatest_height_m_ = 0.0;  ///< Of this flight.

  // What is being done
  CommandLedger ledger_;
  Instant answered_;
  std::optional<FlightCommand> command_;
  Plan plan_;
  std::optional<StageRun> run_;  ///< Of the plan's first stage, once it has begun.
  Exposure exposure_;
  Intent intent_;
  std::optional<CorridorLine> corridor_;  ///< Set while the vehicle is, or may be, inside of one.
  std::optional<Trouble> trouble_;        ///< That is being reacted to.
  bool is_waiting_ = false;               ///< For a trouble to pass.
  bool began_in_bounds_ = true;           ///< When the command began: from outside it may come back.
  std::uint64_t next_request_id_ = 1;
  std::string last_loss_;
  AgentOutputs outputs_;
};

}  // namespace soffit
