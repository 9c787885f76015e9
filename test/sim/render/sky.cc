#include "test/sim/render/sky.h"

#include <algorithm>
#include <cmath>

#include "test/sim/world/noise.h"

namespace soffit::sim {
namespace {

const Light kZenith{0.16F, 0.28F, 0.52F};
const Light kHorizon{0.62F, 0.70F, 0.80F};
const Light kCloud{0.85F, 0.87F, 0.90F};

Light Blend(const Light& a, const Light& b, float ratio) { return a + ratio * (b - a); }

Light ClearSky(float height) {
  return Blend(kHorizon, kZenith, std::pow(std::clamp(height, 0.0F, 1.0F), 0.45F));
}

/// Of the light of ClearSky that falls on level ground: the integral over the half sphere, weighted by the
/// height.
Light SkylightOf(const auto& radiance) {
  constexpr int kRings = 64;
  Light sum = Light::Zero();
  for (int i = 0; i < kRings; ++i) {
    const float height = (static_cast<float>(i) + 0.5F) / kRings;
    sum += radiance(height) * height * (2.0F / kRings);
  }
  return sum;
}

}  // namespace

Light ToLinear(const Eigen::Vector3d& color_srgb) {
  Light light;
  for (int i = 0; i < 3; ++i) {
    const double c = color_srgb[i];
    light[i] = static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return light;
}

SkyDome::SkyDome(const Sky& sky, const Sun& sun)
    : cloud_ratio_(sky.cloud_ratio),
      toward_sun_(static_cast<float>(std::cos(sun.elevation_rad) * std::cos(sun.yaw_rad)),
                  static_cast<float>(std::cos(sun.elevation_rad) * std::sin(sun.yaw_rad)),
                  static_cast<float>(std::sin(sun.elevation_rad))) {
  // Low sun is redder (longer way through the air); clouds take light from the sun and give it to the sky.
  const auto air = static_cast<float>(1.0 / (std::sin(sun.elevation_rad) + 0.08));
  const auto strength = static_cast<float>(sun.strength * (1.0 - 0.55 * sky.cloud_ratio * sky.cloud_ratio));
  sunlight_ =
      1.15F * strength * Light(std::exp(-0.03F * air), std::exp(-0.06F * air), std::exp(-0.12F * air));
  skylight_ = SkylightOf([&](float height) {
    return Glow({std::sqrt(1.0F - height * height), 0.0F, height});
  });
  haze_ = Glow({1.0F, 0.0F, 0.0F});
}

Light SkyDome::Glow(const Eigen::Vector3f& direction) const {
  constexpr float kOfClouds = 0.6F;
  return 0.55F * Blend(ClearSky(direction.z()), kCloud, kOfClouds * static_cast<float>(cloud_ratio_));
}

Light SkyDome::LookInto(const Eigen::Vector3f& direction) const {
  const float height = std::max(direction.z(), 0.0F);
  const Eigen::Vector3f in_layer(direction.x() / (height + 0.12F), direction.y() / (height + 0.12F), 3.7F);
  const float density = FractalNoise(1.3F * in_layer, 5.0F) + 1.7F * static_cast<float>(cloud_ratio_) - 0.85F;
  const float cover = std::clamp(density / 0.35F, 0.0F, 1.0F) * std::min(1.0F, height / 0.05F);
  const float toward = std::max(0.0F, direction.dot(toward_sun_));
  const Light halo = 0.25F * std::pow(toward, 24.0F) * Light(1.0F, 0.95F, 0.85F);
  return 0.9F * Blend(ClearSky(height), kCloud, 0.85F * cover) + halo;
}

}  // namespace soffit::sim
