#pragma once

#include <Eigen/Core>
#include <vector>

#include "test/sim/render/sky.h"
#include "test/sim/render/texture.h"
#include "test/sim/render/tracer.h"

namespace soffit::sim {

/// Light that does not come straight from the sun: of the sky, and of sunlit surfaces around (one bounce).
/// Computed once on a lattice on every triangle and on the ground, then interpolated, so that undersides and
/// passages are dark but not black, without noise.
class LightMap {
 public:
  LightMap(const std::vector<WorldBody>& bodies, const std::vector<Paint>& paints, const Paint& ground,
           const Tracer& tracer, const SkyDome& sky);

  /// What a white surface gives back of that light, where the ray met it.
  Light At(const RayHit& hit, const Eigen::Vector3f& point_m) const;

 private:
  struct Lattice {
    int steps = 0;          ///< Per side of the triangle; 0: none, a round body.
    std::size_t first = 0;  ///< In `values_`.
  };

  Light AtGround(const Eigen::Vector3f& point_m) const;

  std::vector<std::vector<Lattice>> lattices_;  ///< By body and triangle.
  std::vector<Light> values_;
  Light skylight_;
  Light from_below_;
  Eigen::Vector2f ground_low_m_ = Eigen::Vector2f::Zero();
  float ground_cell_m_ = 1.0F;
  int ground_columns_ = 0;
  int ground_rows_ = 0;
  std::vector<Light> ground_;
};

}  // namespace soffit::sim
