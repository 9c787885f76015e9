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

std::vector<Eigen::Vector2d> PlanOf(const Corridor& corridor) {
  std::vector<Eigen::Vector2d> plan;
  for (const Eigen::Vector3d& point : corridor.Path()) plan.push_back(point.head<2>());
  return plan;
}

const Solid* FindSolid(const Scene& scene, std::uint32_t object_id) {
  for (const Solid& solid : scene.solids) {
    if (solid.footprint.object_id == object_id) return &solid;
  }
  return nullptr;
}

/// The least margin, and what it is to; one that is not a number is less than any.
std::pair<double, Bound> FindLeastMargin(const ClearanceDecision& decision) {
  std::pair<double, Bound> least(decision.margin_up_m, Bound::kRoof);
  for (const auto& margin :
       {std::pair(decision.margin_left_m, Bound::kLeft), std::pair(decision.margin_right_m, Bound::kRight),
        std::pair(decision.margin_down_m, Bound::kGround)}) {
    if (!std::isnan(least.first) && !(margin.first >= least.first)) least = margin;
  }
  return least;
}

ClearanceDecision Block(ClearanceDecision decision, std::string reason) {
  decision.verdict = Verdict::kBlocked;
  decision.reason = std::move(reason);
  return decision;
}

/// @param wanted  The picture that would settle it.
ClearanceDecision Doubt(ClearanceDecision decision, std::string reason, std::optional<Viewpoint> wanted) {
  decision.reason = std::move(reason);
  decision.wanted = std::move(wanted);
  return decision;
}

/// The space that the vehicle needs on a corridor, its safety margin included.
struct Needed {
  std::vector<Eigen::Vector2d> path;
  double radius_m = 0.0;
  double bottom_m = 0.0;
  double top_m = 0.0;
  double slack_m = 0.0;  ///< k sigma of the passage's sides.
  bool stands_on_ground = false;
};

/// All that the decisions on one object have in common.
struct Judge {
  const Scene& scene;
  const Solid& solid;
  const std::vector<Sight>& sights;
  const VehicleEnvelope& vehicle;
  const ClearanceOptions& options;

  std::string Place(const Eigen::Vector3d& in_map_m) const { return SayPlace(scene.map_origin_m + in_map_m); }

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
      std::vector<Eigen::Vector3d> path = corridor.Path();
      if (is_reverse) std::reverse(path.begin(), path.end());
      Viewpoint look = PlanCorridorLook(path[0], path[1], Map(), sights.front().view.intrinsics, vehicle, {});
      look.object_id = solid.footprint.object_id;
      const bool is_taken = std::any_of(sights.begin(), sights.end(), [&](const Sight& sight) {
        return (sight.view.map_from_camera.translation_m - look.position_in_map_m).norm() < kSameView_m;
      });
      if (!is_taken) return look;
    }
    return std::nullopt;
  }

  bool IsUnseen(int side) const {
    return std::count(solid.unseen_walls.begin(), solid.unseen_walls.end(), side) > 0;
  }

  bool AreBothEndsSeen(const Corridor& corridor) const {
    return !IsUnseen(corridor.entry_wall) && !IsUnseen(corridor.exit_wall);
  }

  Needed NeededOn(const Corridor& corridor) const;
  void MeasureMargins(const Needed& needed, ClearanceDecision& decision) const;
  std::optional<std::string> FindTightness(const Corridor& corridor, const Needed& needed) const;
  std::optional<std::uint32_t> FindModelInTheWay(const Needed& needed) const;
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
  const ClearanceDecision decision = Start(-1);
  const Polygon& polygon = solid.footprint.polygon_in_map_m;
  for (const SolidOpening& opening : solid.openings) {
    if (opening.wall < 0) continue;
    const Wall wall = WallOf(polygon.outer, opening.wall);
    const auto way = FindWayOut(polygon, opening.wall, wall.U(MiddleOf(opening).head<2>()));
    if (way && IsUnseen(way->side))
      return Doubt(decision, Say("wall ", opening.wall, " has an opening, the wall opposite was not seen"),
                   LookAtWall(way->side));
  }
  for (const int side : solid.unseen_walls) {
    const Wall wall = WallOf(polygon.outer, side);
    if (wall.width_m < vehicle.NeededWidth_m()) continue;
    const auto way = FindWayOut(polygon, side, 0.5 * wall.width_m);
    if (!way || !IsUnseen(way->side)) continue;
    return Doubt(decision, Say("walls ", side, " and ", way->side, " were not seen"), LookAtWall(side));
  }
  return Block(decision, solid.openings.empty() ? "it has no opening" : "it does not go through");
}

