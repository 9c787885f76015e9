#include "service/clearance/clearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "service/clearance/contact.h"
#include "service/clearance/look.h"
#include "service/facade/wall.h"
#include "service/scene/sweep.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr double kSameView_m = 0.5;
constexpr double kTiny_m = 1e-9;
constexpr double kSameBuildingShare = 0.25;

std::string InMetres(double value) { return Say(value, " m"); }

std::string Place(const Eigen::Vector3d& p) { return Say("(", p.x(), ", ", p.y(), ", ", p.z(), ")"); }

const Solid* FindSolid(const Scene& scene, std::uint32_t object_id) {
  for (const Solid& solid : scene.solids) {
    if (solid.footprint.object_id == object_id) return &solid;
  }
  return nullptr;
}

/// All that the decisions on one object have in common.
struct Judge {
  const Scene& scene;
  const Solid& solid;
  const std::vector<Sight>& sights;
  const VehicleEnvelope& vehicle;
  const ClearanceOptions& options;

  ClearanceDecision Start(int side) const {
    ClearanceDecision decision;
    decision.object_id = solid.footprint.object_id;
    decision.side = side;
    decision.vehicle = vehicle;
    decision.scene_revision = scene.revision;
    for (const Sight& sight : sights) {
      if (sight.has_trusted_pose) decision.evidence.push_back(sight.capture_id);
    }
    return decision;
  }

  std::vector<Footprint> Map() const {
    std::vector<Footprint> map;
    for (const SceneObject& object : scene.objects) map.push_back(object.footprint);
    return map;
  }

  std::optional<Viewpoint> LookAtWall(int side) const {
    if (sights.empty()) return std::nullopt;
    return PlanWall(solid.footprint, side, Map(), sights.front().view.intrinsics, vehicle, {});
  }

  /// A look along the corridor, from the side from which there is none yet.
  std::optional<Viewpoint> LookAlong(const Corridor& corridor) const {
    if (sights.empty()) return std::nullopt;
    for (const bool is_reverse : {false, true}) {
      Viewpoint look = PlanCorridorLook(is_reverse ? corridor.exit_in_map_m : corridor.entry_in_map_m,
                                        is_reverse ? corridor.entry_in_map_m : corridor.exit_in_map_m, Map(),
                                        sights.front().view.intrinsics, vehicle, {});
      look.object_id = solid.footprint.object_id;
      const bool is_taken = std::any_of(sights.begin(), sights.end(), [&](const Sight& sight) {
        return (sight.view.map_from_camera.translation_m - look.position_in_map_m).norm() < kSameView_m;
      });
      if (!is_taken) return look;
    }
    return std::nullopt;
  }

  ClearanceDecision WithoutPassage() const;
  ClearanceDecision OnCorridor(const Corridor& corridor) const;
  std::optional<std::string> FindNeighbourInTheWay(const Corridor& corridor) const;
};

Eigen::Vector3d MiddleOf(const SolidOpening& opening) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : opening.polygon_in_map_m) middle += p;
  return middle / static_cast<double>(opening.polygon_in_map_m.size());
}

ClearanceDecision Judge::WithoutPassage() const {
  ClearanceDecision decision = Start(-1);
  const Polygon& polygon = solid.footprint.polygon_in_map_m;
  const auto is_unseen = [&](int side) {
    return std::count(solid.unseen_walls.begin(), solid.unseen_walls.end(), side) > 0;
  };
  for (const SolidOpening& opening : solid.openings) {
    if (opening.wall < 0) continue;
    const Wall wall = WallOf(polygon.outer, opening.wall);
    const auto way = FindWayOut(polygon, opening.wall, wall.U(MiddleOf(opening).head<2>()));
    if (way && is_unseen(way->side)) {
      decision.reason =
          "wall " + std::to_string(opening.wall) + " has an opening, the wall opposite was not seen";
      decision.wanted = LookAtWall(way->side);
      return decision;
    }
  }
  for (const int side : solid.unseen_walls) {
    const Wall wall = WallOf(polygon.outer, side);
    if (wall.width_m < vehicle.NeededWidth_m()) continue;
    const auto way = FindWayOut(polygon, side, 0.5 * wall.width_m);
    if (!way || !is_unseen(way->side)) continue;
    decision.reason =
        "walls " + std::to_string(side) + " and " + std::to_string(way->side) + " were not seen";
    decision.wanted = LookAtWall(side);
    return decision;
  }
  decision.verdict = Verdict::kBlocked;
  decision.reason = solid.openings.empty() ? "it has no opening" : "it does not go through";
  return decision;
}

