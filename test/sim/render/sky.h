#pragma once

#include <Eigen/Core>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// Linear RGB.
using Light = Eigen::Vector3f;

Light ToLinear(const Eigen::Vector3d& color_srgb);

/// Where light comes from. Radiance is relative: a white surface in full sun has about 1.
class SkyDome {
 public:
  SkyDome(const Sky& sky, const Sun& sun);

  const Eigen::Vector3f& toward_sun() const { return toward_sun_; }
  const Light& sunlight() const { return sunlight_; }  ///< On a surface that faces the sun.
  const Light& skylight() const { return skylight_; }  ///< On level ground under the open sky.
  const Light& haze() const { return haze_; }          ///< The colour in which distant things fade.

  Light Glow(
      const Eigen::Vector3f& direction) const;  ///< Radiance without single clouds, as it lights things.
  Light LookInto(const Eigen::Vector3f& direction) const;  ///< Radiance with clouds, as it is seen.

 private:
  double cloud_ratio_;
  Eigen::Vector3f toward_sun_;
  Light sunlight_;
  Light skylight_;
  Light haze_;
};

}  // namespace soffit::sim
