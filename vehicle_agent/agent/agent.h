#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "shared/flight/flight.h"
#include "shared/options/options.h"
#include "vehicle_agent/agent/path_run.h"
#include "vehicle_agent/guard/guard.h"
#include "vehicle_agent/vehicle/vehicle.h"

namespace soffit {

struct AgentOptions {
  double acceleration_mps2 = 1.0;
  double lead_s = 1.5;
  double corner_tolerance_m = 0.4;
  double arrival_tolerance_m = 0.35;
  double settle_speed_mps = 0.25;
  double settle_rate_radps = 0.25;
  double settle_yaw_rad = 0.12;
  double settle_s = 0.6;
  double settle_timeout_s = 30.0;
  int picture_tries = 3;
  double picture_timeout_s = 60.0;
  double takeoff_timeout_s = 90.0;
  double corridor_align_m = 0.2;
  double corridor_margin_ratio = 0.5;
  double hold_after_silence_s = 3.0;
  double return_after_silence_s = 60.0;
  double return_height_m = 6.0;
  double return_speed_mps = 1.5;
  bool finish_corridor_in_silence = true;
  double rival_listen_s = 2.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("acceleration_mps2", self.acceleration_mps2,
          OptionInfo{0.1, 10.0, "m/s2", "Of the point that is followed"});
    field("lead_s", self.lead_s,
          OptionInfo{0.2, 5.0, "s", "Times the speed: how far that point may run ahead"});
    field("corner_tolerance_m", self.corner_tolerance_m,
          OptionInfo{0.05, 5.0, "m", "How close corners are flown to"});
    field("arrival_tolerance_m", self.arrival_tolerance_m,
          OptionInfo{0.05, 5.0, "m", "How close the end is flown to"});
    field("settle_speed_mps", self.settle_speed_mps,
          OptionInfo{0.01, 2.0, "m/s", "Slower counts as at rest"});
    field("settle_rate_radps", self.settle_rate_radps,
          OptionInfo{0.01, 2.0, "rad/s", "Slower turning counts as rest"});
    field("settle_yaw_rad", self.settle_yaw_rad,
          OptionInfo{0.01, 1.0, "rad", "Greatest heading error at rest"});
    field("settle_s", self.settle_s, OptionInfo{0.0, 10.0, "s", "Rest before a picture is taken"});
    field("settle_timeout_s", self.settle_timeout_s,
          OptionInfo{1.0, 300.0, "s", "No rest until then: the look fails"});
    field("picture_tries", self.picture_tries, OptionInfo{1, 20, "", "How often a picture is tried"});
    field("picture_timeout_s", self.picture_timeout_s,
          OptionInfo{1.0, 300.0, "s", "For taking and handing over one picture"});
    field("takeoff_timeout_s", self.takeoff_timeout_s,
          OptionInfo{5.0, 600.0, "s", "From the command to the height"});
    field("corridor_align_m", self.corridor_align_m,
          OptionInfo{0.02, 1.0, "m", "How well it lines up before it enters"});
    field("corridor_margin_ratio", self.corridor_margin_ratio,
          OptionInfo{0.0, 1.0, "", "Share of the safety margin that may be used up before it backs out"});
    field("hold_after_silence_s", self.hold_after_silence_s,
          OptionInfo{0.5, 60.0, "s", "Service silent: wait in place"});
    field("return_after_silence_s", self.return_after_silence_s,
          OptionInfo{1.0, 3600.0, "s", "Service silent: return home and land"});
    field("return_height_m", self.return_height_m,
          OptionInfo{1.0, 1000.0, "m",
                     "The way home is at least so high, and as high as this flight ever was"});
    field("return_speed_mps", self.return_speed_mps, OptionInfo{0.1, 20.0, "m/s", "On the way home"});
    field("finish_corridor_in_silence", self.finish_corridor_in_silence,
          OptionInfo{0, 1, "", "Service silent in a corridor: true: fly on to its end; false: back out"});
    field("rival_listen_s", self.rival_listen_s,
          OptionInfo{0.0, 60.0, "s",
                     "Listens so long for another agent of the same vehicle before it commands"});
  }
};

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

/// One thing to do after another, as commands are carried out.
struct Stage {
  enum class Kind {
    kClimb,    ///< Take off to `height_m`.
    kFly,      ///< Along `path`, to rest at its end.
    kAlign,    ///< To the nearest point of the corridor's line, better than usual.
    kPass,     ///< Along the corridor to its end.
    kBackOut,  ///< Along the corridor to its entry.
    kSettle,   ///< Until the vehicle and its camera are at rest.
    kExpose,   ///< Until the picture is taken and handed over.
    kStop,     ///< Come to rest as soon as possible.
    kDescend,  ///< Land here.
  };
  Kind kind = Kind::kStop;
  std::vector<Eigen::Vector3d> path{};
  double height_m = 0.0;
  double speed_mps = 0.0;
  std::optional<double> yaw_rad{};           ///< None: as it is.
  std::optional<double> camera_pitch_rad{};  ///< For the gimbal.
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
  struct CorridorLine {
    Eigen::Vector3d entry_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d exit_m = Eigen::Vector3d::Zero();
    double yaw_rad = 0.0;
    double speed_mps = 0.0;
    double lateral_limit_m = 0.0;
    double vertical_limit_m = 0.0;
  };

