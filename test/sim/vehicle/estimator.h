#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "test/sim/vehicle/multicopter.h"
#include "test/sim/vehicle/noise.h"

namespace soffit::sim {

/// What the vehicle believes of itself, in the map.
struct Estimate {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Quaterniond map_from_body = Eigen::Quaterniond::Identity();
  Eigen::Vector3d rate_in_body_radps = Eigen::Vector3d::Zero();
};

/// An estimator whose position and attitude are wrong by the world's pose noise: per axis, nine tenths of the
/// variance drift within about 20 s, the rest jitters within half a second. The estimate is what the flight
/// controller flies by, so that the vehicle itself is off its path by the drift.
class Estimator {
 public:
  Estimator(const PoseNoise& noise, std::uint64_t seed);

  Estimate Step(const BodyState& truth, double dt_s);

  /// The attitude that the vehicle really takes when it believes to have `attitude`.
  Eigen::Quaterniond ToTruth(const Eigen::Quaterniond& attitude) const;

 private:
  WanderingNoise position_drift_;
  WanderingNoise position_jitter_;
  WanderingNoise attitude_drift_;
  WanderingNoise attitude_jitter_;
  Eigen::Quaterniond believed_from_true_ = Eigen::Quaterniond::Identity();
};

}  // namespace soffit::sim
