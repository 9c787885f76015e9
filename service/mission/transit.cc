#include "service/mission/transit.h"

#include <algorithm>

namespace soffit {
namespace {
constexpr double kSamePlace_m = 0.5;
}

double TransitAltitude(const std::vector<Footprint>& map, const Eigen::Vector2d& from,
                       const Eigen::Vector2d& to, const VehicleEnvelope& vehicle, double clearance_m,
                       double unknown_m) {
  const double keep_m = vehicle.NeededWidth_m() / 2.0 + clearance_m;
  double highest_m = 0.0;
  bool is_known = !map.empty();
  for (const Footprint& object : map) {
    highest_m = std::max(highest_m, object.height_m + 3.0 * object.height_std_m);
    if (object.height_m > 0.0) continue;
    is_known = is_known && DistanceToSegment(object.polygon_in_map_m.outer, from, to) >= keep_m;
  }
  const double over_m = highest_m + vehicle.NeededHeight_m() / 2.0 + clearance_m;
  return is_known ? over_m : std::max(over_m, unknown_m);
}

std::vector<Eigen::Vector3d> FlyOver(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                     double altitude_m) {
  if ((to - from).head<2>().norm() < kSamePlace_m) return {to};
  const double across_m = std::max({altitude_m, from.z(), to.z()});
  std::vector<Eigen::Vector3d> path;
  if (across_m > from.z()) path.emplace_back(from.x(), from.y(), across_m);
  path.emplace_back(to.x(), to.y(), across_m);
  if (across_m > to.z()) path.push_back(to);
  return path;
}

}  // namespace soffit
