#include "test/sim/world/noise.h"

#include <algorithm>
#include <cmath>

namespace soffit::sim {
namespace {

float AtLattice(std::int32_t x, std::int32_t y, std::int32_t z) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x8da6b343U ^
                    static_cast<std::uint32_t>(y) * 0xd8163841U ^ static_cast<std::uint32_t>(z) * 0xcb1ab31fU;
  h = (h ^ (h >> 15U)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12U)) * 0x297a2d39U;
  return static_cast<float>(h >> 8U) * (2.0F / 16777216.0F) - 1.0F;
}

float Mix(float a, float b, float ratio) { return a + ratio * (b - a); }
float Fade(float t) { return t * t * t * (t * (t * 6.0F - 15.0F) + 10.0F); }

}  // namespace

float Noise(const Eigen::Vector3f& point) {
  const float fx = std::floor(point.x()), fy = std::floor(point.y()), fz = std::floor(point.z());
  const auto x = static_cast<std::int32_t>(fx), y = static_cast<std::int32_t>(fy),
             z = static_cast<std::int32_t>(fz);
  const float u = Fade(point.x() - fx), v = Fade(point.y() - fy), w = Fade(point.z() - fz);
  const auto along_x = [&](int dy, int dz) {
    return Mix(AtLattice(x, y + dy, z + dz), AtLattice(x + 1, y + dy, z + dz), u);
  };
  return Mix(Mix(along_x(0, 0), along_x(1, 0), v), Mix(along_x(0, 1), along_x(1, 1), v), w);
}

float FractalNoise(const Eigen::Vector3f& point, float octaves) {
  float sum = 0.0F;
  float weight = 0.45F;
  Eigen::Vector3f at = point;
  for (float left = octaves; left > 0.0F; left -= 1.0F) {
    sum += weight * std::min(left, 1.0F) * Noise(at);
    weight *= 0.68F;
    at = 2.0F * at + Eigen::Vector3f(17.3F, 31.7F, 11.1F);
  }
  return sum;
}

}  // namespace soffit::sim