  /// How far the first stage of the plan has come.
  struct Progress {
    bool has_begun = false;
    PathRun run;
    double active_s = 0.0;  ///< Time in which it was allowed to go on.
    double allowed_s = 0.0;
    double calm_s = 0.0;     ///< How long it has been at rest.
    double lateral_m = 0.0;  ///< Smoothed deviation in a corridor.
    double vertical_m = 0.0;
    int picture_tries = 0;
    std::optional<std::uint64_t> request_id;
    std::optional<PictureOutcome> picture;
  };

  struct StageEnd {
    std::string problem;  ///< Empty: it did what it should.
  };

  void Handle(const Beat&, Instant now);
  void Handle(const Telemetry& telemetry, Instant now);
  void Handle(const FlightCommand& command, Instant now);
  void Handle(const ServiceHeartbeat& heartbeat, Instant now);
  void Handle(const PictureOutcome& outcome, Instant now);
  void Handle(const CameraHealth& health, Instant now);
  void Handle(const RivalHeard& rival, Instant now);

  GuardContext MakeContext(const FlightCommand& command, Instant now) const;
  VehiclePhase PhaseOf(Instant now) const;
  std::string MessageOf(Instant now) const;
  bool IsPilotInControl() const { return telemetry_.is_armed && !telemetry_.is_in_our_mode; }
  bool IsAirborne() const { return telemetry_.is_armed && telemetry_.is_in_air; }
  bool IsServiceSilent(Instant now) const;
  std::optional<CameraId> ChooseCamera(double pitch_rad) const;

  void BeginMission(std::uint64_t mission_id);
  void Answer(const FlightCommand& command, AckStatus status, const std::string& reason, Instant now);
  void FinishCommand(AckStatus status, const std::string& reason, Instant now);
  void Begin(const FlightCommand& command, Instant now);
  std::deque<Stage> MakePlan(const FlightCommand& command) const;
  std::deque<Stage> MakeReturnPlan() const;
  CorridorLine MakeCorridorLine(const FlightCommand& command) const;
  Stage MakeBackOut() const;
  void SetPlan(std::deque<Stage> plan);

  void WatchVehicle(Instant now);
  void WatchForReturn(Instant now);
  void RunPlan(double dt_s, Instant now);
  void BeginStage(const Stage& stage, Instant now);
  std::optional<StageEnd> RunStage(const Stage& stage, double dt_s, Instant now);
  std::optional<StageEnd> RunClimb(const Stage& stage);
  std::optional<StageEnd> RunPath(const Stage& stage, double dt_s, Instant now);
  std::optional<StageEnd> RunSettle(double dt_s);
  std::optional<StageEnd> RunExposure(Instant now);
  std::optional<StageEnd> WatchCorridor(double dt_s);
  void EndStage(const Stage& stage, const StageEnd& end, Instant now);
  void HoldAt(const Eigen::Vector3d& position_in_map_m);
  Eigen::Vector3d PathStart() const;
  bool IsAtRest() const;
  void Note(std::string text) { outputs_.notes.push_back(std::move(text)); }

  AgentIdentity identity_;
  AgentOptions options_;
  GuardOptions guard_;

  Telemetry telemetry_;
  CameraHealth cameras_;
  Instant began_;
  Instant last_beat_;
  Instant service_heard_;
  Instant position_seen_;
  std::optional<RivalHeard> rival_;
  Instant rival_heard_;

  std::uint64_t mission_id_ = 0;
  std::uint32_t last_sequence_ = 0;
  std::vector<std::uint64_t> old_missions_;
  std::map<std::uint32_t, CommandAck> answers_;  ///< To the commands of this mission.
  std::uint64_t newest_scene_revision_ = 0;

  std::optional<FlightCommand> command_;  ///< That is being carried out.
  std::deque<Stage> plan_;
  Progress progress_;
  Intent intent_;
  std::optional<CorridorLine> corridor_;  ///< Set while the vehicle is, or may be, inside of one.
  std::string return_reason_;             ///< Not empty: it is on its way home by its own decision.
  double greatest_height_m_ = 0.0;
  std::uint64_t next_request_id_ = 1;
  std::string last_problem_;
  AgentOutputs outputs_;
};

}  // namespace soffit
