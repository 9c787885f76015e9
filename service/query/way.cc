#include "service/query/way.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "service/clearance/contact.h"
#include "service/scene/sweep.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr std::size_t kMaxInTheWay = 4096;
constexpr double kLookAround_m = 5.0;  ///< A way around things may leave the box of its ends by so much.
constexpr double kPiece_m = 1.0;
constexpr int kStepsBetweenLooksAtTheClock = 4096;

/// What the vehicle and its margin would touch at a place; each is a thousand times as dear as the one
/// before.
enum class Touch : std::uint8_t { kNothing, kUnknown, kOccupied };
constexpr double kCost[] = {1.0, 1e3, 1e6};

double ReachUp_m(const VehicleEnvelope& vehicle) { return 0.5 * vehicle.NeededHeight_m(); }
double ReachAside_m(const VehicleEnvelope& vehicle) { return 0.5 * vehicle.NeededWidth_m(); }

Way Late(Way way) {
  way.verdict = Verdict::kInsufficientData;
  way.reason = "there was no time to look at all of it";
  return way;
}

Eigen::AlignedBox3d BoxOf(const Mesh& mesh) {
  Eigen::AlignedBox3d box_m;
  for (const Eigen::Vector3d& vertex_m : mesh.vertices_in_map_m) box_m.extend(vertex_m);
  return box_m;
}

/// In pieces so short that the upright box around each holds hardly more than what the vehicle needs.
std::vector<Eigen::Vector3d> Divide(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
                                    double rise_m) {
  const Eigen::Vector3d way_m = to_m - from_m;
  const double pieces = std::ceil(std::max({1.0, std::abs(way_m.z()) / rise_m, way_m.norm() / kPiece_m}));
  std::vector<Eigen::Vector3d> points_m;
  for (int i = 0; i <= static_cast<int>(pieces); ++i) points_m.push_back(from_m + i / pieces * way_m);
  return points_m;
}

/// What CheckWay() has found so far.
struct Findings {
  Eigen::AlignedBox3d known_m;
  std::vector<Eigen::Vector3d> unknown_m;
  std::vector<Eigen::Vector3d> occupied_m;
  std::uint32_t object_id = 0;  ///< Of a model that is met; 0: none.

  void Look(const Scene& scene, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
            const VehicleEnvelope& vehicle) {
    const double aside_m = ReachAside_m(vehicle);
    const double bottom_m = std::min(from_m.z(), to_m.z()) - ReachUp_m(vehicle);
    const double top_m = std::max(from_m.z(), to_m.z()) + ReachUp_m(vehicle);
    const Eigen::Vector3d reach_m(1.01 * aside_m, 1.01 * aside_m, ReachUp_m(vehicle));
    const Eigen::AlignedBox3d around_m(from_m.cwiseMin(to_m) - reach_m, from_m.cwiseMax(to_m) + reach_m);
    if (known_m.intersects(around_m)) {
      const Sweep sweep =
          SweepOctree(*scene.octree, {from_m.head<2>(), to_m.head<2>()}, aside_m, bottom_m, top_m);
      unknown_m.insert(unknown_m.end(), sweep.unknown_m.begin(), sweep.unknown_m.end());
      if (sweep.first_occupied_m) occupied_m.push_back(*sweep.first_occupied_m);
    } else {
      unknown_m.push_back(0.5 * (from_m + to_m));
    }
    const Prism prism = SweepCylinder(from_m.head<2>(), to_m.head<2>(), aside_m, bottom_m, top_m);
    for (const Solid& solid : scene.solids) {
      if (BoxOf(solid.mesh).intersects(around_m) && Meets(solid.mesh, prism))
        object_id = solid.footprint.object_id;
    }
  }
};

void AddInTheWay(const octomap::OcTree& tree, std::vector<Eigen::Vector3d> centers_m, Way& way) {
  const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::sort(centers_m.begin(), centers_m.end(), less);
  centers_m.erase(std::unique(centers_m.begin(), centers_m.end()), centers_m.end());
  for (const Eigen::Vector3d& center_m : centers_m) {
    if (way.in_the_way.size() == kMaxInTheWay) return;
    way.in_the_way.push_back(CellAt(tree, center_m, 0.0));
  }
}