/// Other buildings are known by their outlines alone, and taken to be without openings and as high as the
/// sky. An outline that lies over the model is no other building: it is this one, badly seen.
std::optional<std::string> Judge::FindNeighbourInTheWay(const Corridor& corridor) const {
  const double keep_m = vehicle.radius_m + vehicle.safety_margin_m;
  const Eigen::Vector2d from = corridor.entry_in_map_m.head<2>();
  const Eigen::Vector2d to = corridor.exit_in_map_m.head<2>();
  for (const SceneObject& object : scene.objects) {
    if (FindSolid(scene, object.footprint.object_id) != nullptr) continue;
    if (ShareInside(solid.footprint.polygon_in_map_m.outer, object.footprint.polygon_in_map_m.outer) >
        kSameBuildingShare)
      continue;
    if (DistanceToSegment(object.footprint.polygon_in_map_m.outer, from, to) >= keep_m) continue;
    return "building " + std::to_string(object.footprint.object_id) + " stands in the way";
  }
  return std::nullopt;
}

ClearanceDecision Judge::OnCorridor(const Corridor& corridor) const {
  ClearanceDecision decision = Start(corridor.entry_wall);
  decision.corridor = corridor;
  const double slack = options.sigmas * corridor.std_m;
  const double spare_width = corridor.free_width_m - vehicle.NeededWidth_m();
  const double spare_height = corridor.free_height_m - vehicle.NeededHeight_m();
  const bool stands_on_ground = corridor.floor_m <= 0.0;

  const double radius = vehicle.radius_m + vehicle.safety_margin_m;
  const double middle_z = corridor.entry_in_map_m.z();
  const double bottom = middle_z - 0.5 * vehicle.NeededHeight_m();
  const double top = middle_z + 0.5 * vehicle.NeededHeight_m();
  decision.margin_up_m = corridor.floor_m + corridor.free_height_m - top - slack;
  decision.margin_down_m = bottom - corridor.floor_m - (stands_on_ground ? 0.0 : slack);
  const double side_slack = options.sigmas * std::hypot(corridor.std_m, corridor.place_std_m);
  decision.margin_left_m = corridor.left_m - radius - side_slack;
  decision.margin_right_m = corridor.free_width_m - corridor.left_m - radius - side_slack;
  const Eigen::Vector2d from = corridor.entry_in_map_m.head<2>();
  const Eigen::Vector2d to = corridor.exit_in_map_m.head<2>();
  const Sweep sweep = SweepOctree(*scene.octree, from, to, radius, bottom, top);
  decision.seen_ratio = sweep.SeenRatio();

  const double height_slack = (stands_on_ground ? 1.0 : 2.0) * slack;
  const std::string because = corridor.limited_by.empty() ? "" : " (" + corridor.limited_by + ")";
  if (spare_width + 2.0 * slack < 0.0 && spare_width < 0.0) {
    decision.verdict = Verdict::kBlocked;
    decision.reason = "too narrow by " + InMetres(-spare_width) + because;
    return decision;
  }
  if (spare_height + height_slack < 0.0 && spare_height < 0.0) {
    decision.verdict = Verdict::kBlocked;
    decision.reason = "too low by " + InMetres(-spare_height) + because;
    return decision;
  }
  if (const auto neighbour = FindNeighbourInTheWay(corridor)) {
    decision.verdict = Verdict::kBlocked;
    decision.reason = *neighbour;
    return decision;
  }
  const double side_margin = std::min(decision.margin_left_m, decision.margin_right_m);
  const double height_margin = std::min(decision.margin_up_m, decision.margin_down_m);
  if (!(side_margin >= 0.0) || !(height_margin >= -kTiny_m)) {
    decision.reason = "too close to call: " + InMetres(spare_width) + " to spare in width, " +
                      InMetres(spare_height) + " in height, worst margin " +
                      InMetres(std::min(side_margin, height_margin)) + because;
    decision.wanted = LookAlong(corridor);
    return decision;
  }
  const Prism swept =
      SweepCylinder(from, to, radius + slack, bottom - (stands_on_ground ? 0.0 : slack), top + slack);
  for (const Solid& other : scene.solids) {
    if (!Meets(other.mesh, swept)) continue;
    decision.reason =
        "the model of building " + std::to_string(other.footprint.object_id) + " reaches into the corridor";
    decision.wanted = LookAlong(corridor);
    return decision;
  }
  if (sweep.first_occupied_m) {
    decision.verdict = Verdict::kBlocked;
    decision.reason = "obstacle at " + Place(*sweep.first_occupied_m);
    return decision;
  }
  if (!(decision.seen_ratio >= options.min_seen_ratio) || sweep.voxels == 0) {
    decision.reason =
        Say(sweep.voxels - sweep.free, " of ", sweep.voxels, " voxels of the corridor were not seen free");
    if (!sweep.unknown_m.empty())
      decision.reason += ", as at " + Place(sweep.unknown_m[sweep.unknown_m.size() / 2]);
    decision.wanted = PlanLook(scene, corridor, sweep.unknown_m, sights, vehicle);
    return decision;
  }
  decision.verdict = Verdict::kClear;
  decision.reason =
      "free: " + InMetres(corridor.free_width_m) + " wide, " + InMetres(corridor.free_height_m) + " high";
  return decision;
}

