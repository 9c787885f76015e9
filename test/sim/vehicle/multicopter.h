#pragma once

#include <Eigen/Geometry>

namespace soffit::sim {

constexpr double kGravity_mps2 = 9.80665;

/// The true state of the vehicle. Position is that of its reference point, which is on the ground (z = 0)
/// when landed.
struct BodyState {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();               ///< In the map.
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();             ///< In the map.
  Eigen::Quaterniond map_from_body = Eigen::Quaterniond::Identity();  ///< Body: x forward, y left, z up.
  Eigen::Vector3d rate_in_body_radps = Eigen::Vector3d::Zero();
  double battery_ratio = 1.0;
  bool is_on_ground = true;
  double touchdown_speed_mps = 0.0;  ///< How fast it was when it last met the ground.
};

/// What the flight controller asks of the motors. The zero value: motors off.
struct MotorCommand {
  bool motors_on = false;
  double thrust_mps2 = 0.0;                                           ///< Along the body's z axis, per mass.
  Eigen::Quaterniond map_from_body = Eigen::Quaterniond::Identity();  ///< Attitude to turn to.
};

struct Airframe {
  double drag_per_s = 0.2;  ///< Deceleration per speed through the air.
  double max_thrust_mps2 = 20.0;
  double thrust_lag_s = 0.05;
  double tilt_frequency_radps = 8.0;  ///< Natural frequency of roll and pitch; lags about 0.25 s.
  double yaw_frequency_radps = 5.0;
  double damping_ratio = 0.9;
  double max_rate_radps = 3.5;
  double hover_endurance_s = 1200.0;
};

/// A multicopter with inertia: thrust along its own axis, an attitude that turns with a lag, drag in moving
/// air, flat ground, a battery. The same commands give the same flight.
class Multicopter {
 public:
  explicit Multicopter(const BodyState& start, const Airframe& airframe = {});

  /// One step of 1 to 10 ms. `wind_mps` is the velocity of the air in the map.
  void Step(const MotorCommand& command, const Eigen::Vector3d& wind_mps, double dt_s);

  /// It is stopped where it is, and from now on it falls: something broke.
  void Break();
  void SetBattery(double ratio) { state_.battery_ratio = ratio; }

  const BodyState& state() const { return state_; }

 private:
  void Turn(const Eigen::Quaterniond& target, double dt_s);
  void MeetGround();

  Airframe airframe_;
  BodyState state_;
  double thrust_mps2_ = 0.0;
  bool is_broken_ = false;
};

}  // namespace soffit::sim
