#include "service/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "service/scene/evidence.h"
#include "service/scene/ground_check.h"
#include "service/scene/prediction.h"

namespace soffit {
namespace {

constexpr double kGroundCell_m = 0.04;

/// The space that is mapped: whole voxels, aligned as OctoMap aligns them.
struct Grid {
  double voxel_m = 0.0;
  std::array<int, 3> first{};
  std::array<int, 3> count{};

  Eigen::Vector3d Center(int x, int y, int z) const {
    return {(first[0] + x + 0.5) * voxel_m, (first[1] + y + 0.5) * voxel_m, (first[2] + z + 0.5) * voxel_m};
  }
};

struct Box {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
};

Box Bound(const Solid& solid) {
  Box box;
  for (const Eigen::Vector3d& p : solid.mesh.vertices_in_map_m) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

bool IsWanted(const Scene& scene, const Solid& solid) {
  return std::any_of(scene.objects.begin(), scene.objects.end(), [&](const SceneObject& object) {
    return object.is_matched && object.footprint.object_id == solid.footprint.object_id;
  });
}

/// Around the wanted models; none when there is none.
std::optional<Box> BoundWanted(const Scene& scene, double margin_m) {
  std::optional<Box> all;
  for (const Solid& solid : scene.solids) {
    if (!IsWanted(scene, solid)) continue;
    const Box box = Bound(solid);
    if (!all) all = box;
    all->low = all->low.cwiseMin(box.low);
    all->high = all->high.cwiseMax(box.high);
  }
  if (!all) return std::nullopt;
  all->low.head<2>().array() -= margin_m;
  all->high.head<2>().array() += margin_m;
  all->low.z() = 0.0;
  return all;
}

Grid LayGrid(const std::optional<Box>& wanted, const SceneOptions& options) {
  Grid grid;
  grid.voxel_m = options.voxel_m;
  if (!wanted) return grid;
  const Box& box = *wanted;
  const Eigen::Vector3d size = box.high - box.low;
  while (size.prod() / std::pow(grid.voxel_m, 3) > options.max_voxels) grid.voxel_m *= 2.0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t a = static_cast<std::size_t>(axis);
    grid.first[a] = static_cast<int>(std::floor(box.low[axis] / grid.voxel_m));
    grid.count[a] = static_cast<int>(std::ceil(box.high[axis] / grid.voxel_m)) - grid.first[a];
  }
  return grid;
}

/// Heights at which the upright line at (x, y) goes through the mesh's surface, in order.
std::vector<double> Pierce(const Mesh& mesh, const Eigen::Vector2d& at) {
  std::vector<double> heights;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const Eigen::Vector3d& a = mesh.vertices_in_map_m[static_cast<std::size_t>(t[0])];
    const Eigen::Vector3d& b = mesh.vertices_in_map_m[static_cast<std::size_t>(t[1])];
    const Eigen::Vector3d& c = mesh.vertices_in_map_m[static_cast<std::size_t>(t[2])];
    const Eigen::Matrix2d edges = (Eigen::Matrix2d() << (b - a).head<2>(), (c - a).head<2>()).finished();
    const double area = edges.determinant();
    if (std::abs(area) < 1e-12) continue;
    const Eigen::Vector2d share = edges.inverse() * (at - a.head<2>());
    if (share.x() < 0.0 || share.y() < 0.0 || share.sum() > 1.0) continue;
    heights.push_back(a.z() + share.x() * (b.z() - a.z()) + share.y() * (c.z() - a.z()));
  }
  std::sort(heights.begin(), heights.end());
  const auto same = [](double p, double q) { return q - p < 1e-9; };
  heights.erase(std::unique(heights.begin(), heights.end(), same), heights.end());
  return heights;
}

/// Which voxels of one column a solid touches, tried on five upright lines.
void MarkSolid(const Solid& solid, const Grid& grid, int x, int y, std::vector<bool>& occupied) {
  const Eigen::Vector3d center = grid.Center(x, y, 0);
  const double half = 0.499 * grid.voxel_m;
  for (const Eigen::Vector2d& offset :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(-half, -half), Eigen::Vector2d(half, -half), Eigen::Vector2d(-half, half),
        Eigen::Vector2d(half, half)}) {
    const std::vector<double> heights = Pierce(solid.mesh, center.head<2>() + offset);
    for (std::size_t i = 0; i + 1 < heights.size(); i += 2) {
      const int low = static_cast<int>(std::floor(heights[i] / grid.voxel_m + 1e-9)) - grid.first[2];
      const int high = static_cast<int>(std::ceil(heights[i + 1] / grid.voxel_m - 1e-9)) - grid.first[2];
      for (int z = std::max(0, low); z < std::min(grid.count[2], high); ++z) occupied[static_cast<std::size_t>(z)] = true;
    }
  }
}

void MarkObstacle(const Obstacle& obstacle, const Grid& grid, int x, int y, std::vector<bool>& occupied) {
  const Eigen::Vector3d center = grid.Center(x, y, 0);
  const double distance = (center - obstacle.base_in_map_m).head<2>().norm();
  if (distance > obstacle.radius_m + 0.7 * grid.voxel_m) return;
  const int high = static_cast<int>(std::ceil(obstacle.height_m / grid.voxel_m)) - grid.first[2];
  for (int z = 0; z < std::min(grid.count[2], high); ++z) occupied[static_cast<std::size_t>(z)] = true;
}

