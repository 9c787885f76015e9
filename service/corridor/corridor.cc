#include "service/corridor/corridor.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "service/corridor/rectangle.h"
#include "service/facade/wall.h"
#include "service/scene/sweep.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr int kLineSteps = 4;        // Places that are tried on either side of the middle.
constexpr double kKeptSigmas = 4.0;  // Kept on all sides off the middle: more than a decision asks for.
constexpr double kHigher = 2.0;  // Times what was seen of a thing's height it may be, when its top was not.
constexpr double kObstacleSigmas = 3.0;
constexpr std::size_t kMaxObstacles = 8;  // In one passage; the nearest to its axis count.

Eigen::Vector3d At(const Eigen::Vector2d& plan, double z) { return {plan.x(), plan.y(), z}; }

/// The part of a ring where `direction . p <= limit`.
Ring Clip(const Ring& ring, const Eigen::Vector2d& direction, double limit) {
  Ring kept;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    const double in_a = limit - direction.dot(a);
    const double in_b = limit - direction.dot(b);
    if (in_a >= 0.0) kept.push_back(a);
    if ((in_a > 0.0 && in_b < 0.0) || (in_a < 0.0 && in_b > 0.0))
      kept.push_back(a + in_a / (in_a - in_b) * (b - a));
  }
  return kept;
}

/// What an obstacle takes from a passage's section: [left, right] x [bottom, top].
struct Shadow {
  double left = 0.0, right = 0.0, bottom = 0.0, top = 0.0;
  const Obstacle* obstacle = nullptr;
};

struct Free {
  Rectangle rectangle;
  double fit = 0.0;  ///< Room over need; at least 1 is wide and high enough.
};

std::optional<Free> FitRoom(const Ring& section, const VehicleEnvelope& vehicle) {
  const auto rectangle = FitRectangle(section, vehicle.NeededWidth_m(), vehicle.NeededHeight_m());
  if (!rectangle) return std::nullopt;
  return Free{*rectangle, std::min((rectangle->right - rectangle->left) / vehicle.NeededWidth_m(),
                                   (rectangle->top - rectangle->bottom) / vehicle.NeededHeight_m())};
}

/// Nothing fits: a rectangle without width in the middle.
Free NoRoom(const Ring& section) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : section) middle += p / static_cast<double>(section.size());
  return {{middle.x(), middle.x(), middle.y(), middle.y()}, 0.0};
}

/// The best room left of, right of, above or below each shadow.
std::optional<Free> FitBetween(const Ring& section, const std::vector<Shadow>& shadows, std::size_t from,
                               const VehicleEnvelope& vehicle) {
  if (from == shadows.size()) return FitRoom(section, vehicle);
  const Shadow& shadow = shadows[from];
  std::optional<Free> best;
  for (const Ring& part :
       {Clip(section, {1.0, 0.0}, shadow.left), Clip(section, {-1.0, 0.0}, -shadow.right),
        Clip(section, {0.0, -1.0}, -shadow.top), Clip(section, {0.0, 1.0}, shadow.bottom)}) {
    const auto free = FitBetween(part, shadows, from + 1, vehicle);
    if (free && (!best || free->fit > best->fit)) best = free;
  }
  return best;
}

std::vector<Shadow> CastShadows(const std::vector<Obstacle>& obstacles, const Wall& wall,
                                const Passage& passage, double stand_off) {
  double left = passage.section_m.front().x();
  double right = left;
  double bottom = passage.section_m.front().y();
  for (const Eigen::Vector2d& p : passage.section_m) {
    bottom = std::min(bottom, p.y());
    left = std::min(left, p.x());
    right = std::max(right, p.x());
  }
  std::vector<Shadow> shadows;
  for (const Obstacle& obstacle : obstacles) {
    const double front = wall.Front(obstacle.base_in_map_m.head<2>());
    const double u = wall.U(obstacle.base_in_map_m.head<2>());
    const double reach = obstacle.radius_m + obstacle.std_m;
    if (front - reach > stand_off || -front - reach > passage.length_m + stand_off) continue;
    if (u + reach < left || u - reach > right) continue;
    const double slack = kObstacleSigmas * obstacle.std_m;
    const double base = obstacle.base_in_map_m.z();
    const double top =
        base + (obstacle.is_top_seen ? obstacle.height_m + slack : kHigher * obstacle.height_m);
    if (top <= bottom) continue;  // It stays below the sill.
    shadows.push_back({u - reach, u + reach, base - slack, top, &obstacle});
  }
  const double middle = 0.5 * (left + right);
  std::stable_sort(shadows.begin(), shadows.end(), [&](const Shadow& a, const Shadow& b) {
    return std::abs(0.5 * (a.left + a.right) - middle) < std::abs(0.5 * (b.left + b.right) - middle);
  });
  if (shadows.size() > kMaxObstacles) shadows.resize(kMaxObstacles);
  return shadows;
}

struct Path {
  Eigen::Vector3d entry_in_map_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d exit_in_map_m = Eigen::Vector3d::Zero();
};

Path LayPath(const Polygon& footprint, const Passage& passage, const Wall& wall, const Eigen::Vector2d& at,
             double stand_off) {
  const auto way = FindWayOut(footprint, passage.entry_wall, at.x());
  const double length = way ? way->length_m : passage.length_m;
  return {At(wall.InPlan(at.x()) + stand_off * wall.outward, at.y()),
          At(wall.InPlan(at.x()) - (length + stand_off) * wall.outward, at.y())};
}

