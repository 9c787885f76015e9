#include "service/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "service/scene/clutter.h"
#include "service/scene/evidence.h"
#include "service/scene/ground_check.h"
#include "service/scene/prediction.h"

namespace soffit {
namespace {

constexpr double kOtherDirection = 0.985;      // Cosine (10 degrees).
constexpr double kVeryOtherDirection = 0.766;  // Cosine (40 degrees).
constexpr std::size_t kMinThing = 8;           // Voxels: smaller groups are noise.
constexpr int kFinerLevels = 2;  // A voxel that is partly unknown is looked at in 8 parts, twice.

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

/// What is known of each voxel of the grid.
enum class Voxel : std::uint8_t { kUnknown, kFree, kSolid, kThing };
using Index = std::array<int, 3>;

struct Voxels {
  Grid grid;
  std::vector<Voxel> states;

  explicit Voxels(const Grid& laid)
      : grid(laid),
        states(Size(laid.count[0]) * Size(laid.count[1]) * Size(laid.count[2]), Voxel::kUnknown) {}

  bool Has(const Index& at) const {
    return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < grid.count[0] && at[1] < grid.count[1] &&
           at[2] < grid.count[2];
  }
  Voxel& At(const Index& at) {
    return states[(Size(at[0]) * Size(grid.count[1]) + Size(at[1])) * Size(grid.count[2]) + Size(at[2])];
  }