bool Reaches(const Solid& solid, const Obstacle& obstacle, double margin_m) {
  const Ring& ring = solid.footprint.polygon_in_map_m.outer;
  const Eigen::Vector2d base = obstacle.base_in_map_m.head<2>();
  return Contains(ring, base) || DistanceToRing(base, ring) <= margin_m + obstacle.radius_m;
}

bool Touches(const Box& box, const Grid& grid, int x, int y) {
  const Eigen::Vector3d center = grid.Center(x, y, 0);
  return center.x() >= box.low.x() - grid.voxel_m && center.x() <= box.high.x() + grid.voxel_m &&
         center.y() >= box.low.y() - grid.voxel_m && center.y() <= box.high.y() + grid.voxel_m;
}

std::shared_ptr<const octomap::OcTree> MapSpace(const Scene& scene, const std::vector<FreeRays>& rays,
                                                const SceneOptions& options) {
  const Grid grid = LayGrid(BoundWanted(scene, options.margin_m), options);
  auto tree = std::make_shared<octomap::OcTree>(grid.voxel_m);
  std::vector<Box> boxes;
  for (const Solid& solid : scene.solids) boxes.push_back(Bound(solid));
  const double radius = 0.5 * std::sqrt(3.0) * grid.voxel_m;
  for (int x = 0; x < grid.count[0]; ++x) {
    for (int y = 0; y < grid.count[1]; ++y) {
      std::vector<bool> occupied(static_cast<std::size_t>(grid.count[2]), false);
      for (std::size_t i = 0; i < scene.solids.size(); ++i) {
        if (Touches(boxes[i], grid, x, y)) MarkSolid(scene.solids[i], grid, x, y, occupied);
      }
      for (const Obstacle& obstacle : scene.obstacles) MarkObstacle(obstacle, grid, x, y, occupied);
      for (int z = 0; z < grid.count[2]; ++z) {
        const Eigen::Vector3d center = grid.Center(x, y, z);
        const bool is_occupied = occupied[static_cast<std::size_t>(z)];
        const bool is_free = !is_occupied && std::any_of(rays.begin(), rays.end(), [&](const FreeRays& view) {
          return view.SeesThrough(center, radius);
        });
        if (!is_occupied && !is_free) continue;
        const float log_odds = is_occupied ? tree->getClampingThresMaxLog() : tree->getClampingThresMinLog();
        tree->setNodeValue(center.x(), center.y(), center.z(), log_odds, true);
      }
    }
  }
  tree->updateInnerOccupancy();
  tree->prune();
  return tree;
}

}  // namespace

Scene BuildScene(std::uint64_t revision, std::vector<SceneObject> objects, std::vector<Solid> solids,
                 const std::vector<Sight>& sights, const SceneOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  Scene scene;
  scene.revision = revision;
  scene.objects = std::move(objects);
  scene.solids = std::move(solids);

  std::vector<Mesh> blocks;
  std::vector<const Mesh*> meshes;
  for (const Solid& solid : scene.solids) meshes.push_back(&solid.mesh);
  for (const SceneObject& object : scene.objects) {
    const bool is_modelled = std::any_of(scene.solids.begin(), scene.solids.end(), [&](const Solid& solid) {
      return solid.footprint.object_id == object.footprint.object_id;
    });
    if (is_modelled || !(object.footprint.height_m > 0.0)) continue;
    blocks.push_back(RaiseBlock(object.footprint.polygon_in_map_m.outer, object.footprint.height_m));
  }
  for (const Mesh& block : blocks) meshes.push_back(&block);

  std::vector<FreeRays> rays;
  if (const std::optional<Box> wanted = BoundWanted(scene, options.margin_m)) {
    std::vector<Sight> trusted;
    std::vector<Prediction> predictions;
    for (const Sight& sight : sights) {
      if (!sight.has_trusted_pose) continue;
      trusted.push_back(sight);
      trusted.back().seen = sight.seen.clone();
      predictions.push_back(Predict(sight.view, meshes));
    }
    RejectDisputedGround(predictions, wanted->low.head<2>(), wanted->high.head<2>(), kGroundCell_m, trusted);
    for (std::size_t i = 0; i < trusted.size(); ++i) rays.emplace_back(trusted[i], predictions[i]);
  }
  for (const FreeRays& view : rays) {
    for (const Obstacle& obstacle : view.obstacles()) {
      const bool is_near = std::any_of(scene.solids.begin(), scene.solids.end(), [&](const Solid& solid) {
        return IsWanted(scene, solid) && Reaches(solid, obstacle, options.margin_m);
      });
      if (is_near) scene.obstacles.push_back(obstacle);
    }
  }
  scene.octree = MapSpace(scene, rays, options);
  return scene;
}

std::vector<std::uint32_t> FindNeighbours(const Footprint& object, const std::vector<Footprint>& map, int count) {
  std::vector<std::pair<double, std::uint32_t>> others;
  const Eigen::Vector2d center = Centroid(object.polygon_in_map_m);
  for (const Footprint& other : map) {
    if (other.object_id == object.object_id) continue;
    others.emplace_back((Centroid(other.polygon_in_map_m) - center).norm(), other.object_id);
  }
  std::sort(others.begin(), others.end());
  std::vector<std::uint32_t> ids;
  for (std::size_t i = 0; i < others.size() && i < static_cast<std::size_t>(std::max(0, count)); ++i) {
    ids.push_back(others[i].second);
  }
  return ids;
}

}  // namespace soffit
