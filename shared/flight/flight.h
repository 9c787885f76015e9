#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/capture/capture.h"

namespace soffit {

constexpr double ToSeconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }
constexpr std::int64_t ToNanoseconds(double s) { return static_cast<std::int64_t>(s * 1e9); }

/// The vehicle as a vertical cylinder about its centre, and the distance that it has to keep from everything.
struct VehicleEnvelope {
  double radius_m = 0.0;
  double height_m = 0.0;
  double safety_margin_m = 0.0;

  double NeededWidth_m() const { return 2.0 * (radius_m + safety_margin_m); }
  double NeededHeight_m() const { return height_m + 2.0 * safety_margin_m; }
};

/// Finite and positive (the margin may be zero). A default object is not valid.
bool IsValid(const VehicleEnvelope& envelope);

/// How the agent sees its vehicle. The zero value means that nothing can be asked of it.
enum class VehiclePhase {
  kNotReady,  ///< No autopilot, no position, or it would not arm.
  kOnGround,  ///< Ready to take off.
  kTakingOff,
  kHolding,  ///< In the air, at rest, waiting for a command.
  kInTransit,
  kLooking,  ///< At a viewpoint: settling, exposing, sending.
  kInCorridor,
  kLanding,
  kPilotInControl,  ///< The pilot or a failsafe took over; the agent commands nothing.
};
const char* ToString(VehiclePhase phase);

struct GeodeticOrigin {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_amsl_m = 0.0;
};

/// What the agent tells of its vehicle, several times a second.
struct VehicleState {
  std::uint32_t vehicle_id = 0;
  std::uint64_t agent_epoch = 0;  ///< Differs for every start of an agent.
  std::string name;
  std::int64_t stamp_utc_ns = 0;
  VehiclePhase phase = VehiclePhase::kNotReady;
  std::string message;    ///< One line for people: why it is not ready, what it waits for.
  std::string autopilot;  ///< "ArduPilot", "PX4" or "".
  std::string autopilot_mode;
  bool armed = false;
  Eigen::Vector3d position_in_map_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_in_map_mps = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;  ///< Counter-clockwise from east.
  double position_std_m = 0.0;
  double orientation_std_rad = 0.0;
  double battery_ratio = -1.0;           ///< 0 to 1; negative: not known.
  std::optional<GeodeticOrigin> origin;  ///< Of the map frame.
  VehicleEnvelope envelope;
  Intrinsics camera;  ///< Of the forward camera; the downward one is taken as alike.
  double max_speed_mps = 0.0;
};

/// The zero value is safe: stay where you are.
enum class CommandKind { kHold, kTakeOff, kLook, kFlyCorridor, kGoTo, kLand, kAbort };
const char* ToString(CommandKind kind);

/// Leave to enter one corridor, given by a CLEAR decision.
struct CorridorPermit {
  std::uint64_t decision_id = 0;
  std::uint32_t object_id = 0;
  std::uint64_t scene_revision = 0;
  std::int64_t valid_until_utc_ns = 0;
  VehicleEnvelope envelope;  ///< The dimensions that the decision was made for.
  double free_width_m = 0.0;
  double free_height_m = 0.0;
};

/// One thing to do. Commands of a mission are numbered from 1 without gaps; a resent command keeps its
/// number.
struct FlightCommand {
  std::uint32_t vehicle_id = 0;
  std::uint64_t mission_id = 0;
  std::uint32_t sequence = 0;
  std::int64_t issued_utc_ns = 0;
  std::int64_t valid_until_utc_ns = 0;  ///< The command must have begun by then.
  CommandKind kind = CommandKind::kHold;
  std::vector<Eigen::Vector3d> path_in_map_m;  ///< Flown in this order. kTakeOff: only the height counts.
  double yaw_rad = 0.0;                  ///< Heading at the end (kLook, kGoTo) or throughout (kFlyCorridor).
  double speed_mps = 0.0;                ///< Greatest speed on the path.
  double camera_pitch_rad = 0.0;         ///< kLook: 0 horizontal, -pi/2 straight down.
  Purpose purpose = Purpose::kUnknown;   ///< kLook.
  std::uint32_t capture_id = 0;          ///< kLook.
  std::optional<CorridorPermit> permit;  ///< kFlyCorridor; without it the agent refuses.
};

enum class AckStatus { kUnknown, kAccepted, kRefused, kDone, kFailed };
const char* ToString(AckStatus status);

/// The agent's answer. kAccepted is followed by kDone or kFailed; kRefused and kFailed say why.
struct CommandAck {
  std::uint32_t vehicle_id = 0;
  std::uint64_t mission_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t agent_epoch = 0;
  std::int64_t stamp_utc_ns = 0;
  AckStatus status = AckStatus::kUnknown;
  std::string reason;
};

/// The service lives and leads this vehicle. Sent several times a second throughout a mission.
struct MissionHeartbeat {
  std::uint32_t vehicle_id = 0;
  std::uint64_t mission_id = 0;
  std::uint64_t service_epoch = 0;  ///< Differs for every start of the service.
  std::int64_t stamp_utc_ns = 0;
  bool is_paused = false;
};

}  // namespace soffit
