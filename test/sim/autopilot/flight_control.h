#pragma once

#include <Eigen/Core>

#include "test/sim/vehicle/estimator.h"
#include "test/sim/vehicle/multicopter.h"

namespace soffit::sim {

/// Where to fly to, or how fast, in the map. The zero value: motors off.
struct FlightGoal {
  enum class Kind { kMotorsOff, kIdle, kPosition, kVelocity } kind = Kind::kMotorsOff;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< kPosition.
  Eigen::Vector3d velocity_mps =
      Eigen::Vector3d::Zero();  ///< kVelocity; kPosition: how fast the target itself moves.
  double yaw_rad = 0.0;
};

struct FlightLimits {
  double speed_mps = 10.0;  ///< Horizontal.
  double climb_mps = 2.5;
  double descent_mps = 1.5;
  double acceleration_mps2 = 2.5;
  double vertical_acceleration_mps2 = 1.5;
  double yaw_rate_radps = 1.05;
};

/// Flies to a goal on a path shaped so that speed, acceleration and its change stay within limits (a
/// square-root controller, as in ArduPilot's AC_PosControl), and holds that path with a position loop around
/// a velocity loop.
class FlightControl {
 public:
  MotorCommand Step(const FlightGoal& goal, const FlightLimits& limits, const Estimate& estimate,
                    double dt_s);

  /// Where the shaped path is now.
  const Eigen::Vector3d& path_position_m() const { return path_position_m_; }

 private:
  void Reset(const Estimate& estimate);
  void ShapePath(const FlightGoal& goal, const FlightLimits& limits, double dt_s);
  MotorCommand FollowPath(const Estimate& estimate, double dt_s);

  bool is_flying_ = false;
  Eigen::Vector3d path_position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d path_velocity_mps_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d path_acceleration_mps2_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d trim_mps2_ = Eigen::Vector3d::Zero();  ///< Against steady wind and a tilted estimate.
  double path_yaw_rad_ = 0.0;
};

/// The angle's equal between -pi and pi.
double WrapAngle(double angle_rad);
double YawOf(const Eigen::Quaterniond& map_from_body);

}  // namespace soffit::sim