 private:
  static std::size_t Size(int count) { return static_cast<std::size_t>(count); }
};

/// Calls `visit` for each voxel of the grid.
template <class Visit>
void ForEach(const Grid& grid, Visit&& visit) {
  for (int x = 0; x < grid.count[0]; ++x) {
    for (int y = 0; y < grid.count[1]; ++y) {
      for (int z = 0; z < grid.count[2]; ++z) visit(Index{x, y, z});
    }
  }
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

/// Cosine of the widest angle between the directions from which pictures see a place; 1 for less than two.
class Directions {
 public:
  explicit Directions(const Eigen::Vector3d& place) : place_(place) {}

  void Add(const Evidence& picture) {
    const Eigen::Vector3d direction = (picture.camera_in_map_m() - place_).normalized();
    for (const Eigen::Vector3d& other : all_) least_cosine_ = std::min(least_cosine_, direction.dot(other));
    all_.push_back(direction);
  }
  double least_cosine() const { return least_cosine_; }
  bool empty() const { return all_.empty(); }

 private:
  Eigen::Vector3d place_;
  std::vector<Eigen::Vector3d> all_;
  double least_cosine_ = 1.0;
};

/// What is surely free is free. A thing that two pictures show from different directions outweighs what is
/// likely free; what is perhaps free takes two pictures from very different directions, and none that shows a
/// thing.
Voxel Judge(const std::vector<Evidence>& pictures, const Eigen::Vector3d& center, double radius_m) {
  Directions perhaps(center);
  Directions thing(center);
  bool is_likely_free = false;
  for (const Evidence& picture : pictures) {
    const Evidence::Sees sees = picture.SeeThrough(center, radius_m);
    if (sees == Evidence::Sees::kSure) return Voxel::kFree;
    is_likely_free = is_likely_free || sees == Evidence::Sees::kLikely;
    if (sees == Evidence::Sees::kPerhaps) perhaps.Add(picture);
    if (sees == Evidence::Sees::kNothing && picture.ShowsThingAt(center)) thing.Add(picture);
  }
  if (thing.least_cosine() < kOtherDirection) return Voxel::kThing;
  const bool is_free = is_likely_free || (thing.empty() && perhaps.least_cosine() < kVeryOtherDirection);
  return is_free ? Voxel::kFree : Voxel::kUnknown;
}

/// A cube is free when the ball about it is, or all of its eight parts are.
Voxel JudgeCube(const std::vector<Evidence>& pictures, const Eigen::Vector3d& center, double edge_m,
                int finer_levels) {
  const Voxel whole = Judge(pictures, center, 0.5 * std::sqrt(3.0) * edge_m);
  if (whole != Voxel::kUnknown || finer_levels == 0) return whole;
  if (Judge(pictures, center, 0.0) != Voxel::kFree) return Voxel::kUnknown;
  for (int part = 0; part < 8; ++part) {
    const Eigen::Vector3d offset(part % 2 - 0.5, part / 2 % 2 - 0.5, part / 4 - 0.5);
    const Voxel state = JudgeCube(pictures, center + 0.5 * edge_m * offset, 0.5 * edge_m, finer_levels - 1);
    if (state != Voxel::kFree) return Voxel::kUnknown;
  }
  return Voxel::kFree;
}

Voxels MapSpace(const Scene& scene, const std::vector<Evidence>& pictures, const SceneOptions& options) {
  Voxels voxels(LayGrid(BoundWanted(scene, options.margin_m), options));
  FillSolids(scene, voxels);
  const Grid& grid = voxels.grid;
  ForEach(grid, [&](const Index& at) {
    Voxel& state = voxels.At(at);
    if (state != Voxel::kSolid)
      state = JudgeCube(pictures, grid.Center(at[0], at[1], at[2]), grid.voxel_m, kFinerLevels);
  });
  return voxels;
}

/// All voxels of the same state that hang together with this one, by faces, edges or corners.
std::vector<Index> Flood(const Index& start, Voxels& voxels, std::vector<bool>& is_taken) {
  const auto number = [&](const Index& at) {
    return static_cast<std::size_t>(&voxels.At(at) - voxels.states.data());
  };
  const Voxel state = voxels.At(start);
  std::vector<Index> group = {start};
  is_taken[number(start)] = true;
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (int k = 0; k < 27; ++k) {
      const Index next = {group[i][0] + k % 3 - 1, group[i][1] + k / 3 % 3 - 1, group[i][2] + k / 9 - 1};
      if (!voxels.Has(next) || voxels.At(next) != state || is_taken[number(next)]) continue;
      is_taken[number(next)] = true;
      group.push_back(next);
    }
  }
  return group;
}

/// The upright cylinder about a group of voxels.
Obstacle Enclose(const std::vector<Index>& group, const Grid& grid, const std::vector<Evidence>& pictures) {
  Box box;
  for (const Index& at : group) {
    const Eigen::Vector3d center = grid.Center(at[0], at[1], at[2]);
    box.low = box.low.cwiseMin(center);
    box.high = box.high.cwiseMax(center);
  }
  Obstacle obstacle;
  const Eigen::Vector3d middle = 0.5 * (box.low + box.high);
  obstacle.base_in_map_m = {middle.x(), middle.y(), 0.0};
  obstacle.height_m = box.high.z() + 0.5 * grid.voxel_m;
  obstacle.std_m = 0.5 * grid.voxel_m;
  for (const Index& at : group) {
    const double distance = (grid.Center(at[0], at[1], at[2]) - middle).head<2>().norm();
    obstacle.radius_m = std::max(obstacle.radius_m, distance + 0.7 * grid.voxel_m);
  }
  const Index& some = group[group.size() / 2];
  for (const Evidence& picture : pictures) {
    if (picture.ShowsThingAt(grid.Center(some[0], some[1], some[2])))
      obstacle.captures.push_back(picture.capture_id());
  }
  return obstacle;
}

/// Groups that are too small are withdrawn.
std::vector<Obstacle> GatherObstacles(const std::vector<Evidence>& pictures, Voxels& voxels) {
  std::vector<Obstacle> obstacles;
  std::vector<bool> is_taken(voxels.states.size(), false);
  ForEach(voxels.grid, [&](const Index& at) {
    const std::size_t number = static_cast<std::size_t>(&voxels.At(at) - voxels.states.data());
    if (voxels.At(at) != Voxel::kThing || is_taken[number]) return;
    const std::vector<Index> group = Flood(at, voxels, is_taken);
    if (group.size() >= kMinThing) {
      obstacles.push_back(Enclose(group, voxels.grid, pictures));
    } else {
      for (const Index& small : group) voxels.At(small) = Voxel::kUnknown;
    }
  });
  return obstacles;
}

std::shared_ptr<const octomap::OcTree> PlantTree(Voxels& voxels) {
  auto tree = std::make_shared<octomap::OcTree>(voxels.grid.voxel_m);
  ForEach(voxels.grid, [&](const Index& at) {
    const Voxel state = voxels.At(at);
    if (state == Voxel::kUnknown) return;
    const Eigen::Vector3d center = voxels.grid.Center(at[0], at[1], at[2]);
    const float log_odds =
        state == Voxel::kFree ? tree->getClampingThresMinLog() : tree->getClampingThresMaxLog();
    tree->setNodeValue(center.x(), center.y(), center.z(), log_odds, true);
  });
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

  std::vector<Evidence> pictures;
  if (const std::optional<Box> mapped = BoundWanted(scene, options.margin_m)) {
    const Eigen::AlignedBox2d region(mapped->low.head<2>(), mapped->high.head<2>());
    std::vector<Sight> trusted;
    std::vector<Prediction> predictions;
    for (const Sight& sight : sights) {
      if (!sight.has_trusted_pose) continue;
      trusted.push_back(sight);
      trusted.back().seen = sight.seen.clone();
      predictions.push_back(Predict(sight.view, meshes));
    }
    const std::vector<cv::Mat1b> confirmed = CheckGround(predictions, trusted);
    for (std::size_t i = 0; i < trusted.size(); ++i) {
      pictures.emplace_back(trusted[i], predictions[i], confirmed[i], region);
      for (Obstacle& thing : FindClutter(trusted[i], predictions[i]))
        scene.clutter.push_back(std::move(thing));
    }
  }
  Voxels voxels = MapSpace(scene, pictures, options);
  scene.obstacles = GatherObstacles(pictures, voxels);
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
