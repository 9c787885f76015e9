#include "service/corridor/corridor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "service/corridor/lane.h"
#include "service/corridor/rectangle.h"
#include "service/scene/sweep.h"
#include "shared/geometry/heights.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr int kLineSteps = 4;        // Places that are tried on either side of the middle.
constexpr double kKeptSigmas = 4.0;  // Kept on all sides off the middle: more than a decision asks for.
constexpr double kTouches_m = 1e-6;
constexpr double kLeastTurn = 0.02;  // Sine of the angle between lanes; below, they run the same way.
constexpr double kHigher = 2.0;  // Times what was seen of a thing's height it may be, when its top was not.
constexpr double kObstacleSigmas = 3.0;
constexpr std::size_t kMaxNamed = 4;
constexpr std::size_t kMaxObstacles = 8;  // In one lane; the nearest to its axis count.

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

/// Nothing fits: no width is left beside what stands there, or no height when its ends do not overlap in it.
Free NoRoom(const Lane& lane, const std::vector<Section>& sections) {
  Span heights;
  for (const Section& section : sections) {
    for (const Eigen::Vector3d& p : section) heights.Include(p.z());
  }
  const double z = 0.5 * (heights.low + heights.high);
  const double u = 0.5 * (lane.left_m + lane.right_m);
  if (lane.section.empty()) return {{lane.left_m, lane.right_m, z, z}, 0.0};
  return {{u, u, z, z}, 0.0};
}

/// The best room left of, right of, above or below each shadow.
std::optional<Free> FitBetween(const Ring& section, const std::vector<Shadow>& shadows, std::size_t from,
                               const VehicleEnvelope& vehicle) {
  if (section.size() < 3) return std::nullopt;
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

std::vector<Shadow> CastShadows(const std::vector<Obstacle>& obstacles, const Lane& lane, double stand_off) {
  double bottom = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& p : lane.section) bottom = std::min(bottom, p.y());
  std::vector<Shadow> shadows;
  for (const Obstacle& obstacle : obstacles) {
    const double along = lane.Along(obstacle.base_in_map_m.head<2>());
    const double u = lane.U(obstacle.base_in_map_m.head<2>());
    const double reach = obstacle.radius_m + obstacle.std_m;
    if (along + reach < lane.from_m - stand_off || along - reach > lane.to_m + stand_off) continue;
    if (u + reach < lane.left_m || u - reach > lane.right_m) continue;
    const double slack = kObstacleSigmas * obstacle.std_m;
    const double base = obstacle.base_in_map_m.z();
    const double top =
        base + (obstacle.is_top_seen ? obstacle.height_m + slack : kHigher * obstacle.height_m);
    if (top <= bottom) continue;  // It stays below the sill.
    shadows.push_back({u - reach, u + reach, base - slack, top, &obstacle});
  }
  const double middle = 0.5 * (lane.left_m + lane.right_m);
  std::stable_sort(shadows.begin(), shadows.end(), [&](const Shadow& a, const Shadow& b) {
    return std::abs(0.5 * (a.left + a.right) - middle) < std::abs(0.5 * (b.left + b.right) - middle);
  });
  if (shadows.size() > kMaxObstacles) shadows.resize(kMaxObstacles);
  return shadows;
}

/// A lane, and the free rectangle along it.
struct FreeLane {
  Lane lane;
  Rectangle free;
  double fit = 0.0;
  std::vector<const Obstacle*> limits;  ///< That bound the rectangle.

  double Middle() const { return 0.5 * (free.left + free.right); }
};

std::optional<FreeLane> FindFreeLane(const std::vector<Section>& sections,
                                     const std::vector<Obstacle>& things, const VehicleEnvelope& vehicle,
                                     double stand_off) {
  std::optional<Lane> lane = FindWidestLane(sections);
  if (!lane) return std::nullopt;
  const std::vector<Shadow> shadows = CastShadows(things, *lane, stand_off);
  const Free free = FitBetween(lane->section, shadows, 0, vehicle).value_or(NoRoom(*lane, sections));
  FreeLane found{std::move(*lane), free.rectangle, free.fit, {}};
  for (const Shadow& shadow : shadows) {
    if (free.fit == 0.0 || std::abs(shadow.right - free.rectangle.left) < kTouches_m ||
        std::abs(shadow.left - free.rectangle.right) < kTouches_m ||
        std::abs(shadow.top - free.rectangle.bottom) < kTouches_m ||
        std::abs(shadow.bottom - free.rectangle.top) < kTouches_m) {
      found.limits.push_back(shadow.obstacle);
    }
  }
  return found;
}

double LeastFit(const std::vector<FreeLane>& lanes) {
  double least = std::numeric_limits<double>::infinity();
  for (const FreeLane& lane : lanes) least = std::min(least, lane.fit);
  return lanes.empty() ? 0.0 : least;
}