/// Other buildings are known by their outlines alone, and taken to be without openings and as high as the
/// sky. An outline that lies over the model is no other building: it is this one, badly seen.
std::optional<std::string> Judge::FindNeighbourInTheWay(const Corridor& corridor) const {
  const double keep_m = vehicle.radius_m + vehicle.safety_margin_m;
  const std::vector<Eigen::Vector2d> path = PlanOf(corridor);
  for (const SceneObject& object : scene.objects) {
    if (FindSolid(scene, object.footprint.object_id) != nullptr) continue;
    if (ShareInside(solid.footprint.polygon_in_map_m.outer, object.footprint.polygon_in_map_m.outer) >
        kSameBuildingShare)
      continue;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      if (DistanceToSegment(object.footprint.polygon_in_map_m.outer, path[i], path[i + 1]) < keep_m)
        return "building " + std::to_string(object.footprint.object_id) + " stands in the way";
    }
  }
  return std::nullopt;
}

Needed Judge::NeededOn(const Corridor& corridor) const {
  const double middle_z = corridor.entry_in_map_m.z();
  return {PlanOf(corridor),
          vehicle.radius_m + vehicle.safety_margin_m,
          middle_z - 0.5 * vehicle.NeededHeight_m(),
          middle_z + 0.5 * vehicle.NeededHeight_m(),
          options.sigmas * corridor.std_m,
          corridor.floor_m <= 0.0};
}

void Judge::MeasureMargins(const Needed& needed, ClearanceDecision& decision) const {
  const Corridor& corridor = *decision.corridor;
  const double side_slack = options.sigmas * std::hypot(corridor.std_m, corridor.place_std_m);
  decision.margin_up_m = corridor.floor_m + corridor.free_height_m - needed.top_m - needed.slack_m;
  decision.margin_down_m =
      needed.bottom_m - corridor.floor_m - (needed.stands_on_ground ? 0.0 : needed.slack_m);
  decision.margin_left_m = corridor.left_m - needed.radius_m - side_slack;
  decision.margin_right_m = corridor.free_width_m - corridor.left_m - needed.radius_m - side_slack;
  decision.binding = FindLeastMargin(decision).second;
  decision.distances = MeasureDistances(scene, corridor.Path(), vehicle, kDistanceReach_m);
}

/// Why it is known that the vehicle does not fit; none when it may.
std::optional<std::string> Judge::FindTightness(const Corridor& corridor, const Needed& needed) const {
  const double spare_width = corridor.free_width_m - vehicle.NeededWidth_m();
  const double spare_height = corridor.free_height_m - vehicle.NeededHeight_m();
  const double height_slack = (needed.stands_on_ground ? 1.0 : 2.0) * needed.slack_m;
  const std::string because = corridor.limited_by.empty() ? "" : " (" + corridor.limited_by + ")";
  if (spare_width + 2.0 * needed.slack_m < 0.0) return "too narrow by " + InMetres(-spare_width) + because;
  // From one side alone, a wall that stands far behind may look like the head.
  if (spare_height + height_slack < 0.0 && AreBothEndsSeen(corridor))
    return "too low by " + InMetres(-spare_height) + because;
  return FindNeighbourInTheWay(corridor);
}

/// Which model reaches into the corridor, k sigma added; exact.
std::optional<std::uint32_t> Judge::FindModelInTheWay(const Needed& needed) const {
  const double bottom_m = needed.bottom_m - (needed.stands_on_ground ? 0.0 : needed.slack_m);
  for (std::size_t i = 0; i + 1 < needed.path.size(); ++i) {
    const Prism swept = SweepCylinder(needed.path[i], needed.path[i + 1], needed.radius_m + needed.slack_m,
                                      bottom_m, needed.top_m + needed.slack_m);
    for (const Solid& other : scene.solids) {
      if (Meets(other.mesh, swept)) return other.footprint.object_id;
    }
  }
  return std::nullopt;
}

