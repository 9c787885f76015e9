#include "service/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "service/scene/carving.h"
#include "service/scene/clutter.h"
#include "service/scene/evidence.h"
#include "service/scene/ground_check.h"
#include "service/scene/octree.h"
#include "service/scene/prediction.h"
#include "service/scene/support.h"
#include "service/scene/thin_line.h"

namespace soffit {
namespace {

constexpr std::size_t kMinThing = 8;  // Voxels: smaller groups are noise.
constexpr int kFringe = 2;            // Voxels about a thing that its blurred edge leaves unknown.
constexpr double kPiece_m = 0.5;      // A larger group is told as several obstacles, each about so wide.

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
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(-half, -half), Eigen::Vector2d(half, -half),
        Eigen::Vector2d(-half, half), Eigen::Vector2d(half, half)}) {
    const std::vector<double> heights = Pierce(solid.mesh, center.head<2>() + offset);
    for (std::size_t i = 0; i + 1 < heights.size(); i += 2) {
      const int low = static_cast<int>(std::floor(heights[i] / grid.voxel_m + 1e-9)) - grid.first[2];
      const int high = static_cast<int>(std::ceil(heights[i + 1] / grid.voxel_m - 1e-9)) - grid.first[2];
      for (int z = std::max(0, low); z < std::min(grid.count[2], high); ++z)
        occupied[static_cast<std::size_t>(z)] = true;
    }
  }
}

bool Touches(const Box& box, const Grid& grid, int x, int y) {
  const Eigen::Vector3d center = grid.Center(x, y, 0);
  return center.x() >= box.low.x() - grid.voxel_m && center.x() <= box.high.x() + grid.voxel_m &&
         center.y() >= box.low.y() - grid.voxel_m && center.y() <= box.high.y() + grid.voxel_m;
}

void FillSolids(const Scene& scene, Voxels& voxels) {
  const Grid& grid = voxels.grid;
  for (const Solid& solid : scene.solids) {
    const Box box = Bound(solid);
    for (int x = 0; x < grid.count[0]; ++x) {
      for (int y = 0; y < grid.count[1]; ++y) {
        if (!Touches(box, grid, x, y)) continue;
        std::vector<bool> occupied(static_cast<std::size_t>(grid.count[2]), false);
        MarkSolid(solid, grid, x, y, occupied);
        for (int z = 0; z < grid.count[2]; ++z) {
          if (occupied[static_cast<std::size_t>(z)]) voxels.At({x, y, z}) = Voxel::kSolid;
        }
      }
    }
  }
}

/// The voxels of the same state that hang together with this one, by faces, edges or corners, and stand no
/// farther from it.
std::vector<Index> Flood(const Index& start, Voxels& voxels, std::vector<bool>& is_taken) {
  const auto number = [&](const Index& at) { return voxels.grid.Number(at[0], at[1], at[2]); };
  const Voxel state = voxels.At(start);
  std::vector<Index> group = {start};
  is_taken[number(start)] = true;
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (int k = 0; k < 27; ++k) {
      const Index next = {group[i][0] + k % 3 - 1, group[i][1] + k / 3 % 3 - 1, group[i][2] + k / 9 - 1};
      if (!voxels.Has(next) || voxels.At(next) != state || is_taken[number(next)]) continue;
      const double aside = std::hypot(next[0] - start[0], next[1] - start[1]) * voxels.grid.voxel_m;
      if (aside > kPiece_m) continue;
      is_taken[number(next)] = true;
      group.push_back(next);
    }
  }
  return group;
}

/// Whether most of what is above the group (`up` 1) or below it (-1) is free, but for a fringe.
bool EndsInFree(const std::vector<Index>& group, int up, const Voxels& voxels) {
  int free = 0;
  int ends = 0;
  for (const Index& at : group) {
    const Index next = {at[0], at[1], at[2] + up};
    const Index beyond = {at[0], at[1], at[2] + up * kFringe};
    if (!voxels.Has(next) || voxels.At(next) == Voxel::kThing) continue;
    ++ends;
    free += voxels.Has(beyond) && voxels.At(beyond) == Voxel::kFree ? 1 : 0;
  }
  return 2 * free > ends;
}