/// One lane through all sections, or, where that is too tight and the passage bends, one after another.
std::vector<FreeLane> FindFreeLanes(const Passage& passage, const std::vector<Obstacle>& things,
                                    const VehicleEnvelope& vehicle, double stand_off) {
  const std::vector<Section>& sections = passage.sections_in_map_m;
  std::vector<FreeLane> straight;
  if (auto lane = FindFreeLane(sections, things, vehicle, stand_off)) straight = {std::move(*lane)};
  if (LeastFit(straight) >= 1.0 || sections.size() == 2) return straight;
  std::vector<FreeLane> bent;
  for (std::size_t i = 0; i + 1 < sections.size(); ++i) {
    auto lane = FindFreeLane({sections[i], sections[i + 1]}, things, vehicle, stand_off);
    if (!lane) return straight;
    bent.push_back(std::move(*lane));
  }
  return LeastFit(bent) > LeastFit(straight) ? bent : straight;
}

/// What is free along all lanes.
struct Room {
  double width_m = std::numeric_limits<double>::infinity();
  double bottom_m = 0.0;
  double top_m = std::numeric_limits<double>::infinity();
  double Height_m() const { return std::max(0.0, top_m - bottom_m); }
};

Room RoomOf(const std::vector<FreeLane>& lanes) {
  Room room;
  for (const FreeLane& lane : lanes) {
    room.width_m = std::min(room.width_m, lane.free.right - lane.free.left);
    room.bottom_m = std::max(room.bottom_m, lane.free.bottom);
    room.top_m = std::min(room.top_m, lane.free.top);
  }
  return room;
}

/// From before the first lane to behind the last one, `aside_m` to the right of their middles. Neighbouring
/// lanes that run the same way meet where the first ends.
std::vector<Eigen::Vector2d> LayPath(const std::vector<FreeLane>& lanes, double aside_m, double stand_off) {
  const auto at = [&](const FreeLane& lane, double along) {
    return lane.lane.InPlan(lane.Middle() + aside_m, along);
  };
  std::vector<Eigen::Vector2d> path = {at(lanes.front(), lanes.front().lane.from_m - stand_off)};
  for (std::size_t i = 0; i + 1 < lanes.size(); ++i) {
    const Eigen::Vector2d from = at(lanes[i], 0.0);
    const Eigen::Vector2d& way = lanes[i].lane.way;
    const Eigen::Vector2d to = at(lanes[i + 1], 0.0);
    const Eigen::Vector2d across = lanes[i + 1].lane.Right();
    const double sine = way.dot(across);
    path.push_back(std::abs(sine) < kLeastTurn
                       ? at(lanes[i], lanes[i].lane.to_m)
                       : Eigen::Vector2d(from + (to - from).dot(across) / sine * way));
  }
  path.push_back(at(lanes.back(), lanes.back().lane.to_m + stand_off));
  return path;
}

/// Where in the free room to fly, right of and above its middle: there, or where more of the space that the
/// vehicle needs was seen free.
Eigen::Vector2d ChooseLine(const std::vector<FreeLane>& lanes, const Eigen::Vector2d& kept_m,
                           const VehicleEnvelope& vehicle, const octomap::OcTree& tree, double stand_off) {
  const Room room = RoomOf(lanes);
  const double room_u = std::max(0.0, 0.5 * (room.width_m - vehicle.NeededWidth_m()) - kept_m.x());
  const double room_v = std::max(0.0, 0.5 * (room.Height_m() - vehicle.NeededHeight_m()) - kept_m.y());
  if (room_u == 0.0 && room_v == 0.0) return Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> offsets;
  for (int i = -kLineSteps; i <= kLineSteps; ++i) {
    for (int j = -kLineSteps; j <= kLineSteps; ++j) {
      offsets.emplace_back(room_u * i / kLineSteps, room_v * j / kLineSteps);
    }
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const auto& a, const auto& b) { return a.norm() < b.norm(); });
  Eigen::Vector2d best = Eigen::Vector2d::Zero();
  double best_seen = -1.0;
  for (const Eigen::Vector2d& offset : offsets) {
    const double z = 0.5 * (room.bottom_m + room.top_m) + offset.y();
    const double seen =
        SweepOctree(tree, LayPath(lanes, offset.x(), stand_off), vehicle.radius_m + vehicle.safety_margin_m,
                    z - 0.5 * vehicle.NeededHeight_m(), z + 0.5 * vehicle.NeededHeight_m())
            .SeenRatio();
    if (seen <= best_seen) continue;
    best = offset;
    best_seen = seen;
    if (seen >= 1.0) break;
  }
  return best;
}

double PlaceStd(const Footprint& footprint) {
  double sum = 0.0;
  for (const double std : footprint.corner_std_m) sum += std;
  return footprint.corner_std_m.empty() ? 0.0 : sum / static_cast<double>(footprint.corner_std_m.size());
}

