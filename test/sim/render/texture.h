#pragma once

#include <Eigen/Core>

#include "test/sim/render/sky.h"
#include "test/sim/world/world.h"

namespace soffit::sim {

/// A finish, prepared for being looked up.
struct Paint {
  Light color = Light::Zero();  ///< Share of the light that is given back.
  Pattern pattern = Pattern::kPlain;
  float grain_m = 1.0F;
  float contrast = 0.0F;
  float along_x = 1.0F;  ///< Direction of seams: cosine and sine of the structure's yaw.
  float along_y = 0.0F;
};
Paint Mix(const Finish& finish, double yaw_rad);

/// The share of light that the surface gives back at a point of the map. Details finer than `footprint_m`,
/// the size of the pixel on the surface, are averaged out.
Light PaintAt(const Paint& paint, const Eigen::Vector3f& point_m, const Eigen::Vector3f& normal,
              float footprint_m);

}  // namespace soffit::sim
