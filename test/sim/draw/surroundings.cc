#include "test/sim/draw/surroundings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace soffit::sim {
namespace {

using Eigen::Vector2d;

const Intrinsics kCamera{1280, 960, 850, 850, 639.5, 479.5, {-0.06, 0.012, 0.0003, -0.0002, 0}};

/// A round place on the ground that something takes up.
struct Spot {
  Vector2d center_m;
  double radius_m;
};

Vector2d InFrameOf(const Structure& structure, const Vector2d& in_map_m) {
  return Eigen::Rotation2Dd(-structure.yaw_rad) * (in_map_m - structure.position_m);
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

}  // namespace

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

void DrawWeather(World& world, Dice& dice) {
  world.sun = {dice.Between(-std::numbers::pi, std::numbers::pi), dice.Between(0.45, 1.1),
               dice.Between(0.5, 1.1)};
  world.sky = {dice.Between(0.0, 0.8), dice.Between(300.0, 2000.0)};
  const double angle = dice.Between(0.0, 2.0 * std::numbers::pi), speed_mps = dice.Between(0.0, 3.5);
  world.wind = {speed_mps * Vector2d(std::cos(angle), std::sin(angle)), dice.Between(0.0, 0.9)};
}

bool IsWellPlaced(const Structure& structure, const Vector2d& size_m, double height_m) {
  constexpr double kAroundHome_m = 1.35, kInPicture = 0.93;
  const Vector2d home = InFrameOf(structure, Vector2d::Zero()).cwiseAbs() - size_m / 2;
  if (home.cwiseMax(0.0).norm() < kAroundHome_m) return false;
  const double reach_m = kInPicture * kCamera.cy_px / kCamera.fy_px * (kOverviewAltitude_m - height_m);
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

}  // namespace soffit::sim
