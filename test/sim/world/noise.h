#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace soffit::sim {

/// A well-mixed 64-bit number (the finaliser of SplitMix64, S. Vigna).
constexpr std::uint64_t Mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

/// From 0 (included) to 1 (excluded).
constexpr double ToUnit(std::uint64_t bits) { return static_cast<double>(bits >> 11U) * 0x1.0p-53; }

/// Smooth noise, one feature per unit of length, from -1 to 1: value noise on a lattice (K. Perlin, 1985).
float Noise(const Eigen::Vector3f& point);

/// Sum of octaves, each twice as fine and two thirds as strong, from about -1 to 1. `octaves` may be broken:
/// the last one fades.
float FractalNoise(const Eigen::Vector3f& point, float octaves);

}  // namespace soffit::sim
