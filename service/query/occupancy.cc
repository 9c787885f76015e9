#include "service/query/occupancy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

namespace soffit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kVisitsBetweenLooksAtTheClock = 1024;

/// A cube of the tree and what is known of it; `node` is null where nothing is.
struct Cube {
  const octomap::OcTree* tree;
  const octomap::OcTreeNode* node;
  Eigen::Vector3d low_m;
  double size_m;

  bool IsInner() const { return node != nullptr && tree->nodeHasChildren(node); }
  Occupancy OfLeaf() const {
    if (node == nullptr) return Occupancy::kUnknown;
    return tree->isNodeOccupied(node) ? Occupancy::kOccupied : Occupancy::kFree;
  }
  Eigen::AlignedBox3d Box() const { return {low_m, low_m + Eigen::Vector3d::Constant(size_m)}; }
  Eigen::Vector3d Center() const { return low_m + Eigen::Vector3d::Constant(0.5 * size_m); }
  Cell ToCell() const { return {Center(), size_m, OfLeaf()}; }

  /// The part of the octant `i`; what a leaf or an unknown cube says holds for its parts.
  Cube Child(unsigned i) const {
    const Eigen::Vector3d step(i & 1U, i >> 1U & 1U, i >> 2U & 1U);
    const double half_m = 0.5 * size_m;
    const octomap::OcTreeNode* child = node;
    if (IsInner()) child = tree->nodeChildExists(node, i) ? tree->getNodeChild(node, i) : nullptr;
    return {tree, child, low_m + half_m * step, half_m};
  }
  Cube ChildAt(const Eigen::Vector3d& point_m) const {
    const Eigen::Vector3d center_m = Center();
    return Child((point_m.x() >= center_m.x() ? 1U : 0U) | (point_m.y() >= center_m.y() ? 2U : 0U) |
                 (point_m.z() >= center_m.z() ? 4U : 0U));
  }
};

Cube RootOf(const octomap::OcTree& tree) {
  const double half_m = tree.getResolution() * std::ldexp(1.0, static_cast<int>(tree.getTreeDepth()) - 1);
  return {&tree, tree.getRoot(), Eigen::Vector3d::Constant(-half_m), 2.0 * half_m};
}

void AddVolumes(const Cube& cube, const Eigen::AlignedBox3d& box_m, std::array<double, 3>& volumes_m3) {
  const Eigen::AlignedBox3d common = box_m.intersection(cube.Box());
  if (common.isEmpty() || !(common.sizes().minCoeff() > 0.0)) return;
  if (cube.IsInner()) {
    for (unsigned i = 0; i < 8; ++i) AddVolumes(cube.Child(i), box_m, volumes_m3);
  } else {
    volumes_m3[static_cast<std::size_t>(cube.OfLeaf())] += common.volume();
  }
}

/// Which of the three there is in a box; stops when it is occupied.
void AddKinds(const Cube& cube, const Eigen::AlignedBox3d& box_m, std::array<bool, 3>& is_there) {
  if (is_there[static_cast<std::size_t>(Occupancy::kOccupied)]) return;
  const Eigen::AlignedBox3d common = box_m.intersection(cube.Box());
  // Rounding alone makes no neighbour a part of the box.
  if (common.isEmpty() || !(common.sizes().minCoeff() > 1e-9)) return;
  if (cube.IsInner()) {
    for (unsigned i = 0; i < 8; ++i) AddKinds(cube.Child(i), box_m, is_there);
  } else {
    is_there[static_cast<std::size_t>(cube.OfLeaf())] = true;
  }
}

Occupancy Worst(bool is_occupied, bool is_unknown) {
  return is_occupied ? Occupancy::kOccupied : is_unknown ? Occupancy::kUnknown : Occupancy::kFree;
}

Occupancy WorstIn(const octomap::OcTree& tree, const Eigen::AlignedBox3d& box_m) {
  const Cube root = RootOf(tree);
  std::array<bool, 3> is_there{};
  if (!root.Box().contains(box_m)) is_there[static_cast<std::size_t>(Occupancy::kUnknown)] = true;
  AddKinds(root, box_m, is_there);
  return Worst(is_there[static_cast<std::size_t>(Occupancy::kOccupied)],
               is_there[static_cast<std::size_t>(Occupancy::kUnknown)]);
}

void ExtendToKnown(const Cube& cube, Eigen::AlignedBox3d& box_m) {
  if (cube.node == nullptr || box_m.contains(cube.Box())) return;
  if (!cube.IsInner()) {
    box_m.extend(cube.Box());
    return;
  }
  for (unsigned i = 0; i < 8; ++i) ExtendToKnown(cube.Child(i), box_m);
}

