#pragma once

#include <Eigen/Core>
#include <vector>

#include "shared/capture/capture.h"

namespace soffit::sim {

/// What a pixel looks at: the inverse of the pinhole camera with `plumb_bob` distortion, from a table.
class Lens {
 public:
  explicit Lens(const Intrinsics& intrinsics);

  /// The ray (x, y, 1) in the camera's frame through a place in the picture; pixel centres are at integers,
  /// the place may lie up to one pixel outside.
  Eigen::Vector2f LookAt(float u_px, float v_px) const;

 private:
  int columns_;
  int rows_;
  std::vector<Eigen::Vector2f> table_;  ///< At the pixel centres, with a border of one pixel.
};

}  // namespace soffit::sim