/// Where in the free rectangle to fly: in its middle, or where more of the space that the vehicle needs was
/// seen free.
template <class PathAt>
Eigen::Vector2d ChooseLine(const Rectangle& free, const Eigen::Vector2d& kept_m,
                           const VehicleEnvelope& vehicle, const octomap::OcTree& tree, PathAt&& path_at) {
  const Eigen::Vector2d middle(0.5 * (free.left + free.right), 0.5 * (free.bottom + free.top));
  const double room_u = std::max(0.0, 0.5 * (free.right - free.left - vehicle.NeededWidth_m()) - kept_m.x());
  const double room_v = std::max(0.0, 0.5 * (free.top - free.bottom - vehicle.NeededHeight_m()) - kept_m.y());
  std::vector<Eigen::Vector2d> offsets;
  for (int i = -kLineSteps; i <= kLineSteps; ++i) {
    for (int j = -kLineSteps; j <= kLineSteps; ++j) {
      offsets.emplace_back(room_u * i / kLineSteps, room_v * j / kLineSteps);
    }
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const auto& a, const auto& b) { return a.norm() < b.norm(); });
  Eigen::Vector2d best = middle;
  double best_seen = -1.0;
  for (const Eigen::Vector2d& offset : offsets) {
    const Path path = path_at(middle + offset);
    const double z = path.entry_in_map_m.z();
    const double seen = SweepOctree(tree, path.entry_in_map_m.head<2>(), path.exit_in_map_m.head<2>(),
                                    vehicle.radius_m + vehicle.safety_margin_m,
                                    z - 0.5 * vehicle.NeededHeight_m(), z + 0.5 * vehicle.NeededHeight_m())
                            .SeenRatio();
    if (seen <= best_seen) continue;
    best = middle + offset;
    best_seen = seen;
    if (seen >= 1.0 || (room_u == 0.0 && room_v == 0.0)) break;
  }
  return best;
}

double PlaceStd(const Footprint& footprint) {
  double sum = 0.0;
  for (const double std : footprint.corner_std_m) sum += std;
  return footprint.corner_std_m.empty() ? 0.0 : sum / static_cast<double>(footprint.corner_std_m.size());
}

std::string Describe(const std::vector<Shadow>& shadows) {
  if (shadows.empty()) return "";
  const Eigen::Vector3d& at = shadows.front().obstacle->base_in_map_m;
  return Say("obstacle at ", at.x(), ", ", at.y(), ", ", shadows.front().obstacle->height_m, " m high");
}

}  // namespace

std::vector<Corridor> PlanCorridors(const Scene& scene, std::uint32_t object_id,
                                    const VehicleEnvelope& vehicle, const CorridorOptions& options) {
  SOFFIT_EXPECT(IsValid(vehicle));
  SOFFIT_EXPECT(IsValidOptions(options));
  const double stand_off = std::max(options.approach_m, vehicle.radius_m + vehicle.safety_margin_m);
  std::vector<Corridor> corridors;
  for (const Solid& solid : scene.solids) {
    if (solid.footprint.object_id != object_id) continue;
    for (const Passage& passage : solid.passages) {
      const Wall wall = WallOf(solid.footprint.polygon_in_map_m.outer, passage.entry_wall);
      const std::vector<Shadow> shadows = CastShadows(scene.obstacles, wall, passage, stand_off);
      const Rectangle free =
          FitBetween(passage.section_m, shadows, 0, vehicle).value_or(NoRoom(passage.section_m)).rectangle;
      const double place_std = PlaceStd(solid.footprint);
      const Eigen::Vector2d kept(kKeptSigmas * std::hypot(passage.std_m, place_std),
                                 kKeptSigmas * passage.std_m);
      const Eigen::Vector2d middle =
          ChooseLine(free, kept, vehicle, *scene.octree, [&](const Eigen::Vector2d& at) {
            return LayPath(solid.footprint.polygon_in_map_m, passage, wall, at, stand_off);
          });
      const Path path = LayPath(solid.footprint.polygon_in_map_m, passage, wall, middle, stand_off);
      Corridor corridor;
      corridor.object_id = object_id;
      corridor.entry_wall = passage.entry_wall;
      corridor.exit_wall = passage.exit_wall;
      corridor.entry_in_map_m = path.entry_in_map_m;
      corridor.exit_in_map_m = path.exit_in_map_m;
      corridor.free_width_m = free.right - free.left;
      corridor.free_height_m = free.top - free.bottom;
      corridor.left_m = middle.x() - free.left;
      corridor.floor_m = free.bottom;
      corridor.std_m = passage.std_m;
      corridor.place_std_m = place_std;
      corridor.limited_by = Describe(shadows);
      corridors.push_back(corridor);
    }
  }
  const auto fit = [&](const Corridor& c) {
    return std::min(c.free_width_m / vehicle.NeededWidth_m(), c.free_height_m / vehicle.NeededHeight_m());
  };
  std::stable_sort(corridors.begin(), corridors.end(),
                   [&](const auto& a, const auto& b) { return fit(a) > fit(b); });
  return corridors;
}

}  // namespace soffit