double LengthOf(const std::vector<Eigen::Vector3d>& points_m) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < points_m.size(); ++i) length_m += (points_m[i] - points_m[i - 1]).norm();
  return length_m;
}

/// Where a vehicle's centre could be, in cells.
class Search {
 public:
  /// Both ends lie in what is known.
  Search(const Scene& scene, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
         const VehicleEnvelope& vehicle, double max_cells)
      : from_m_(from_m), to_m_(to_m) {
    const Eigen::Vector3d aside_m = Eigen::Vector3d::Constant(kLookAround_m);
    Eigen::AlignedBox3d box_m(from_m.cwiseMin(to_m) - aside_m, from_m.cwiseMax(to_m) + aside_m);
    box_m = box_m.intersection(KnownBox(*scene.octree));
    double resolution_m = scene.octree->getResolution();
    while (CountCells(box_m, resolution_m) > max_cells) resolution_m *= 2.0;
    cells_ = GridOf(*scene.octree, box_m, resolution_m);
    Dilate(vehicle);
  }

  /// From cell to cell; empty when late.
  std::vector<Eigen::Vector3i> Run(const IsLate& is_late);

  double resolution_m() const { return cells_.resolution_m; }
  Eigen::Vector3d CenterOf(const Eigen::Vector3i& at) const { return cells_.CenterOf(at); }

  /// Whether the straight line touches nothing that is not free.
  bool IsFree(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m) const {
    const int steps = static_cast<int>(std::ceil(2.0 * (b_m - a_m).norm() / cells_.resolution_m)) + 1;
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector3d point_m = a_m + static_cast<double>(i) / steps * (b_m - a_m);
      if (touches_[cells_.Index(CellOf(point_m))] != Touch::kNothing) return false;
    }
    return true;
  }

 private:
  Eigen::Vector3i CellOf(const Eigen::Vector3d& point_m) const {
    const Eigen::Vector3i at =
        ((point_m - cells_.low_in_map_m) / cells_.resolution_m).array().floor().cast<int>();
    return at.cwiseMax(0).cwiseMin(cells_.size - Eigen::Vector3i::Ones());
  }
  void Dilate(const VehicleEnvelope& vehicle);

  Eigen::Vector3d from_m_;
  Eigen::Vector3d to_m_;
  CellGrid cells_;
  std::vector<Touch> touches_;
};

