#pragma once

#include <optional>

#include "service/scene/scene.h"

namespace soffit {

/// What an OctoMap tells of the voxels whose centres lie in a swept volume.
struct Sweep {
  int voxels = 0;
  int free = 0;
  std::optional<Eigen::Vector3d> first_occupied_m;  ///< Centre of a voxel that lies wholly inside.
  std::vector<Eigen::Vector3d> unknown_m;           ///< Centres of voxels that nothing is known of.

  double SeenRatio() const { return voxels > 0 ? static_cast<double>(free) / voxels : 0.0; }
};

/// A vertical cylinder swept along `path` (two points at least) through the tree, from `bottom_m` to `top_m`
/// above the ground. Unknown is where there is no node. An occupied voxel counts when all of it lies inside:
/// at the rim, where a surface only touches a voxel, the exact geometry decides.
Sweep SweepOctree(const octomap::OcTree& tree, const std::vector<Eigen::Vector2d>& path, double radius_m,
                  double bottom_m, double top_m);

}  // namespace soffit