Corridor Reversed(Corridor corridor) {
  std::swap(corridor.entry_wall, corridor.exit_wall);
  std::swap(corridor.entry_in_map_m, corridor.exit_in_map_m);
  corridor.left_m = corridor.free_width_m - corridor.left_m;
  return corridor;
}

}  // namespace

const char* ToString(Verdict verdict) {
  switch (verdict) {
    case Verdict::kClear:
      return "CLEAR";
    case Verdict::kBlocked:
      return "BLOCKED";
    case Verdict::kInsufficientData:
      break;
  }
  return "INSUFFICIENT_DATA";
}

std::vector<ClearanceDecision> JudgeClearance(const Scene& scene, std::uint32_t object_id,
                                              const std::vector<Corridor>& corridors,
                                              const std::vector<Sight>& sights,
                                              const VehicleEnvelope& vehicle,
                                              const ClearanceOptions& options) {
  SOFFIT_EXPECT(IsValid(vehicle));
  SOFFIT_EXPECT(IsValidOptions(options));
  SOFFIT_EXPECT(scene.octree != nullptr);
  const Solid* solid = FindSolid(scene, object_id);
  SOFFIT_EXPECT(solid != nullptr);
  const Judge judge{scene, *solid, sights, vehicle, options};
  if (corridors.empty()) return {judge.WithoutPassage()};
  std::vector<ClearanceDecision> decisions;
  for (const Corridor& corridor : corridors) {
    ClearanceDecision there = judge.OnCorridor(corridor);
    ClearanceDecision back = there;
    back.side = corridor.exit_wall;
    back.corridor = Reversed(corridor);
    std::swap(back.margin_left_m, back.margin_right_m);
    decisions.push_back(std::move(there));
    decisions.push_back(std::move(back));
  }
  return decisions;
}

}  // namespace soffit
