#include "test/sim/draw/draw.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "test/sim/draw/dice.h"
#include "test/sim/draw/shapes.h"
#include "test/sim/truth/truth.h"
#include "test/sim/world/space.h"

namespace soffit::sim {
namespace {

using Eigen::Vector2d;

constexpr double kOverview_m = 9.0;
constexpr double kLeastSpare_m = 0.08;
const VehicleEnvelope kVehicle{0.35, 0.30, 0.25};
const Intrinsics kCamera{1280, 960, 850, 850, 639.5, 479.5, {-0.06, 0.012, 0.0003, -0.0002, 0}};

enum class Trouble { kNone, kTooLow, kTooNarrow, kRecess, kPainted, kPole, kBeam, kCrate, kAbsent };

const char* ToString(Trouble trouble) {
  switch (trouble) {
    case Trouble::kNone:
      return "passage";
    case Trouble::kTooLow:
      return "too low";
    case Trouble::kTooNarrow:
      return "too narrow";
    case Trouble::kRecess:
      return "recess";
    case Trouble::kPainted:
      return "painted door";
    case Trouble::kPole:
      return "pole";
    case Trouble::kBeam:
      return "beam";
    case Trouble::kCrate:
      return "crate";
    case Trouble::kAbsent:
      return "absent";
  }
  return "";
}

Trouble DrawTrouble(Dice& dice) {
  if (dice.Chance(0.52)) return Trouble::kNone;
  constexpr Trouble kOthers[] = {Trouble::kTooLow, Trouble::kTooNarrow, Trouble::kRecess, Trouble::kPainted,
                                 Trouble::kPole,   Trouble::kBeam,      Trouble::kCrate,  Trouble::kAbsent};
  return kOthers[dice.Pick(8)];
}

Finish DrawFinish(Dice& dice) {
  const Eigen::Vector3d colors[] = {{0.72, 0.07, 0.06}, {0.09, 0.17, 0.62}, {0.88, 0.70, 0.08}};
  constexpr Pattern kPatterns[] = {Pattern::kPlain, Pattern::kMottled, Pattern::kMottled, Pattern::kPanels,
                                   Pattern::kBricks};
  Finish finish;
  finish.color_srgb = colors[dice.Pick(3)] * dice.Between(0.82, 1.1);
  for (int i = 0; i < 3; ++i)
    finish.color_srgb[i] = std::clamp(finish.color_srgb[i] + dice.Between(-0.02, 0.02), 0.0, 1.0);
  finish.pattern = kPatterns[dice.Pick(5)];
  finish.grain_m = dice.Between(0.25, 0.8);
  finish.contrast = dice.Between(0.04, 0.16);
  return finish;
}

Finish DrawGround(Dice& dice) {
  const Finish grounds[] = {{{0.50, 0.49, 0.47}, Pattern::kSlabs, 2.4, 0.14},
                            {{0.36, 0.42, 0.20}, Pattern::kGrass, 0.9, 0.22},
                            {{0.34, 0.34, 0.35}, Pattern::kMottled, 0.7, 0.18},
                            {{0.59, 0.55, 0.46}, Pattern::kMottled, 0.8, 0.14}};
  Finish ground = grounds[dice.Pick(4)];
  ground.color_srgb *= dice.Between(0.85, 1.15);
  ground.grain_m *= dice.Between(0.7, 1.4);
  ground.contrast *= dice.Between(0.5, 1.3);
  return ground;
}

PoseNoise DrawPoseNoise(Dice& dice) {
  const double kind = dice.Unit();
  const double position_m = kind < 0.5    ? dice.Between(0.0, 0.01)
                            : kind < 0.85 ? dice.Between(0.01, 0.03)
                                          : dice.Between(0.03, 0.06);
  return {position_m, dice.Between(2.0, 8.0) * position_m * std::numbers::pi / 180.0};
}

/// The wanted building, what stands in its way, and its size.
struct Wanted {
  Structure building;
  std::vector<Structure> obstacles;  ///< In the building's frame.
  Vector2d size_m;
  double height_m = 0.0;
  bool is_box = true;  ///< Its outline is a rectangle.
};

Opening DrawOpening(Trouble trouble, double spare_m, Dice& dice) {
  double width_m = kVehicle.NeededWidth_m() + spare_m + dice.Between(0.0, 0.6);
  double height_m = kVehicle.NeededHeight_m() + spare_m + dice.Between(0.1, 0.7);
  if (trouble == Trouble::kTooNarrow) width_m = kVehicle.NeededWidth_m() - dice.Between(0.10, 0.5);
  if (trouble == Trouble::kTooLow) height_m = kVehicle.NeededHeight_m() - dice.Between(0.10, 0.35);
  const double middle_m = dice.Between(-0.2, 0.2);
  return {middle_m - width_m / 2, middle_m + width_m / 2, 0.0, height_m, false};
}

/// Pole, beam or crate in the building's frame, whose passage runs along y.
Structure DrawObstacle(Trouble trouble, const Opening& opening, double depth_m, Dice& dice) {
  Structure obstacle;
  obstacle.id = "obstacle";
  const double grey = dice.Between(0.2, 0.5);
  obstacle.finish = {{grey, 0.97 * grey, 0.92 * grey}, Pattern::kMottled, 0.3, 0.1};
  const double middle_m = (opening.left_m + opening.right_m) / 2, width_m = opening.right_m - opening.left_m;
  const double side = dice.Chance(0.5) ? 1.0 : -1.0;
  if (trouble == Trouble::kPole) {
    const double thick_m = dice.Between(0.08, 0.16);
    obstacle.parts = {
        BoxPart({middle_m + dice.Between(-0.15, 0.15), side * dice.Between(0.0, depth_m / 2 + 0.4)},
                {thick_m, thick_m}, 0.0, opening.high_m + dice.Between(0.2, 0.6))};
  } else if (trouble == Trouble::kBeam) {
    const double middle_z_m = opening.high_m * dice.Between(0.45, 0.6);
    obstacle.parts = {BoxPart({middle_m, side * dice.Between(0.0, depth_m / 2 - 0.1)},
                              {width_m - 0.002, dice.Between(0.06, 0.15)},
                              middle_z_m - dice.Between(0.04, 0.08), middle_z_m + dice.Between(0.04, 0.08))};
  } else {
    const double long_m = dice.Between(0.5, 0.9);
    obstacle.parts = {BoxPart({middle_m, side * (depth_m / 2 + long_m / 2 + dice.Between(0.1, 0.4))},
                              {dice.Between(0.6, width_m), long_m}, 0.0,
                              opening.high_m * dice.Between(0.6, 0.95))};
  }
  return obstacle;
}

std::vector<Part> BuildRecess(const Vector2d& size_m, double height_m, const Opening& opening, Dice& dice) {
  const double depth_m = size_m.y() * dice.Between(0.35, 0.7), side = dice.Chance(0.5) ? 1.0 : -1.0;
  const double rest_m = size_m.y() - depth_m;
  Part front = WallPart(WallWithOpening(size_m.x(), height_m, opening), depth_m);
  auto& prism = std::get<Prism>(front.shape);
  const double shift_m = side * rest_m / 2;
  prism.low_m += shift_m;
  prism.high_m += shift_m;
  Part back = BoxPart({0.0, -side * depth_m / 2}, {size_m.x(), rest_m}, 0.0, height_m);
  Part lining = BoxPart({(opening.left_m + opening.right_m) / 2, side * (rest_m - size_m.y() / 2 + 0.005)},
                        {opening.right_m - opening.left_m - 0.004, 0.01}, 0.0, opening.high_m - 0.002);
  lining.finish = Finish{Eigen::Vector3d::Constant(dice.Between(0.08, 0.3)), Pattern::kMottled, 0.3, 0.1};
  return {front, back, lining};
}

std::vector<Part> BuildPainted(const Vector2d& size_m, double height_m, const Opening& opening, Dice& dice) {
  const double side = dice.Chance(0.5) ? 1.0 : -1.0, shade = dice.Between(0.05, 0.3);
  Part paint = BoxPart({(opening.left_m + opening.right_m) / 2, side * size_m.y() / 2},
                       {opening.right_m - opening.left_m, 0.002}, 0.0, opening.high_m);
  paint.finish = Finish{{shade, shade, 1.05 * shade}, Pattern::kMottled, 0.3, 0.1};
  return {BoxPart(Vector2d::Zero(), size_m, 0.0, height_m), paint};
}

Wanted DrawWanted(Trouble trouble, double spare_m, Dice& dice) {
  Wanted wanted;
  wanted.building.id = "wanted";
  wanted.building.finish = DrawFinish(dice);
  wanted.building.is_absent = trouble == Trouble::kAbsent;
  Opening opening = DrawOpening(trouble, spare_m, dice);
  const double pier_m = dice.Between(0.8, 1.2);
  wanted.size_m = {opening.right_m - opening.left_m + 2.0 * pier_m, dice.Between(1.1, 1.7)};
  wanted.height_m = std::max(opening.high_m + dice.Between(0.4, 0.8), 1.6);
  const double kind = dice.Unit();
  if (trouble == Trouble::kRecess) {
    wanted.building.parts = BuildRecess(wanted.size_m, wanted.height_m, opening, dice);
  } else if (trouble == Trouble::kPainted) {
    wanted.building.parts = BuildPainted(wanted.size_m, wanted.height_m, opening, dice);
  } else if (kind < 0.25) {
    const double foot_m = dice.Between(1.0, 1.3), stem_m = dice.Between(0.9, 1.2);
    wanted.size_m = {stem_m + opening.right_m - opening.left_m + dice.Between(0.9, 1.2),
                     foot_m + dice.Between(0.8, 1.3)};
    Ring ell = EllRing(wanted.size_m.x(), wanted.size_m.y(), foot_m, stem_m);
    const double width_m = opening.right_m - opening.left_m;
    opening.left_m = ell[0].x() + stem_m + 0.05;
    opening.right_m = opening.left_m + width_m;
    wanted.building.parts = EllWithPassage(ell, foot_m, stem_m, opening, wanted.height_m);
    wanted.is_box = false;
  } else if (kind < 0.40 && trouble == Trouble::kNone) {
    wanted.size_m = {dice.Between(2.5, 3.2), dice.Between(2.2, 2.5)};
    wanted.height_m = opening.high_m + dice.Between(0.2, 0.3);
    wanted.building.parts =
        TableParts(wanted.size_m, dice.Between(0.22, 0.3), opening.high_m, wanted.height_m);
  } else {
    if (kind < 0.55 && trouble == Trouble::kNone) {
      opening.is_round = true;
      opening.high_m += 0.30 * (opening.right_m - opening.left_m);
    } else if (kind < 0.65) {
      const double sill_m = dice.Between(0.2, 0.6);
      opening.low_m += sill_m;
      opening.high_m += sill_m;
    }
    wanted.height_m = std::max(opening.high_m + dice.Between(0.4, 0.7), 1.6);
    wanted.building.parts = {
        WallPart(WallWithOpening(wanted.size_m.x(), wanted.height_m, opening), wanted.size_m.y())};
  }
  if (trouble == Trouble::kPole || trouble == Trouble::kBeam || trouble == Trouble::kCrate) {
    wanted.obstacles = {DrawObstacle(trouble, opening, wanted.is_box ? wanted.size_m.y() : 1.2, dice)};
    if (!wanted.is_box) {
      for (Part& part : wanted.obstacles[0].parts) {  // The passage is in the foot of the L.
        for (Vector2d& corner : std::get<Prism>(part.shape).section.outer)
          corner.y() += 0.6 - wanted.size_m.y() / 2;
      }
    }
  }
  return wanted;
}

/// A round place on the ground that something takes up.
struct Spot {
  Vector2d center_m;
  double radius_m;
};

Vector2d InFrameOf(const Structure& structure, const Vector2d& in_map_m) {
  return Eigen::Rotation2Dd(-structure.yaw_rad) * (in_map_m - structure.position_m);
}

/// Home is free, and the whole building is in the overview picture, whatever its heading.
bool IsWellPlaced(const Structure& structure, const Vector2d& size_m, double height_m) {
  constexpr double kAroundHome_m = 1.35, kInPicture = 0.93;
  const Vector2d home = InFrameOf(structure, Vector2d::Zero()).cwiseAbs() - size_m / 2;
  if (home.cwiseMax(0.0).norm() < kAroundHome_m) return false;
  const double reach_m = kInPicture * kCamera.cy_px / kCamera.fy_px * (kOverview_m - height_m);
  for (const Vector2d& corner : BoxRing(size_m)) {
    const Vector2d at = Eigen::Rotation2Dd(structure.yaw_rad) * corner + structure.position_m;
    if (at.cwiseAbs().maxCoeff() > reach_m) return false;
  }
  return true;
}

bool Place(Structure& structure, const Vector2d& size_m, double height_m, Dice& dice) {
  for (int i = 0; i < 2000; ++i) {
    structure.position_m = {dice.Between(-4.0, 4.0), dice.Between(-4.0, 4.0)};
    structure.yaw_rad = dice.Between(-std::numbers::pi, std::numbers::pi);
    if (IsWellPlaced(structure, size_m, height_m)) return true;
  }
  return false;
}

/// Free of home, of other spots, of the wanted building and of the ways from which it is looked at and flown
/// through.
bool IsFree(const Spot& spot, const std::vector<Spot>& taken, const Wanted& wanted) {
  constexpr double kAroundHome_m = 1.5, kBeside_m = 1.2, kBefore_m = 5.0, kGap_m = 0.8;
  if (spot.center_m.norm() < spot.radius_m + kAroundHome_m) return false;
  const Vector2d away = InFrameOf(wanted.building, spot.center_m).cwiseAbs() - wanted.size_m / 2;
  if (away.x() < kBeside_m + spot.radius_m && away.y() < kBefore_m + spot.radius_m) return false;
  return std::all_of(taken.begin(), taken.end(), [&](const Spot& other) {
    return (other.center_m - spot.center_m).norm() > other.radius_m + spot.radius_m + kGap_m;
  });
}

std::optional<Vector2d> FindSpot(double radius_m, double reach_m, std::vector<Spot>& taken,
                                 const Wanted& wanted, Dice& dice) {
  for (int i = 0; i < 200; ++i) {
    const Spot spot{{dice.Between(-reach_m, reach_m), dice.Between(-reach_m, reach_m)}, radius_m};
    if (!IsFree(spot, taken, wanted)) continue;
    taken.push_back(spot);
    return spot.center_m;
  }
  return std::nullopt;
}

/// Outlines that are not like a rectangle of proportions `avoid`, nor like each other.
Ring DrawOutline(int kind, double avoid, Dice& dice) {
  const double size_m = dice.Between(1.4, 2.4);
  switch (kind) {
    case 0:
      return TeeRing(size_m, size_m * dice.Between(0.8, 1.0), size_m * dice.Between(0.3, 0.36));
    case 1:
      return EllRing(size_m, size_m * dice.Between(0.9, 1.1), size_m * dice.Between(0.32, 0.38),
                     size_m * dice.Between(0.4, 0.46));
    default: {
      const double proportion = avoid > 1.6 ? avoid / dice.Between(1.4, 1.8) : avoid * dice.Between(1.5, 1.9);
      return BoxRing({size_m, size_m / proportion});
    }
  }
}

void AddDistractors(World& world, const Wanted& wanted, Dice& dice) {
  std::vector<Spot> taken;
  const int count = 1 + dice.Pick(3);
  const int first_kind = dice.Pick(3);
  for (int i = 0; i < count; ++i) {
    Structure other;
    other.id = "other-" + std::to_string(i + 1);
    other.finish = dice.Chance(0.4) ? wanted.building.finish : DrawFinish(dice);
    other.yaw_rad = dice.Between(-std::numbers::pi, std::numbers::pi);
    Ring ring = DrawOutline((first_kind + i) % 3, wanted.size_m.maxCoeff() / wanted.size_m.minCoeff(), dice);
    if (!wanted.is_box && i == 0 && dice.Chance(0.6)) {  // A mirrored twin.
      ring = MirroredRing(std::get<Prism>(wanted.building.parts.back().shape).section.outer);
    }
    double radius_m = 0.0;
    for (const Vector2d& corner : ring) radius_m = std::max(radius_m, corner.norm());
    const auto center = FindSpot(radius_m, dice.Chance(0.5) ? 5.0 : 9.0, taken, wanted, dice);
    if (!center) continue;
    other.position_m = *center;
    other.parts = {UprightPart(ring, 0.0, dice.Between(1.0, 1.9))};
    world.buildings.push_back(other);
  }
  for (int i = dice.Pick(4); i > 0; --i) {
    const double radius_m = dice.Between(0.25, 0.5);
    if (const auto center = FindSpot(radius_m, 8.0, taken, wanted, dice))
      world.bushes.push_back({*center, radius_m});
  }
}

void AddHorizon(World& world, Dice& dice) {
  constexpr int kThings = 9;
  const double trees = dice.Unit();
  for (int i = 0; i < kThings; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + dice.Unit()) / kThings,
                 away_m = dice.Between(26.0, 50.0);
    const Vector2d at = away_m * Vector2d(std::cos(angle), std::sin(angle));
    if (dice.Chance(trees)) {
      world.bushes.push_back({at, dice.Between(1.2, 2.8)});
      continue;
    }
    Structure box;
    box.id = "far-" + std::to_string(i + 1);
    box.position_m = at;
    box.yaw_rad = dice.Between(-1.0, 1.0);
    const double grey = dice.Between(0.3, 0.65);
    box.finish = {{grey, 0.98 * grey, 0.94 * grey}, Pattern::kMottled, 1.5, 0.1};
    box.parts = {
        BoxPart(Vector2d::Zero(), {dice.Between(4, 11), dice.Between(4, 10)}, 0.0, dice.Between(2.5, 6.5))};
    world.scenery.push_back(box);
  }
}

void DrawWeather(World& world, Dice& dice) {
  world.sun = {dice.Between(-std::numbers::pi, std::numbers::pi), dice.Between(0.45, 1.1),
               dice.Between(0.5, 1.1)};
  world.sky = {dice.Between(0.0, 0.8), dice.Between(300.0, 2000.0)};
  const double angle = dice.Between(0.0, 2.0 * std::numbers::pi), speed_mps = dice.Between(0.0, 3.5);
  world.wind = {speed_mps * Vector2d(std::cos(angle), std::sin(angle)), dice.Between(0.0, 0.9)};
}

CameraModel DrawCamera(Dice& dice) {
  CameraModel camera;
  camera.intrinsics = kCamera;
  camera.exposure_s = dice.Between(0.002, 0.008);
  camera.exposure_ev = dice.Between(-0.35, 0.35);
  camera.noise_levels = dice.Between(0.8, 2.8);
  camera.blur_px = dice.Between(0.4, 0.8);
  camera.vignetting = dice.Between(0.0, 0.3);
  return camera;
}

/// Buildings of the group must all be in the overview.
void MakeGroup(World& world) {
  for (const Structure& building : world.buildings) {
    if (building.id == "wanted") continue;
    const auto& prism = std::get<Prism>(building.parts[0].shape);
    Vector2d half = Vector2d::Zero();
    for (const Vector2d& corner : prism.section.outer) half = half.cwiseMax(corner.cwiseAbs());
    if (IsWellPlaced(building, 2.0 * half, prism.high_m)) world.mission.wanted.push_back(building.id);
  }
}

/// The vehicle starts and lands at home.
bool IsHomeFree(const World& world) {
  constexpr double kAroundHome_m = 1.2;
  const Space space(world);
  const Cylinder vehicle{{0.0, 0.0, 1.0}, kVehicle.radius_m, 1.9};
  return space.DistanceToBodies(vehicle, kAroundHome_m).distance_m >= kAroundHome_m - kVehicle.radius_m;
}

/// None when the building that was drawn is too large for the overview.
std::optional<World> DrawOnce(std::uint64_t seed) {
  Dice dice(seed);
  World world;
  world.home_yaw_rad = dice.Between(-std::numbers::pi, std::numbers::pi);
  world.vehicle = kVehicle;
  world.camera = DrawCamera(dice);
  world.ground = DrawGround(dice);
  world.pose_noise = DrawPoseNoise(dice);
  DrawWeather(world, dice);
  const Trouble trouble = DrawTrouble(dice);
  world.title = ToString(trouble);
  const double spare_m = 0.15 + 4.0 * world.pose_noise.position_std_m;
  Wanted wanted = DrawWanted(trouble, spare_m, dice);
  if (!Place(wanted.building, wanted.size_m, wanted.height_m, dice)) return std::nullopt;
  for (Structure& obstacle : wanted.obstacles) {
    obstacle.position_m = wanted.building.position_m;
    obstacle.yaw_rad = wanted.building.yaw_rad;
    world.obstacles.push_back(obstacle);
  }
  world.buildings.push_back(wanted.building);
  world.mission.wanted = {"wanted"};
  world.mission.reference_m_per_px = dice.Between(0.018, 0.035);
  world.mission.reference_rotation_cw_rad = dice.Between(-std::numbers::pi, std::numbers::pi);
  AddDistractors(world, wanted, dice);
  AddHorizon(world, dice);
  if (dice.Chance(0.2) && trouble != Trouble::kAbsent) MakeGroup(world);
  return world;
}

/// The best way is clearly passable or clearly not.
bool IsClear(const World& world) {
  const Truth truth = FindTruth(world);
  const double noise_m = 3.0 * world.pose_noise.position_std_m;
  for (const ObjectTruth& object : truth.objects) {
    if (object.passages.empty()) continue;
    const double spare_m = object.passages.front().spare_m;
    if (spare_m > -kLeastSpare_m && spare_m < kLeastSpare_m + noise_m) return false;
    if (spare_m > 0.0 && !object.passages.front().is_passable) return false;
  }
  return true;
}

}  // namespace

World DrawWorld(std::uint64_t seed) {
  for (std::uint64_t attempt = 0;; ++attempt) {
    std::optional<World> world = DrawOnce(Mix(seed) + attempt);
    if (!world || !IsHomeFree(*world) || !IsClear(*world)) continue;
    world->name = "seed-" + std::to_string(seed);
    world->title += ", random world " + std::to_string(seed);
    return *world;
  }
}

}  // namespace soffit::sim
