#include "service/scene/sweep.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace soffit {

Sweep SweepOctree(const octomap::OcTree& tree, const std::vector<Eigen::Vector2d>& path, double radius_m,
                  double bottom_m, double top_m) {
  const double voxel = tree.getResolution();
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : path) box.extend(point);
  const Eigen::Vector2d low = box.min().array() - radius_m;
  const Eigen::Vector2d high = box.max().array() + radius_m;
  const auto first = [&](double at) { return static_cast<int>(std::floor(at / voxel)); };
  Sweep sweep;
  for (int x = first(low.x()); x <= first(high.x()); ++x) {
    for (int y = first(low.y()); y <= first(high.y()); ++y) {
      const Eigen::Vector2d plan((x + 0.5) * voxel, (y + 0.5) * voxel);
      double distance = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i + 1 < path.size(); ++i)
        distance = std::min(distance, DistanceToSegment(plan, path[i], path[i + 1]));
      if (distance > radius_m) continue;
      for (int z = first(bottom_m); z <= first(top_m); ++z) {
        const Eigen::Vector3d center(plan.x(), plan.y(), (z + 0.5) * voxel);
        if (center.z() < bottom_m || center.z() > top_m) continue;
        ++sweep.voxels;
        const octomap::OcTreeNode* node = tree.search(center.x(), center.y(), center.z());
        if (node == nullptr) {
          sweep.unknown_m.push_back(center);
        } else if (!tree.isNodeOccupied(node)) {
          ++sweep.free;
        } else {
          const bool is_inside = distance + 0.71 * voxel <= radius_m &&
                                 center.z() - 0.5 * voxel >= bottom_m && center.z() + 0.5 * voxel <= top_m;
          if (is_inside && !sweep.first_occupied_m) sweep.first_occupied_m = center;
          if (!is_inside) ++sweep.free;
        }
      }
    }
  }
  return sweep;
}

}  // namespace soffit
