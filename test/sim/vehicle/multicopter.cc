#include "test/sim/vehicle/multicopter.h"

#include <algorithm>
#include <cmath>

namespace soffit::sim {

Multicopter::Multicopter(const BodyState& start, const Airframe& airframe)
    : airframe_(airframe), state_(start) {}

void Multicopter::Break() {
  is_broken_ = true;
  state_.velocity_mps.setZero();
}

void Multicopter::Step(const MotorCommand& command, const Eigen::Vector3d& wind_mps, double dt_s) {
  const bool has_power = command.motors_on && !is_broken_ && state_.battery_ratio > 0.0;
  const double wanted_mps2 =
      has_power ? std::clamp(command.thrust_mps2, 0.0, airframe_.max_thrust_mps2) : 0.0;
  thrust_mps2_ += (wanted_mps2 - thrust_mps2_) * std::min(1.0, dt_s / airframe_.thrust_lag_s);
  state_.battery_ratio =
      std::max(0.0, state_.battery_ratio - dt_s / airframe_.hover_endurance_s * thrust_mps2_ / kGravity_mps2);

  if (state_.is_on_ground && thrust_mps2_ <= kGravity_mps2) {
    state_.velocity_mps.setZero();
    state_.rate_in_body_radps.setZero();
    return;
  }
  if (has_power) Turn(command.map_from_body, dt_s);

  const Eigen::Vector3d up(0.0, 0.0, 1.0);
  const Eigen::Vector3d acceleration_mps2 = state_.map_from_body * (thrust_mps2_ * up) - kGravity_mps2 * up -
                                            airframe_.drag_per_s * (state_.velocity_mps - wind_mps);
  state_.velocity_mps += acceleration_mps2 * dt_s;
  state_.position_m += state_.velocity_mps * dt_s;
  MeetGround();
}

/// Second-order attitude response with limited rates.
void Multicopter::Turn(const Eigen::Quaterniond& target, double dt_s) {
  Eigen::Quaterniond body_from_target = state_.map_from_body.conjugate() * target;
  if (body_from_target.w() < 0.0) body_from_target.coeffs() *= -1.0;
  const Eigen::AngleAxisd turn(body_from_target);
  const Eigen::Vector3d frequency(airframe_.tilt_frequency_radps, airframe_.tilt_frequency_radps,
                                  airframe_.yaw_frequency_radps);
  const Eigen::Vector3d error_rad = turn.angle() * turn.axis();
  const Eigen::Vector3d acceleration =
      frequency.cwiseAbs2().cwiseProduct(error_rad) -
      2.0 * airframe_.damping_ratio * frequency.cwiseProduct(state_.rate_in_body_radps);
  Eigen::Vector3d& rate = state_.rate_in_body_radps;
  rate += acceleration * dt_s;
  rate = rate.cwiseMin(airframe_.max_rate_radps).cwiseMax(-airframe_.max_rate_radps);
  if (const double angle = rate.norm() * dt_s; angle > 0.0) {
    state_.map_from_body =
        (state_.map_from_body * Eigen::Quaterniond(Eigen::AngleAxisd(angle, rate.normalized()))).normalized();
  }
}

void Multicopter::MeetGround() {
  if (state_.position_m.z() > 0.0) {
    state_.is_on_ground = false;
    return;
  }
  if (!state_.is_on_ground) state_.touchdown_speed_mps = state_.velocity_mps.norm();
  state_.is_on_ground = true;
  state_.position_m.z() = 0.0;
  state_.velocity_mps.setZero();
  state_.rate_in_body_radps.setZero();
  const Eigen::Vector3d forward = state_.map_from_body * Eigen::Vector3d::UnitX();
  state_.map_from_body = Eigen::AngleAxisd(std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ());
}

}  // namespace soffit::sim
