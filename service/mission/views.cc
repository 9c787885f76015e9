#include "service/mission/views.h"

#include <algorithm>
#include <cmath>

namespace soffit {
namespace {

constexpr double kSamePlace_m = 0.3;
constexpr double kSameAngle_rad = 0.1;
constexpr double kHigherOverview_ratio = 1.4;
constexpr int kMaxOverviews = 2;

bool IsSame(const Viewpoint& a, const Viewpoint& b) {
  return (a.position_in_map_m - b.position_in_map_m).norm() < kSamePlace_m &&
         std::abs(std::remainder(a.yaw_rad - b.yaw_rad, 2.0 * M_PI)) < kSameAngle_rad &&
         std::abs(a.pitch_rad - b.pitch_rad) < kSameAngle_rad;
}

int CountOf(Purpose purpose, const std::vector<Viewpoint>& views) {
  return static_cast<int>(std::count_if(views.begin(), views.end(),
                                        [&](const Viewpoint& view) { return view.purpose == purpose; }));
}

}  // namespace

Viewpoint ViewPlanner::Overview() const { return OverDisc(m_.order.area_center_in_map_m, Radius_m()); }

std::vector<Viewpoint> ViewPlanner::ToRecognize() const {
  if (CountOf(Purpose::kOverview, m_.viewed) < kMaxOverviews) return {FromHigher()};
  return EachFromAbove();
}

Viewpoint ViewPlanner::FromHigher() const {
  Eigen::AlignedBox2d seen;
  for (const Footprint& object : m_.findings->map) {
    for (const Eigen::Vector2d& corner : object.polygon_in_map_m.outer) seen.extend(corner);
  }
  if (seen.isEmpty()) seen.extend(m_.order.area_center_in_map_m);
  Viewpoint view = OverDisc(seen.center(), std::max(Radius_m(), seen.diagonal().norm() / 2.0));
  view.reason = "again from higher, over the middle of what was seen";
  double& altitude_m = view.position_in_map_m.z();
  altitude_m = std::max(altitude_m, Overview().position_in_map_m.z() * kHigherOverview_ratio);
  altitude_m = std::min(altitude_m, viewpoints_.max_altitude_m);
  return view;
}

std::vector<Viewpoint> ViewPlanner::EachFromAbove() const {
  const int left = options_.candidate_views - CountOf(Purpose::kTop, m_.viewed);
  std::vector<Viewpoint> views;
  for (const Footprint& object : m_.findings->map) {
    if (static_cast<int>(views.size()) >= left) break;
    const bool was_viewed = std::any_of(m_.viewed.begin(), m_.viewed.end(), [&](const Viewpoint& old) {
      return old.purpose == Purpose::kTop && old.object_id == object.object_id;
    });
    if (!was_viewed) views.push_back(Top(object));
  }
  return views;
}

Viewpoint ViewPlanner::Top(std::uint32_t object_id) const { return Top(Find(object_id)); }

Viewpoint ViewPlanner::Top(const Footprint& object) const {
  return PlanTop(object, m_.vehicle->camera, m_.vehicle->envelope, viewpoints_);
}

std::vector<Viewpoint> ViewPlanner::Walls(std::uint32_t object_id) const {
  return PlanWalls(Find(object_id), m_.findings->map, m_.vehicle->camera, m_.vehicle->envelope, viewpoints_);
}

Viewpoint ViewPlanner::Around(std::uint32_t object_id, const std::vector<Viewpoint>& walls) const {
  const Eigen::Vector2d center = Centroid(Find(object_id).polygon_in_map_m);
  double radius_m = 0.0;
  for (const Viewpoint& wall : walls) {
    radius_m = std::max(radius_m, (wall.position_in_map_m.head<2>() - center).norm());
  }
  Viewpoint view = OverDisc(center, radius_m + 2.0 * KeepOff_m());
  view.reason = "the ground around it, where wall views are planned";
  view.purpose = Purpose::kTop;
  view.object_id = object_id;
  return view;
}

std::vector<Viewpoint> ViewPlanner::OverSeenGround(const std::vector<Viewpoint>& views) const {
  std::vector<Viewpoint> seen;
  std::copy_if(views.begin(), views.end(), std::back_inserter(seen),
               [&](const Viewpoint& view) { return IsOverSeenGround(view); });
  return seen;
}

Viewpoint ViewPlanner::Along(const Corridor& corridor) const {
  return PlanCorridorLook(corridor.entry_in_map_m, corridor.exit_in_map_m, m_.findings->map,
                          m_.vehicle->camera, m_.vehicle->envelope, viewpoints_);
}

bool ViewPlanner::CanLookAt(const Viewpoint& view) const {
  const bool is_old = std::any_of(m_.viewed.begin(), m_.viewed.end(),
                                  [&](const Viewpoint& old) { return IsSame(old, view); });
  return m_.more_views_used < options_.more_views && !is_old && IsOverSeenGround(view) &&
         std::all_of(m_.findings->map.begin(), m_.findings->map.end(),
                     [&](const Footprint& object) { return IsClearOf(object, view.position_in_map_m); });
}

Viewpoint ViewPlanner::OverDisc(const Eigen::Vector2d& center, double radius_m) const {
  return PlanOverview(center, radius_m, m_.vehicle->camera, viewpoints_);
}

const Footprint& ViewPlanner::Find(std::uint32_t object_id) const {
  const auto& map = m_.findings->map;
  const auto found = std::find_if(map.begin(), map.end(),
                                  [&](const Footprint& object) { return object.object_id == object_id; });
  if (found == map.end()) throw ContractViolation("Findings: a wanted building is not in the map");
  return *found;
}

bool ViewPlanner::IsOverSeenGround(const Viewpoint& view) const {
  const Intrinsics& camera = m_.vehicle->camera;
  const double reach_ratio = 0.5 * std::min(camera.width_px / camera.fx_px, camera.height_px / camera.fy_px);
  return std::any_of(m_.viewed.begin(), m_.viewed.end(), [&](const Viewpoint& above) {
    if (above.purpose != Purpose::kOverview && above.purpose != Purpose::kTop) return false;
    const double reach_m = above.position_in_map_m.z() * reach_ratio;
    return (view.position_in_map_m - above.position_in_map_m).head<2>().norm() + KeepOff_m() <= reach_m;
  });
}

bool ViewPlanner::IsClearOf(const Footprint& object, const Eigen::Vector3d& place) const {
  const Ring& ring = object.polygon_in_map_m.outer;
  const bool is_above =
      object.height_m > 0.0 && place.z() > object.height_m + m_.vehicle->envelope.NeededHeight_m();
  const Eigen::Vector2d on_ground = place.head<2>();
  return is_above || (!Contains(ring, on_ground) && DistanceToRing(on_ground, ring) >= KeepOff_m());
}

double ViewPlanner::Radius_m() const {
  return m_.order.area_radius_m > 0.0 ? m_.order.area_radius_m : options_.area_radius_m;
}

double ViewPlanner::KeepOff_m() const {
  return m_.vehicle->envelope.radius_m + m_.vehicle->envelope.safety_margin_m;
}

}  // namespace soffit