std::string Describe(const std::vector<FreeLane>& lanes, const Eigen::Vector3d& map_origin_m) {
  std::vector<const Obstacle*> named;
  std::string text;
  for (const FreeLane& lane : lanes) {
    for (const Obstacle* thing : lane.limits) {
      if (named.size() == kMaxNamed || std::find(named.begin(), named.end(), thing) != named.end()) continue;
      named.push_back(thing);
      text += Say(text.empty() ? "" : "; ", "obstacle at ", SayPlace(map_origin_m + thing->base_in_map_m),
                  ", ", thing->height_m, " m high");
    }
  }
  return text;
}

Corridor PlanCorridor(const Scene& scene, const Solid& solid, const Passage& passage,
                      const VehicleEnvelope& vehicle, double stand_off) {
  Corridor corridor;
  corridor.object_id = solid.footprint.object_id;
  corridor.entry_wall = passage.entry_wall;
  corridor.exit_wall = passage.exit_wall;
  corridor.std_m = passage.std_m;
  corridor.place_std_m = PlaceStd(solid.footprint);
  const std::vector<FreeLane> lanes = FindFreeLanes(passage, scene.obstacles, vehicle, stand_off);
  SOFFIT_EXPECT(!lanes.empty());
  const Room room = RoomOf(lanes);
  const Eigen::Vector2d kept(kKeptSigmas * std::hypot(corridor.std_m, corridor.place_std_m),
                             kKeptSigmas * corridor.std_m);
  const Eigen::Vector2d aside = ChooseLine(lanes, kept, vehicle, *scene.octree, stand_off);
  const double z = 0.5 * (room.bottom_m + room.top_m) + aside.y();
  const std::vector<Eigen::Vector2d> path = LayPath(lanes, aside.x(), stand_off);
  corridor.entry_in_map_m = At(path.front(), z);
  corridor.exit_in_map_m = At(path.back(), z);
  for (std::size_t i = 1; i + 1 < path.size(); ++i) corridor.bends_in_map_m.push_back(At(path[i], z));
  corridor.free_width_m = room.width_m;
  corridor.free_height_m = room.Height_m();
  corridor.left_m = 0.5 * room.width_m + aside.x();
  corridor.floor_m = room.bottom_m;
  corridor.limited_by = Describe(lanes, scene.map_origin_m);
  return corridor;
}

}  // namespace

std::vector<Eigen::Vector3d> Corridor::Path() const {
  std::vector<Eigen::Vector3d> path = {entry_in_map_m};
  path.insert(path.end(), bends_in_map_m.begin(), bends_in_map_m.end());
  path.push_back(exit_in_map_m);
  return path;
}

std::vector<Section> Corridor::Sections() const {
  const std::vector<Eigen::Vector3d> path = Path();
  const auto way = [&](std::size_t leg) { return (path[leg + 1] - path[leg]).head<2>().normalized(); };
  std::vector<Section> sections;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Eigen::Vector2d back = way(std::max<std::size_t>(i, 1) - 1);
    const Eigen::Vector2d ahead = way(std::min(i, path.size() - 2));
    const Eigen::Vector2d along = (back + ahead).normalized();
    const Eigen::Vector2d left = Eigen::Vector2d(-along.y(), along.x()) / along.dot(ahead);
    const auto corner = [&](double aside_m, double z) { return At(path[i].head<2>() + aside_m * left, z); };
    const double right_m = left_m - free_width_m, top_m = floor_m + free_height_m;
    sections.push_back(
        {corner(left_m, floor_m), corner(right_m, floor_m), corner(right_m, top_m), corner(left_m, top_m)});
  }
  return sections;
}

std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> Corridor::Edges() const {
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> edges;
  const std::vector<Section> sections = Sections();
  for (std::size_t i = 0; i < sections.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      edges.emplace_back(sections[i][k], sections[i][(k + 1) % 4]);
      if (i > 0) edges.emplace_back(sections[i - 1][k], sections[i][k]);
    }
  }
  return edges;
}

std::vector<Corridor> PlanCorridors(const Scene& scene, std::uint32_t object_id,
                                    const VehicleEnvelope& vehicle, const CorridorOptions& options) {
  SOFFIT_EXPECT(IsValid(vehicle));
  SOFFIT_EXPECT(IsValidOptions(options));
  const double stand_off = std::max(options.approach_m, vehicle.radius_m + vehicle.safety_margin_m);
  std::vector<Corridor> corridors;
  for (const Solid& solid : scene.solids) {
    if (solid.footprint.object_id != object_id) continue;
    for (const Passage& passage : solid.passages) {
      corridors.push_back(PlanCorridor(scene, solid, passage, vehicle, stand_off));
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
