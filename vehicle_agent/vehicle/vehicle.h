#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>

#include "shared/flight/flight.h"
#include "shared/frames/frames.h"

// What passes between the agent's own thinking (agent/) and the autopilot's ways (autopilot/).
namespace soffit {

/// One moment on both clocks. Durations are taken from the steady one, which never jumps; 0 means never.
struct Instant {
  std::int64_t steady_ns = 0;
  std::int64_t utc_ns = 0;
};

constexpr double SecondsBetween(const Instant& earlier, const Instant& later) {
  return ToSeconds(later.steady_ns - earlier.steady_ns);
}

/// What the autopilot tells of the vehicle, in the map frame. A default object: no autopilot was heard.
struct Telemetry {
  bool is_connected = false;    ///< Its heartbeat is fresh.
  std::string autopilot;        ///< "ArduPilot", "PX4" or "".
  std::string mode;             ///< As people call it: "GUIDED".
  bool is_in_our_mode = false;  ///< One that the agent commands in, or that it asked for itself.
  bool is_in_failsafe = false;
  bool is_armed = false;
  bool is_in_air = false;
  std::string not_ready = "no autopilot was heard";  ///< Why it would not arm and take off; empty: it would.
  std::string
      intent_problem;  ///< Why the present intent cannot be carried out; empty: nothing is known against it.
  bool has_position = false;  ///< The next five are there and fresh.
  Eigen::Vector3d position_in_map_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_in_map_mps = Eigen::Vector3d::Zero();
  Eigen::Quaterniond map_from_body = Eigen::Quaterniond::Identity();  ///< Body: FLU.
  double yaw_rad = 0.0;                                               ///< Counter-clockwise from east.
  double rotation_rate_radps = 0.0;
  std::string
      position_doubt;  ///< Why the position must not be relied on; empty: nothing is known against it.
  double position_std_m = 0.0;  ///< Per axis.
  double orientation_std_rad = 0.0;
  double battery_ratio = -1.0;             ///< Negative: not known.
  std::optional<GeodeticOrigin> origin;    ///< Of the map.
  std::optional<double> gimbal_pitch_rad;  ///< 0: horizontal; none: no gimbal reports.
};

/// Which camera takes a picture.
enum class CameraId { kForward, kDown, kGimbal };
constexpr const char* ToString(CameraId id) {
  return id == CameraId::kForward ? "forward" : id == CameraId::kDown ? "down" : "gimbal";
}

/// What the vehicle should be doing now. It is said again and again; the autopilot's side makes it so, with
/// as many commands and repetitions as that takes. The zero value commands nothing.
struct Intent {
  enum class Kind { kNone, kTakeOff, kFlyTo, kLand };
  Kind kind = Kind::kNone;
  std::uint32_t order =
      0;  ///< Another number: something else is wanted, and is said to the autopilot at once.
  Eigen::Vector3d position_in_map_m =
      Eigen::Vector3d::Zero();             ///< kTakeOff: only its height counts. kLand: unused.
  double yaw_rad = 0.0;                    ///< Counter-clockwise from east.
  std::optional<double> camera_pitch_rad;  ///< For the gimbal; none: leave it.
};

}  // namespace soffit
