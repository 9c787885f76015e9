#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "test/sim/world/noise.h"

namespace soffit::sim {

/// Random numbers that are the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : state_(Mix(seed)) {}

  double Unit() { return ToUnit(Mix(state_++)); }
  double Between(double low, double high) { return low + (high - low) * Unit(); }
  int Pick(int count) { return static_cast<int>(Unit() * count); }  ///< 0 to count - 1.
  bool Chance(double ratio) { return Unit() < ratio; }
  double Normal() {  ///< Mean 0, standard deviation 1 (Box and Muller).
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Unit()));
    return radius * std::cos(2.0 * std::numbers::pi * Unit());
  }

 private:
  std::uint64_t state_;
};

}  // namespace soffit::sim
