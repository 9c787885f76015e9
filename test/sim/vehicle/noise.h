#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// Noise that wanders: three independent first-order Gauss-Markov processes, each of standard deviation `std`
/// and forgetting itself within `correlation_s`. Begins somewhere in its distribution.
class WanderingNoise {
 public:
  WanderingNoise(double std, double correlation_s, std::uint64_t seed);
  const Eigen::Vector3d& Step(double dt_s);
  const Eigen::Vector3d& value() const { return value_; }

 private:
  Eigen::Vector3d Draw();

  double std_;
  double correlation_s_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d value_;
};

/// Moving air: a mean and gusts, whose spectrum is that of Dryden's horizontal gusts (MIL-F-8785C) at a
/// height of a few metres; vertical gusts are half as strong.
class MovingAir {
 public:
  MovingAir(const Wind& wind, std::uint64_t seed);
  Eigen::Vector3d Step(double dt_s);  ///< Velocity of the air in the map [m/s].

 private:
  Eigen::Vector3d mean_mps_;
  WanderingNoise gusts_;
};

}  // namespace soffit::sim