/// The upright cylinder about a group of voxels.
Obstacle Enclose(const std::vector<Index>& group, const Voxels& voxels) {
  const Grid& grid = voxels.grid;
  Box box;
  for (const Index& at : group) {
    const Eigen::Vector3d center = grid.Center(at[0], at[1], at[2]);
    box.low = box.low.cwiseMin(center);
    box.high = box.high.cwiseMax(center);
  }
  Obstacle obstacle;
  const Eigen::Vector3d middle = 0.5 * (box.low + box.high);
  const double base_m = EndsInFree(group, -1, voxels) ? box.low.z() - 0.5 * grid.voxel_m : 0.0;
  obstacle.base_in_map_m = {middle.x(), middle.y(), base_m};
  obstacle.height_m = box.high.z() + 0.5 * grid.voxel_m - base_m;
  obstacle.is_top_seen = EndsInFree(group, 1, voxels);
  obstacle.std_m = 0.5 * grid.voxel_m;
  for (const Index& at : group) {
    const double distance = (grid.Center(at[0], at[1], at[2]) - middle).head<2>().norm();
    obstacle.radius_m = std::max(obstacle.radius_m, distance + 0.7 * grid.voxel_m);
  }
  return obstacle;
}

/// Groups that are too small are withdrawn.
std::vector<Obstacle> GatherObstacles(const Carving& carving, Voxels& voxels) {
  std::vector<Obstacle> obstacles;
  std::vector<bool> is_taken(voxels.states.size(), false);
  ForEach(voxels.grid, [&](const Index& at) {
    if (voxels.At(at) != Voxel::kThing || is_taken[voxels.grid.Number(at[0], at[1], at[2])]) return;
    const std::vector<Index> group = Flood(at, voxels, is_taken);
    if (group.size() >= kMinThing) {
      obstacles.push_back(Enclose(group, voxels));
      obstacles.back().captures = carving.CapturesOfThingAt(group[group.size() / 2]);
    } else {
      for (const Index& small : group) voxels.At(small) = Voxel::kUnknown;
    }
  });
  return obstacles;
}

/// A plain block for each building that was only seen from above: it may hide others.
std::vector<Mesh> RaiseBlocks(const Scene& scene) {
  std::vector<Mesh> blocks;
  for (const SceneObject& object : scene.objects) {
    const bool is_modelled = std::any_of(scene.solids.begin(), scene.solids.end(), [&](const Solid& solid) {
      return solid.footprint.object_id == object.footprint.object_id;
    });
    if (is_modelled || !(object.footprint.height_m > 0.0)) continue;
    blocks.push_back(RaiseBlock(object.footprint.polygon_in_map_m.outer, object.footprint.height_m));
  }
  return blocks;
}

/// Lets every picture with a trusted pose carve the space, and lists what those from above show beside the
/// buildings. Predictions are large: they are made twice rather than kept.
Carving CarveSpace(Scene& scene, const Box& mapped, const std::vector<Sight>& sights, Voxels voxels) {
  const std::vector<Mesh> blocks = RaiseBlocks(scene);
  std::vector<const Mesh*> meshes;
  for (const Solid& solid : scene.solids) meshes.push_back(&solid.mesh);
  for (const Mesh& block : blocks) meshes.push_back(&block);
  std::vector<Sight> trusted;
  std::copy_if(sights.begin(), sights.end(), std::back_inserter(trusted),
               [](const Sight& sight) { return sight.has_trusted_pose; });

  GroundCheck ground;
  ThinLines lines;
  for (const Sight& sight : trusted) {
    const Prediction prediction = Predict(sight.view, meshes);
    ground.Add(sight, prediction);
    lines.Add(sight, prediction);
  }
  const Eigen::AlignedBox2d region(mapped.low.head<2>(), mapped.high.head<2>());
  Carving carving(std::move(voxels));
  for (std::size_t i = 0; i < trusted.size(); ++i) {
    const Prediction prediction = Predict(trusted[i].view, meshes);
    Sight sight = trusted[i];
    sight.seen = sight.seen.clone();
    const cv::Mat1b votes = ground.Settle(i, prediction, sight);
    carving.Add(Evidence(sight, prediction, votes, lines.Settle(i), region));
    for (Obstacle& thing : FindClutter(sight, prediction)) scene.clutter.push_back(std::move(thing));
  }
  return carving;
}

}  // namespace

Scene BuildScene(std::uint64_t revision, std::vector<SceneObject> objects, std::vector<Solid> solids,
                 const std::vector<Sight>& sights, const SceneOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  Scene scene;
  scene.revision = revision;
  scene.objects = std::move(objects);
  scene.solids = std::move(solids);
  const std::optional<Box> mapped = BoundWanted(scene, options.margin_m);
  Voxels voxels(LayGrid(mapped, options));
  FillSolids(scene, voxels);
  if (mapped) {
    const Carving carving = CarveSpace(scene, *mapped, sights, std::move(voxels));
    voxels = carving.Judge();
    scene.obstacles = GatherObstacles(carving, voxels);
    FreeUnsupported(voxels);
  }
  scene.octree = PlantTree(voxels);
  return scene;
}

std::vector<std::uint32_t> FindNeighbours(const Footprint& object, const std::vector<Footprint>& map,
                                          int count) {
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
