#include "test/sim/vehicle/noise.h"

#include <cmath>

namespace soffit::sim {
namespace {

constexpr double kGustCorrelation_s = 1.5;

}  // namespace

WanderingNoise::WanderingNoise(double std, double correlation_s, std::uint64_t seed)
    : std_(std), correlation_s_(correlation_s), random_(seed), value_(Draw()) {}

Eigen::Vector3d WanderingNoise::Draw() {
  Eigen::Vector3d drawn;
  for (double& number : drawn) number = std_ * normal_(random_);
  return drawn;
}

const Eigen::Vector3d& WanderingNoise::Step(double dt_s) {
  const double kept = std::exp(-dt_s / correlation_s_);
  value_ = kept * value_ + std::sqrt(1.0 - kept * kept) * Draw();
  return value_;
}

MovingAir::MovingAir(const Wind& wind, std::uint64_t seed)
    : mean_mps_(wind.mean_mps.x(), wind.mean_mps.y(), 0.0),
      gusts_(wind.gust_std_mps, kGustCorrelation_s, seed) {}

Eigen::Vector3d MovingAir::Step(double dt_s) {
  return mean_mps_ + gusts_.Step(dt_s).cwiseProduct(Eigen::Vector3d(1.0, 1.0, 0.5));
}

}  // namespace soffit::sim