/// Every cell gets the worst that lies within the vehicle's reach of any point of it: up and down, then
/// within a disc. Outside the grid nothing is known.
void Search::Dilate(const VehicleEnvelope& vehicle) {
  const double cell_m = cells_.resolution_m;
  // The centre may be anywhere in its cell, and so may what it touches.
  const double aside = ReachAside_m(vehicle) / cell_m + 1.0;
  const int up = static_cast<int>(std::ceil(ReachUp_m(vehicle) / cell_m + 1.0));
  const auto touch_of = [](std::uint8_t occupancy) {
    switch (static_cast<Occupancy>(occupancy)) {
      case Occupancy::kFree:
        return Touch::kNothing;
      case Occupancy::kOccupied:
        return Touch::kOccupied;
      case Occupancy::kUnknown:
        break;
    }
    return Touch::kUnknown;
  };
  const Eigen::Vector3i size = cells_.size;
  std::vector<Touch> near(cells_.occupancy.size(), Touch::kNothing);
  std::transform(cells_.occupancy.begin(), cells_.occupancy.end(), near.begin(), touch_of);
  std::vector<Touch> columns(near.size(), Touch::kNothing);
  Eigen::Vector3i at;
  for (at.z() = 0; at.z() < size.z(); ++at.z()) {
    for (at.y() = 0; at.y() < size.y(); ++at.y()) {
      for (at.x() = 0; at.x() < size.x(); ++at.x()) {
        Touch worst = at.z() - up < 0 || at.z() + up >= size.z() ? Touch::kUnknown : Touch::kNothing;
        Eigen::Vector3i other = at;
        for (other.z() = std::max(0, at.z() - up); other.z() <= std::min(size.z() - 1, at.z() + up);
             ++other.z())
          worst = std::max(worst, near[cells_.Index(other)]);
        columns[cells_.Index(at)] = worst;
      }
    }
  }
  std::vector<Eigen::Vector2i> disc;
  const int reach = static_cast<int>(std::ceil(aside));
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      if (x * x + y * y <= aside * aside) disc.emplace_back(x, y);
    }
  }
  touches_.assign(near.size(), Touch::kNothing);
  for (at.z() = 0; at.z() < size.z(); ++at.z()) {
    for (at.y() = 0; at.y() < size.y(); ++at.y()) {
      for (at.x() = 0; at.x() < size.x(); ++at.x()) {
        const Touch here = columns[cells_.Index(at)];
        if (here == Touch::kNothing) continue;
        for (const Eigen::Vector2i& step : disc) {
          const Eigen::Vector3i other(at.x() + step.x(), at.y() + step.y(), at.z());
          if (other.x() < 0 || other.y() < 0 || other.x() >= size.x() || other.y() >= size.y()) continue;
          Touch& touch = touches_[cells_.Index(other)];
          touch = std::max(touch, here);
        }
      }
    }
  }
  for (at.z() = 0; at.z() < size.z(); ++at.z()) {
    for (at.y() = 0; at.y() < size.y(); ++at.y()) {
      for (at.x() = 0; at.x() < size.x(); ++at.x()) {
        const int rim = std::min({at.x(), at.y(), size.x() - 1 - at.x(), size.y() - 1 - at.y()});
        Touch& touch = touches_[cells_.Index(at)];
        if (rim < reach) touch = std::max(touch, Touch::kUnknown);
      }
    }
  }
}

std::vector<Eigen::Vector3i> Search::Run(const IsLate& is_late) {
  const Eigen::Vector3i start = CellOf(from_m_);
  const Eigen::Vector3i goal = CellOf(to_m_);
  constexpr std::uint8_t kNoStep = 255;
  std::vector<double> costs(touches_.size(), std::numeric_limits<double>::infinity());
  std::vector<std::uint8_t> steps(touches_.size(), kNoStep);  // By which each cell was reached.
  const auto step_of = [](int i) { return Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1); };
  struct Open {
    double estimate;
    Eigen::Vector3i at;
    double cost;
  };
  const auto is_worse = [](const Open& a, const Open& b) { return a.estimate > b.estimate; };
  std::priority_queue<Open, std::vector<Open>, decltype(is_worse)> open(is_worse);
  const auto reach = [&](const Eigen::Vector3i& at, double cost) {
    open.push({cost + (goal - at).cast<double>().norm(), at, cost});
  };
  costs[cells_.Index(start)] = 0.0;
  reach(start, 0.0);
  for (int visits = 0; !open.empty(); ++visits) {
    if (visits % kStepsBetweenLooksAtTheClock == 0 && is_late()) return {};
    const Open here = open.top();
    open.pop();
    if (here.cost > costs[cells_.Index(here.at)]) continue;
    if (here.at == goal) break;
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3i next = here.at + step_of(i);
      if (i == 13 || (next.array() < 0).any() || (next.array() >= cells_.size.array()).any()) continue;
      const std::size_t index = cells_.Index(next);
      const double cost =
          here.cost + step_of(i).cast<double>().norm() * kCost[static_cast<int>(touches_[index])];
      if (cost >= costs[index]) continue;
      costs[index] = cost;
      steps[index] = static_cast<std::uint8_t>(i);
      reach(next, cost);
    }
  }
  std::vector<Eigen::Vector3i> cells = {goal};
  while (cells.back() != start) cells.push_back(cells.back() - step_of(steps[cells_.Index(cells.back())]));
  std::reverse(cells.begin(), cells.end());
  return cells;
}