ClearanceDecision Judge::OnCorridor(const Corridor& corridor) const {
  ClearanceDecision decision = Start(corridor.entry_wall);
  decision.corridor = corridor;
  const Needed needed = NeededOn(corridor);
  MeasureMargins(needed, decision);
  if (const auto tightness = FindTightness(corridor, needed)) return Block(decision, *tightness);
  const Sweep sweep = SweepOctree(*scene.octree, needed.path, needed.radius_m, needed.bottom_m, needed.top_m);
  decision.seen_ratio = sweep.SeenRatio();
  const auto [least_m, bound] = FindLeastMargin(decision);
  const std::string least = Say("least margin ", least_m, " m (", ToString(bound), ")");
  if (!(least_m >= -kTiny_m)) {
    return Doubt(decision,
                 Say(AreBothEndsSeen(corridor) ? "too close to call: " : "seen from one side only: ",
                     corridor.free_width_m - vehicle.NeededWidth_m(), " m to spare in width, ",
                     corridor.free_height_m - vehicle.NeededHeight_m(), " m in height, ", least,
                     corridor.limited_by.empty() ? "" : "; ", corridor.limited_by),
                 LookAlong(corridor));
  }
  if (const auto other = FindModelInTheWay(needed)) {
    return Doubt(decision, Say("the model of building ", *other, " reaches into the corridor"),
                 LookAlong(corridor));
  }
  if (sweep.first_occupied_m) return Block(decision, "obstacle at " + Place(*sweep.first_occupied_m));
  if (!(decision.seen_ratio >= options.min_seen_ratio) || sweep.voxels == 0) {
    return Doubt(
        decision,
        Say(sweep.voxels - sweep.free, " of ", sweep.voxels, " voxels of the corridor were not seen free",
            sweep.unknown_m.empty() ? "" : ", as at " + Place(sweep.unknown_m[sweep.unknown_m.size() / 2])),
        PlanLook(scene, corridor, sweep.unknown_m, sights, vehicle));
  }
  if (!corridor.bends_in_map_m.empty()) {
    return Doubt(decision,
                 "it bends at " + Place(corridor.bends_in_map_m.front()) +
                     ": no picture shows that it leads through there",
                 LookAlong(corridor));
  }
  decision.verdict = Verdict::kClear;
  decision.reason =
      Say("free: ", corridor.free_width_m, " m wide, ", corridor.free_height_m, " m high, ", least);
  return decision;
}

/// The same corridor, flown the other way.
void Reverse(Corridor& corridor) {
  std::swap(corridor.entry_wall, corridor.exit_wall);
  std::swap(corridor.entry_in_map_m, corridor.exit_in_map_m);
  std::reverse(corridor.bends_in_map_m.begin(), corridor.bends_in_map_m.end());
  corridor.left_m = corridor.free_width_m - corridor.left_m;
}

/// The decision on flying its corridor the other way.
void Reverse(ClearanceDecision& decision) {
  Reverse(*decision.corridor);
  decision.side = decision.corridor->entry_wall;
  std::swap(decision.margin_left_m, decision.margin_right_m);
  if (decision.binding == Bound::kLeft || decision.binding == Bound::kRight)
    decision.binding = decision.binding == Bound::kLeft ? Bound::kRight : Bound::kLeft;
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

const char* ToString(Bound bound) {
  switch (bound) {
    case Bound::kRoof:
      return "roof";
    case Bound::kLeft:
      return "left";
    case Bound::kRight:
      return "right";
    case Bound::kGround:
      return "ground";
    case Bound::kNone:
      break;
  }
  return "";
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
    for (const bool is_reverse : {false, true}) {
      decisions.push_back(is_reverse ? decisions.back() : judge.OnCorridor(corridor));
      if (is_reverse) Reverse(decisions.back());
    }
  }
  return decisions;
}

}  // namespace soffit