/// How far a ray from `from_m` goes until it leaves the box.
double ExitDistance(const Eigen::AlignedBox3d& box_m, const Eigen::Vector3d& from_m,
                    const Eigen::Vector3d& direction) {
  double exit_m = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) continue;
    const double side_m = direction[axis] > 0.0 ? box_m.max()[axis] : box_m.min()[axis];
    exit_m = std::min(exit_m, (side_m - from_m[axis]) / direction[axis]);
  }
  return exit_m;
}

void AddChanges(const Cube& before, const Cube& after, std::size_t max_cells, CellChanges& changes) {
  if (before.node == nullptr && after.node == nullptr) return;
  if (before.IsInner() || after.IsInner()) {
    for (unsigned i = 0; i < 8; ++i) AddChanges(before.Child(i), after.Child(i), max_cells, changes);
    return;
  }
  if (before.OfLeaf() == after.OfLeaf()) return;
  const double edge = after.size_m / after.tree->getResolution();
  changes.count += static_cast<std::uint64_t>(std::llround(edge * edge * edge));
  changes.box_in_map_m.extend(after.Box());
  if (changes.cells.size() < max_cells) {
    changes.cells.push_back(after.ToCell());
  } else {
    changes.has_more = true;
  }
}

}  // namespace

const char* ToString(Occupancy occupancy) {
  switch (occupancy) {
    case Occupancy::kFree:
      return "free";
    case Occupancy::kOccupied:
      return "occupied";
    case Occupancy::kUnknown:
      break;
  }
  return "unknown";
}

const char* ToString(RayEnd end) {
  switch (end) {
    case RayEnd::kFree:
      return "free";
    case RayEnd::kHit:
      return "hit";
    case RayEnd::kOutOfRange:
      return "out of range";
    case RayEnd::kUnknown:
      break;
  }
  return "unknown";
}

Cell CellAt(const octomap::OcTree& tree, const Eigen::Vector3d& point_m, double resolution_m) {
  double size_m = tree.getResolution();
  Cube cube = RootOf(tree);
  if (!cube.Box().contains(point_m)) return {point_m, size_m, Occupancy::kUnknown};
  while (size_m < resolution_m && size_m < cube.size_m) size_m *= 2.0;
  while (cube.size_m > 1.5 * size_m) cube = cube.ChildAt(point_m);
  Cell cell = cube.ToCell();
  if (cube.IsInner()) cell.occupancy = WorstIn(tree, cube.Box());
  return cell;
}

Occupancy Shares::Worst() const { return soffit::Worst(occupied_ratio > 0.0, unknown_ratio > 0.0); }

Shares SharesOf(const octomap::OcTree& tree, const Eigen::AlignedBox3d& box_m) {
  std::array<double, 3> volumes_m3{};
  AddVolumes(RootOf(tree), box_m, volumes_m3);
  const double all_m3 = box_m.volume();
  Shares shares;
  shares.free_ratio = volumes_m3[static_cast<std::size_t>(Occupancy::kFree)] / all_m3;
  shares.occupied_ratio = volumes_m3[static_cast<std::size_t>(Occupancy::kOccupied)] / all_m3;
  shares.unknown_ratio = std::max(0.0, 1.0 - shares.free_ratio - shares.occupied_ratio);
  if (shares.unknown_ratio < 1e-9) shares.unknown_ratio = 0.0;  // Rounding.
  return shares;
}

double CountCells(const Eigen::AlignedBox3d& box_m, double resolution_m) {
  return (box_m.sizes() / resolution_m).array().ceil().prod();
}

CellGrid GridOf(const octomap::OcTree& tree, const Eigen::AlignedBox3d& box_m, double resolution_m) {
  CellGrid grid;
  grid.low_in_map_m = box_m.min();
  grid.resolution_m = resolution_m;
  // A box that was meant to hold a whole number of cells holds no sliver of one more.
  grid.size = (box_m.sizes() / resolution_m - Eigen::Vector3d::Constant(1e-9)).array().ceil().cast<int>();
  grid.occupancy.reserve(static_cast<std::size_t>(grid.size.prod()));
  for (int z = 0; z < grid.size.z(); ++z) {
    for (int y = 0; y < grid.size.y(); ++y) {
      for (int x = 0; x < grid.size.x(); ++x) {
        const Eigen::Vector3d low_m = grid.low_in_map_m + resolution_m * Eigen::Vector3d(x, y, z);
        const Eigen::AlignedBox3d cell(low_m, low_m + Eigen::Vector3d::Constant(resolution_m));
        grid.occupancy.push_back(static_cast<std::uint8_t>(WorstIn(tree, cell)));
      }
    }
  }
  return grid;
}