/// Leaves out the points between two that see each other.
std::vector<Eigen::Vector3d> Straighten(const std::vector<Eigen::Vector3d>& points_m, const Search& search) {
  std::vector<Eigen::Vector3d> kept_m = {points_m.front()};
  std::size_t at = 0;
  while (at + 1 < points_m.size()) {
    std::size_t next = at + 1;
    for (std::size_t stride = 1; at + stride < points_m.size(); stride *= 2) {
      if (search.IsFree(points_m[at], points_m[at + stride])) next = at + stride;
    }
    if (search.IsFree(points_m[at], points_m.back())) next = points_m.size() - 1;
    kept_m.push_back(points_m[next]);
    at = next;
  }
  return kept_m;
}

}  // namespace

Way CheckWay(const Scene& scene, const std::vector<Eigen::Vector3d>& points_in_map_m,
             const VehicleEnvelope& vehicle, const IsLate& is_late) {
  Way way;
  way.points_in_map_m = points_in_map_m;
  way.length_m = LengthOf(points_in_map_m);
  Findings found{KnownBox(*scene.octree), {}, {}, 0};
  for (std::size_t i = 0; i + 1 < points_in_map_m.size(); ++i) {
    const auto pieces_m = Divide(points_in_map_m[i], points_in_map_m[i + 1], scene.octree->getResolution());
    for (std::size_t j = 0; j + 1 < pieces_m.size(); ++j) {
      if (is_late()) return Late(way);
      found.Look(scene, pieces_m[j], pieces_m[j + 1], vehicle);
    }
  }
  if (found.object_id != 0 || !found.occupied_m.empty()) {
    way.verdict = Verdict::kBlocked;
    way.reason = found.object_id != 0 ? Say("building ", found.object_id, " is in the way")
                                      : Say("something is in the way at ", found.occupied_m.front().x(), ", ",
                                            found.occupied_m.front().y(), ", ", found.occupied_m.front().z());
    AddInTheWay(*scene.octree, found.occupied_m, way);
  } else if (!found.unknown_m.empty()) {
    way.reason = Say("nothing is known of ", found.unknown_m.size(), " cells of it");
    AddInTheWay(*scene.octree, found.unknown_m, way);
  } else {
    way.verdict = Verdict::kClear;
    way.reason = Say("free along ", way.length_m, " m");
  }
  return way;
}

Way FindWay(const Scene& scene, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m,
            const VehicleEnvelope& vehicle, double max_cells, const IsLate& is_late) {
  for (const Eigen::Vector3d& end_m : {from_m, to_m}) {
    Way there = CheckWay(scene, {end_m, end_m}, vehicle, is_late);
    if (there.verdict == Verdict::kClear) continue;
    there.reason = (end_m == from_m ? "at its start: " : "at its end: ") + there.reason;
    there.points_in_map_m.clear();
    return there;
  }
  const Way straight = CheckWay(scene, {from_m, to_m}, vehicle, is_late);
  if (straight.verdict == Verdict::kClear) return straight;
  Search search(scene, from_m, to_m, vehicle, max_cells);
  const std::vector<Eigen::Vector3i> cells = search.Run(is_late);
  if (cells.empty()) return Late({});
  std::vector<Eigen::Vector3d> points_m = {from_m};
  for (std::size_t i = 1; i + 1 < cells.size(); ++i) points_m.push_back(search.CenterOf(cells[i]));
  points_m.push_back(to_m);
  Way way = CheckWay(scene, Straighten(points_m, search), vehicle, is_late);
  if (way.verdict != Verdict::kClear) {
    way.reason = Say("no way within ", kLookAround_m, " m around is known to be free: ", way.reason);
    if (search.resolution_m() > scene.octree->getResolution()) {
      way.verdict = Verdict::kInsufficientData;  // Finer cells might have shown one.
      way.reason += Say("; looked for in cells of ", search.resolution_m(), " m");
    }
    way.points_in_map_m.clear();
    way.length_m = 0.0;
  }
  return way;
}

}  // namespace soffit
