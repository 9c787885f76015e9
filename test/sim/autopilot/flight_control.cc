#include "test/sim/autopilot/flight_control.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace soffit::sim {
namespace {

// Shaping of the path.
constexpr double kApproachGain_per_s = 0.95;  // Near the target, speed is this times the distance.
constexpr double kBrakingShare = 0.7;
constexpr double kSpeedGain_per_s = 3.0;
constexpr double kJerkLag_s = 0.15;
// Holding the path.
constexpr double kPositionGain_per_s = 1.5;
constexpr double kVelocityGain_per_s = 3.0;
constexpr double kTrimGain_per_s2 = 1.5;
constexpr double kMaxTrim_mps2 = 3.0;
constexpr double kMaxTilt = 0.52;  // Radians.

/// The speed at which one can still stop within `distance_m`, with some acceleration in reserve.
double SpeedFor(double distance_m, double max_acceleration_mps2) {
  const double acceleration_mps2 = kBrakingShare * max_acceleration_mps2;
  const double linear_m = acceleration_mps2 / (kApproachGain_per_s * kApproachGain_per_s);
  if (distance_m < linear_m) return kApproachGain_per_s * distance_m;
  return std::sqrt(2.0 * acceleration_mps2 * (distance_m - 0.5 * linear_m));
}

Eigen::Vector2d ClampLength(const Eigen::Vector2d& vector, double most) {
  const double length = vector.norm();
  return length > most ? Eigen::Vector2d(vector * (most / length)) : vector;
}

}  // namespace

double WrapAngle(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

double YawOf(const Eigen::Quaterniond& map_from_body) {
  const Eigen::Vector3d forward = map_from_body * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

MotorCommand FlightControl::Step(const FlightGoal& goal, const FlightLimits& limits, const Estimate& estimate,
                                 double dt_s) {
  if (goal.kind == FlightGoal::Kind::kMotorsOff || goal.kind == FlightGoal::Kind::kIdle) {
    is_flying_ = false;
    return {goal.kind == FlightGoal::Kind::kIdle, 0.1 * kGravity_mps2, estimate.map_from_body};
  }
  if (!is_flying_) Reset(estimate);
  ShapePath(goal, limits, dt_s);
  return FollowPath(estimate, dt_s);
}

void FlightControl::Reset(const Estimate& estimate) {
  is_flying_ = true;
  path_position_m_ = estimate.position_m;
  path_velocity_mps_ = estimate.velocity_mps;
  path_acceleration_mps2_.setZero();
  trim_mps2_.setZero();
  path_yaw_rad_ = YawOf(estimate.map_from_body);
}

void FlightControl::ShapePath(const FlightGoal& goal, const FlightLimits& limits, double dt_s) {
  Eigen::Vector3d wanted_mps = goal.velocity_mps;
  if (goal.kind == FlightGoal::Kind::kPosition) {
    const Eigen::Vector3d way_m = goal.position_m - path_position_m_;
    const double distance_m = way_m.head<2>().norm();
    if (distance_m > 0.0) {
      wanted_mps.head<2>() += way_m.head<2>() / distance_m * SpeedFor(distance_m, limits.acceleration_mps2);
    }
    wanted_mps.z() +=
        std::copysign(SpeedFor(std::abs(way_m.z()), limits.vertical_acceleration_mps2), way_m.z());
  }
  wanted_mps.head<2>() = ClampLength(wanted_mps.head<2>(), limits.speed_mps);
  wanted_mps.z() = std::clamp(wanted_mps.z(), -limits.descent_mps, limits.climb_mps);

  Eigen::Vector3d wanted_mps2 = kSpeedGain_per_s * (wanted_mps - path_velocity_mps_);
  wanted_mps2.head<2>() = ClampLength(wanted_mps2.head<2>(), limits.acceleration_mps2);
  wanted_mps2.z() =
      std::clamp(wanted_mps2.z(), -limits.vertical_acceleration_mps2, limits.vertical_acceleration_mps2);
  path_acceleration_mps2_ += (wanted_mps2 - path_acceleration_mps2_) * (dt_s / kJerkLag_s);
  path_velocity_mps_ += path_acceleration_mps2_ * dt_s;
  path_position_m_ += path_velocity_mps_ * dt_s;

  const double most_rad = limits.yaw_rate_radps * dt_s;
  path_yaw_rad_ =
      WrapAngle(path_yaw_rad_ + std::clamp(WrapAngle(goal.yaw_rad - path_yaw_rad_), -most_rad, most_rad));
}

MotorCommand FlightControl::FollowPath(const Estimate& estimate, double dt_s) {
  const Eigen::Vector3d velocity_error_mps = path_velocity_mps_ +
                                             kPositionGain_per_s * (path_position_m_ - estimate.position_m) -
                                             estimate.velocity_mps;
  trim_mps2_ += kTrimGain_per_s2 * velocity_error_mps * dt_s;
  trim_mps2_ = trim_mps2_.cwiseMin(kMaxTrim_mps2).cwiseMax(-kMaxTrim_mps2);
  const Eigen::Vector3d wanted_mps2 =
      path_acceleration_mps2_ + kVelocityGain_per_s * velocity_error_mps + trim_mps2_;

  const double lift_mps2 = std::max(0.3 * kGravity_mps2, kGravity_mps2 + wanted_mps2.z());
  const Eigen::Vector2d push_mps2 = ClampLength(wanted_mps2.head<2>(), lift_mps2 * std::tan(kMaxTilt));
  const Eigen::Vector3d thrust_mps2(push_mps2.x(), push_mps2.y(), lift_mps2);

  Eigen::Matrix3d attitude;
  attitude.col(2) = thrust_mps2.normalized();
  const Eigen::Vector3d left(-std::sin(path_yaw_rad_), std::cos(path_yaw_rad_), 0.0);
  attitude.col(0) = left.cross(attitude.col(2)).normalized();
  attitude.col(1) = attitude.col(2).cross(attitude.col(0));
  return {true, thrust_mps2.norm(), Eigen::Quaterniond(attitude).normalized()};
}

}  // namespace soffit::sim
