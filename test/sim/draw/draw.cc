#include "test/sim/draw/draw.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "test/sim/draw/plan.h"
#include "test/sim/draw/surroundings.h"
#include "test/sim/truth/truth.h"
#include "test/sim/world/space.h"

namespace soffit::sim {
namespace {

using Eigen::Vector2d;

const VehicleEnvelope kVehicle{0.35, 0.30, 0.25};

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

/// @param passage_yaw_rad  Along the passage: a low sun shines into it.
void SetLight(Light light, double passage_yaw_rad, World& world, Dice& dice) {
  switch (light) {
    case Light::kLowSun:
      world.sun.yaw_rad = std::remainder(passage_yaw_rad + dice.Between(-0.9, 0.9), 2.0 * std::numbers::pi);
      world.sun.elevation_rad = dice.Between(0.12, 0.35);
      world.sun.strength = dice.Between(0.9, 1.2);
      world.sky.cloud_ratio = dice.Between(0.0, 0.3);
      break;
    case Light::kHaze:
      world.sky.haze_m = dice.Between(15.0, 60.0);
      break;
    case Light::kGlare:
      world.camera.exposure_ev = dice.Between(0.6, 1.2);
      break;
    case Light::kDusk:
      world.sun.strength = dice.Between(0.0, 0.2);
      world.camera.exposure_ev = dice.Between(-1.4, -0.7);
      world.camera.noise_levels = dice.Between(2.5, 4.0);
      break;
    case Light::kFair:
      break;
  }
}

/// In the map, as the building's frame lies there.
Vector2d ToMap(const Structure& building, const Vector2d& p) {
  return building.position_m + Eigen::Rotation2Dd(building.yaw_rad) * p;
}

void AddWanted(World& world, const Wanted& wanted) {
  for (Structure obstacle : wanted.obstacles) {
    obstacle.position_m = ToMap(wanted.building, obstacle.position_m);
    obstacle.yaw_rad += wanted.building.yaw_rad;
    world.obstacles.push_back(obstacle);
  }
  for (Bush bush : wanted.bushes) {
    bush.position_m = ToMap(wanted.building, bush.position_m);
    world.bushes.push_back(bush);
  }
  world.buildings.push_back(wanted.building);
  world.mission.wanted = {wanted.building.id};
}

/// None when the building that was drawn is too large for the overview.
std::optional<World> DrawOnce(std::uint64_t seed, const Plan* given) {
  Dice dice(seed);
  World world;
  world.home_yaw_rad = dice.Between(-std::numbers::pi, std::numbers::pi);
  world.vehicle = kVehicle;
  world.camera = DrawCamera(dice);
  world.ground = DrawGround(dice);
  world.pose_noise = DrawPoseNoise(dice);
  DrawWeather(world, dice);
  const Plan plan = given ? *given : DrawPlan(dice);
  world.title = plan.kind;
  if (plan.is_meadow) world.ground = {{0.12, 0.20, 0.07}, Pattern::kGrass, 0.12, 0.6};
  const double spare_m = 0.15 + 4.0 * world.pose_noise.position_std_m;
  Wanted wanted = DrawWanted(plan.order, world.vehicle, spare_m, world.ground, dice);
  if (!Place(wanted.building, wanted.size_m, wanted.height_m, dice)) return std::nullopt;
  AddWanted(world, wanted);
  world.mission.reference_m_per_px = dice.Between(0.018, 0.035);
  world.mission.reference_rotation_cw_rad = dice.Between(-std::numbers::pi, std::numbers::pi);
  AddDistractors(world, wanted, dice);
  AddHorizon(world, dice);
  if (dice.Chance(0.2) && !wanted.building.is_absent) MakeGroup(world);
  SetLight(plan.light, wanted.building.yaw_rad + 0.5 * std::numbers::pi, world, dice);
  return world;
}

/// Whether the best way is wide enough, or not, by at least that much.
bool IsClear(const World& world, double least_lack_m, double least_spare_m) {
  const Truth truth = FindTruth(world);
  for (const ObjectTruth& object : truth.objects) {
    if (object.passages.empty()) continue;
    const double spare_m = object.passages.front().spare_m;
    if (spare_m > -least_lack_m && spare_m < least_spare_m) return false;
    if (spare_m > 0.0 && !object.passages.front().is_passable) return false;
  }
  return true;
}

}  // namespace

World DrawWorld(std::uint64_t seed) {
  constexpr double kLeast_m = 0.08;
  for (std::uint64_t attempt = 0;; ++attempt) {
    std::optional<World> world = DrawOnce(Mix(seed) + attempt, nullptr);
    if (!world || !IsHomeFree(*world)) continue;
    if (!IsClear(*world, kLeast_m, kLeast_m + 3.0 * world->pose_noise.position_std_m)) continue;
    world->name = "seed-" + std::to_string(seed);
    world->title += ", random world " + std::to_string(seed);
    return *world;
  }
}

World DrawNastyWorld(std::uint64_t seed) {
  constexpr double kLeast_m = 0.015;
  const Plan& plan = NastyPlans()[seed % NastyPlans().size()];
  for (std::uint64_t attempt = 0;; ++attempt) {
    std::optional<World> world = DrawOnce(Mix(~seed) + attempt, &plan);
    if (!world || !IsHomeFree(*world) || !IsClear(*world, kLeast_m, kLeast_m)) continue;
    world->name = "nasty-" + std::to_string(seed);
    world->title += ", nasty world " + std::to_string(seed);
    return *world;
  }
}

}  // namespace soffit::sim
