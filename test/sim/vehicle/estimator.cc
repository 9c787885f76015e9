#include "test/sim/vehicle/estimator.h"

#include <cmath>

namespace soffit::sim {
namespace {

constexpr double kDriftCorrelation_s = 20.0;
constexpr double kJitterCorrelation_s = 0.5;
const double kDriftShare = std::sqrt(0.9);
const double kJitterShare = std::sqrt(0.1);

}  // namespace

Estimator::Estimator(const PoseNoise& noise, std::uint64_t seed)
    : position_drift_(kDriftShare * noise.position_std_m, kDriftCorrelation_s, seed),
      position_jitter_(kJitterShare * noise.position_std_m, kJitterCorrelation_s, seed + 1),
      attitude_drift_(kDriftShare * noise.orientation_std_rad, kDriftCorrelation_s, seed + 2),
      attitude_jitter_(kJitterShare * noise.orientation_std_rad, kJitterCorrelation_s, seed + 3) {}

Estimate Estimator::Step(const BodyState& truth, double dt_s) {
  const Eigen::Vector3d turn = attitude_drift_.Step(dt_s) + attitude_jitter_.Step(dt_s);
  believed_from_true_ = Eigen::AngleAxisd(turn.norm(), turn.stableNormalized());
  return {truth.position_m + position_drift_.Step(dt_s) + position_jitter_.Step(dt_s), truth.velocity_mps,
          (believed_from_true_ * truth.map_from_body).normalized(), truth.rate_in_body_radps};
}

Eigen::Quaterniond Estimator::ToTruth(const Eigen::Quaterniond& attitude) const {
  return (believed_from_true_.conjugate() * attitude).normalized();
}

}  // namespace soffit::sim