Eigen::AlignedBox3d KnownBox(const octomap::OcTree& tree) {
  Eigen::AlignedBox3d box_m;
  ExtendToKnown(RootOf(tree), box_m);
  return box_m;
}

Ray CastRay(const octomap::OcTree& tree, const Eigen::Vector3d& from_m, const Eigen::Vector3d& direction,
            double range_m) {
  const Cube root = RootOf(tree);
  const double step_in_m = 1e-6 * tree.getResolution();  // Past a side, into the next cell.
  const Eigen::AlignedBox3d known_m = KnownBox(tree);
  if (known_m.isEmpty() || !known_m.contains(from_m)) return {RayEnd::kOutOfRange, 0.0, {}};
  const double leave_m = ExitDistance(known_m, from_m, direction);
  double at_m = 0.0;
  while (true) {
    if (at_m >= range_m) return {RayEnd::kFree, range_m, {}};
    if (at_m >= leave_m) return {RayEnd::kOutOfRange, leave_m, {}};
    const Eigen::Vector3d point_m = from_m + (at_m + step_in_m) * direction;
    Cube cube = root;
    while (cube.IsInner()) cube = cube.ChildAt(point_m);
    if (cube.OfLeaf() == Occupancy::kUnknown) return {RayEnd::kUnknown, at_m, cube.ToCell()};
    if (cube.OfLeaf() == Occupancy::kOccupied) return {RayEnd::kHit, at_m, cube.ToCell()};
    at_m = std::max(ExitDistance(cube.Box(), from_m, direction), at_m + step_in_m);
  }
}

std::optional<CellDistance> FindNearest(const octomap::OcTree& tree, const Eigen::Vector3d& from_m,
                                        Occupancy wanted, double range_m, const IsLate& is_late) {
  using Entry = std::pair<double, Cube>;
  const auto is_farther = [](const Entry& a, const Entry& b) { return a.first > b.first; };
  std::priority_queue<Entry, std::vector<Entry>, decltype(is_farther)> open(is_farther);
  const auto add = [&](const Cube& cube) {
    const double distance_m = cube.Box().exteriorDistance(from_m);
    if (distance_m <= range_m) open.emplace(distance_m, cube);
  };
  add(RootOf(tree));
  for (int visits = 0; !open.empty(); ++visits) {
    if (visits % kVisitsBetweenLooksAtTheClock == 0 && is_late()) return std::nullopt;
    const auto [distance_m, cube] = open.top();
    open.pop();
    if (cube.IsInner()) {
      for (unsigned i = 0; i < 8; ++i) add(cube.Child(i));
    } else if (cube.OfLeaf() == wanted) {
      return CellDistance{distance_m, from_m.cwiseMax(cube.Box().min()).cwiseMin(cube.Box().max())};
    }
  }
  return std::nullopt;
}

std::vector<Layer> LayersAt(const octomap::OcTree& tree, const Eigen::Vector2d& place_m) {
  std::vector<Layer> layers;
  const Eigen::AlignedBox3d known_m = KnownBox(tree);
  if (known_m.isEmpty() || (place_m.array() < known_m.min().head<2>().array()).any() ||
      (place_m.array() > known_m.max().head<2>().array()).any()) {
    return layers;
  }
  double at_m = known_m.min().z();
  while (at_m < known_m.max().z() - 1e-9) {
    const Eigen::Vector3d point_m(place_m.x(), place_m.y(), at_m + 1e-6 * tree.getResolution());
    Cube cube = RootOf(tree);
    while (cube.IsInner()) cube = cube.ChildAt(point_m);
    const double top_m = std::min(cube.Box().max().z(), known_m.max().z());
    if (!layers.empty() && layers.back().occupancy == cube.OfLeaf()) {
      layers.back().top_m = top_m;
    } else {
      layers.push_back({at_m, top_m, cube.OfLeaf()});
    }
    at_m = top_m;
  }
  return layers;
}

CellChanges CompareOctrees(const octomap::OcTree& before, const octomap::OcTree& after,
                           std::size_t max_cells) {
  CellChanges changes;
  if (before.getResolution() == after.getResolution()) {
    AddChanges(RootOf(before), RootOf(after), max_cells, changes);
    return changes;
  }
  Cube nothing = RootOf(after);
  nothing.node = nullptr;
  AddChanges(nothing, RootOf(after), max_cells, changes);
  changes.box_in_map_m.extend(KnownBox(before));
  changes.has_more = true;
  return changes;
}

}  // namespace soffit
