#pragma once

#include <Eigen/Geometry>

#include "test/sim/vehicle/estimator.h"

namespace soffit::sim {

/// A gimbal that keeps the camera level and points it: pitch against the horizon, yaw against the vehicle's
/// nose or against north. Turns at up to 60 degrees a second.
class Gimbal {
 public:
  /// Angles as in MAVLink's gimbal protocol: pitch up and yaw clockwise are positive; NaN leaves an angle as
  /// it is.
  void Point(double pitch_rad, double yaw_rad, bool is_yaw_against_north);

  void Step(const Eigen::Quaterniond& map_from_body, double dt_s);

  double pitch_rad() const { return pitch_rad_; }             ///< Up.
  double yaw_from_north_rad() const { return heading_rad_; }  ///< Clockwise.
  double yaw_from_nose_rad() const { return yaw_from_nose_rad_; }
  bool is_yaw_against_north() const { return is_yaw_against_north_; }

  /// Attitude of the camera (optical frame) as the gimbal believes it.
  Eigen::Quaterniond MapFromCamera() const;

 private:
  double target_pitch_rad_ = 0.0;
  double target_yaw_rad_ = 0.0;
  bool is_yaw_against_north_ = false;
  double pitch_rad_ = 0.0;
  double heading_rad_ = 0.0;
  double yaw_from_nose_rad_ = 0.0;
};

}  // namespace soffit::sim
