#include "service/clearance/distances.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace soffit {
namespace {

constexpr double kExact_m = 5e-3;
constexpr std::array<double, 3> kReachShares = {0.3, 0.6, 1.0};

using Triangle = std::array<Eigen::Vector3d, 3>;

/// An upright cylinder, swept.
class SweptBody {
 public:
  SweptBody(const std::vector<Eigen::Vector3d>& path_in_map_m, const VehicleEnvelope& vehicle)
      : radius_m_(vehicle.radius_m), half_height_m_(0.5 * vehicle.height_m), z_m_(path_in_map_m.front().z()) {
    for (const Eigen::Vector3d& point : path_in_map_m) path_.push_back(point.head<2>());
  }

  double InPlan(const Eigen::Vector2d& plan) const {
    double distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < path_.size(); ++i)
      distance = std::min(distance, DistanceToSegment(plan, path_[i], path_[i + 1]));
    return std::max(0.0, distance - radius_m_);
  }
  double InHeight(double z) const { return std::max(0.0, std::abs(z - z_m_) - half_height_m_); }
  double To(const Eigen::Vector3d& p) const { return std::hypot(InPlan(p.head<2>()), InHeight(p.z())); }

  /// To what is outside of the bounds and above the ground.
  double ToBeyond(const Eigen::AlignedBox3d& bounds) const {
    double inside_m = bounds.max().z() - z_m_ - half_height_m_;
    for (const Eigen::Vector2d& p : path_) {
      const Eigen::Vector2d low = p - bounds.min().head<2>();
      const Eigen::Vector2d high = bounds.max().head<2>() - p;
      inside_m = std::min({inside_m, low.minCoeff() - radius_m_, high.minCoeff() - radius_m_});
    }
    return std::max(0.0, inside_m);
  }

  Eigen::AlignedBox3d Around(double reach_m) const {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector2d& p : path_) box.extend(Eigen::Vector3d(p.x(), p.y(), z_m_));
    const double aside = radius_m_ + reach_m;
    const Eigen::Vector3d grown(aside, aside, half_height_m_ + reach_m);
    return {box.min() - grown, box.max() + grown};
  }

 private:
  std::vector<Eigen::Vector2d> path_;
  double radius_m_;
  double half_height_m_;
  double z_m_;
};

/// Branch and bound: no point of a triangle is nearer than its middle by more than its radius.
double DistanceTo(const SweptBody& body, const Triangle& whole, double nearest) {
  std::vector<Triangle> open = {whole};
  while (!open.empty()) {
    const auto [a, b, c] = open.back();
    open.pop_back();
    const Eigen::Vector3d middle = (a + b + c) / 3.0;
    const double radius = std::sqrt(
        std::max({(a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()}));
    const double at_middle = body.To(middle);
    nearest = std::min(nearest, at_middle);
    if (at_middle - radius >= nearest - kExact_m) continue;
    const Eigen::Vector3d ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
    open.insert(open.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return nearest;
}

double DistanceToModels(const SweptBody& body, const Scene& scene, double reach_m) {
  const Eigen::AlignedBox3d box = body.Around(reach_m);
  double nearest = reach_m;
  for (const Solid& solid : scene.solids) {
    const auto& p = solid.mesh.vertices_in_map_m;
    for (const std::array<int, 3>& t : solid.mesh.triangles) {
      const Triangle triangle = {p[static_cast<std::size_t>(t[0])], p[static_cast<std::size_t>(t[1])],
                                 p[static_cast<std::size_t>(t[2])]};
      Eigen::AlignedBox3d own(triangle[0]);
      own.extend(triangle[1]).extend(triangle[2]);
      if (box.intersects(own)) nearest = DistanceTo(body, triangle, nearest);
    }
  }
  return nearest;
}

Eigen::AlignedBox3d BoundsOf(const octomap::OcTree& tree) {
  Eigen::AlignedBox3d bounds(Eigen::Vector3d::Zero());
  if (tree.size() > 0) {
    tree.getMetricMin(bounds.min().x(), bounds.min().y(), bounds.min().z());
    tree.getMetricMax(bounds.max().x(), bounds.max().y(), bounds.max().z());
  }
  return bounds;
}

/// Looks at all voxels that may be nearer than `reach_m`.
Distances MeasureVoxels(const octomap::OcTree& tree, const SweptBody& body, double reach_m) {
  const Eigen::AlignedBox3d bounds = BoundsOf(tree);
  Distances distances{reach_m, std::min(reach_m, body.ToBeyond(bounds)), reach_m};
  const double voxel = tree.getResolution();
  const double in_plan_m =
      std::sqrt(0.5) * voxel;  // From the middle of a voxel to its nearest point, at most.
  const Eigen::AlignedBox3d box = body.Around(reach_m).intersection(bounds);
  const auto first = [&](double at) { return static_cast<int>(std::floor(at / voxel)); };
  const auto middle = [&](int index) { return (index + 0.5) * voxel; };
  for (int x = first(box.min().x()); x <= first(box.max().x()); ++x) {
    for (int y = first(box.min().y()); y <= first(box.max().y()); ++y) {
      const double aside = std::max(0.0, body.InPlan({middle(x), middle(y)}) - in_plan_m);
      for (int z = std::max(0, first(box.min().z())); z <= first(box.max().z()); ++z) {
        const double distance = std::hypot(aside, std::max(0.0, body.InHeight(middle(z)) - 0.5 * voxel));
        if (distance >= std::max(distances.to_occupied_m, distances.to_unknown_m)) continue;
        const octomap::OcTreeNode* node = tree.search(middle(x), middle(y), middle(z));
        if (node != nullptr && !tree.isNodeOccupied(node)) continue;
        double& nearest = node == nullptr ? distances.to_unknown_m : distances.to_occupied_m;
        nearest = std::min(nearest, distance);
      }
    }
  }
  return distances;
}

}  // namespace

Distances MeasureDistances(const Scene& scene, const std::vector<Eigen::Vector3d>& path_in_map_m,
                           const VehicleEnvelope& vehicle, double reach_m) {
  const SweptBody body(path_in_map_m, vehicle);
  Distances distances;
  for (const double share : kReachShares) {  // What is near saves looking farther.
    distances = MeasureVoxels(*scene.octree, body, share * reach_m);
    if (std::max(distances.to_occupied_m, distances.to_unknown_m) < share * reach_m) break;
  }
  distances.to_surface_m = DistanceToModels(body, scene, reach_m);
  return distances;
}

}  // namespace soffit
