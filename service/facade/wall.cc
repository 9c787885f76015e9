#include "service/facade/wall.h"

#include <cmath>
#include <limits>

#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr double kOppositeCosine = 0.94;  // 20 degrees.
constexpr double kSameWall_m = 1e-6;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// How far along the ray the segment is met; infinite when it is not.
double MeetSegment(const Eigen::Vector2d& origin, const Eigen::Vector2d& direction, const Eigen::Vector2d& a,
                   const Eigen::Vector2d& b) {
  const double denominator = Cross(direction, b - a);
  if (denominator == 0.0) return std::numeric_limits<double>::infinity();
  const double along = Cross(a - origin, b - a) / denominator;
  const double share = Cross(a - origin, direction) / denominator;
  if (!(along > kSameWall_m) || !(share >= 0.0 && share < 1.0))
    return std::numeric_limits<double>::infinity();
  return along;
}

}  // namespace

Wall WallOf(const Ring& outer, int side) {
  SOFFIT_EXPECT(side >= 0 && side < static_cast<int>(outer.size()));
  const std::size_t first = static_cast<std::size_t>(side);
  const Eigen::Vector2d& a = outer[first];
  const Eigen::Vector2d& b = outer[(first + 1) % outer.size()];
  SOFFIT_EXPECT((b - a).norm() > 0.0);
  Wall wall;
  wall.first_corner_m = a;
  wall.width_m = (b - a).norm();
  wall.along = (b - a) / wall.width_m;
  wall.outward = {wall.along.y(), -wall.along.x()};
  return wall;
}

Wall WallOf(const Footprint& building, int side) {
  Wall wall = WallOf(building.polygon_in_map_m.outer, side);
  if (building.levels.empty()) return wall;
  const Level& first = building.levels.front();
  wall.lean = first.inset_m[static_cast<std::size_t>(side)] / first.height_m;
  return wall;
}

std::optional<Eigen::Vector2d> SpanAt(const Footprint& building, int side, double height_m) {
  const Wall wall = WallOf(building, side);
  if (height_m > building.height_m) return std::nullopt;
  if (building.levels.empty()) return Eigen::Vector2d(0.0, wall.width_m);
  const Ring& outer = building.polygon_in_map_m.outer;
  std::vector<double> inset_m;
  for (std::size_t i = 0; i < outer.size(); ++i) inset_m.push_back(InsetAt(building.levels, i, height_m));
  const auto at = static_cast<std::size_t>(side);
  if (std::abs(inset_m[at] - wall.lean * height_m) > kSameWall_m) return std::nullopt;
  const Ring ring = InsetRing(outer, inset_m);
  return Eigen::Vector2d(wall.U(ring[at]), wall.U(ring[(at + 1) % ring.size()]));
}

std::optional<WayOut> FindWayOut(const Polygon& footprint, int side, double u_m, double drift) {
  const Wall wall = WallOf(footprint.outer, side);
  const Eigen::Vector2d origin = wall.InPlan(u_m);
  const Eigen::Vector2d inward = (drift * wall.along - wall.outward).normalized();
  WayOut out;
  out.length_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < footprint.outer.size(); ++i) {
    const Eigen::Vector2d& b = footprint.outer[(i + 1) % footprint.outer.size()];
    const double length = MeetSegment(origin, inward, footprint.outer[i], b);
    if (length < out.length_m) out = {static_cast<int>(i), 0.0, length};
  }
  for (const Ring& hole : footprint.holes) {
    for (std::size_t i = 0; i < hole.size(); ++i) {
      if (MeetSegment(origin, inward, hole[i], hole[(i + 1) % hole.size()]) < out.length_m)
        return std::nullopt;
    }
  }
  if (out.side < 0 || out.side == side) return std::nullopt;
  const Wall exit = WallOf(footprint.outer, out.side);
  if (!(-exit.outward.dot(wall.outward) >= kOppositeCosine)) return std::nullopt;
  out.u_m = exit.U(origin + out.length_m * inward);
  return out;
}

}  // namespace soffit
