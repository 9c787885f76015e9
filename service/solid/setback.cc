#include "service/solid/setback.h"

#include <algorithm>

#include "service/facade/wall.h"

namespace soffit {
namespace {

constexpr double kOvercut_m = 0.01;     // Cuts reach this far out of the solid, so that no faces coincide.
constexpr double kClean_m = 1e-6;       // Cuts along an edge of the solid go this far inside of it.
constexpr double kLeastInset_m = 1e-3;  // Less is plumb.
constexpr double kReachShare = 0.95;    // Of a cut's depth: a wing that is lowered as a whole ends there.

/// (inward, up) along a wall, from where it leaves the plumb of its foot up to the roof. Empty: it does not.
Ring RiseOf(const std::vector<Level>& levels, std::size_t side) {
  Ring rise = {{0.0, 0.0}};
  for (const Level& level : levels) {
    const Eigen::Vector2d next(level.inset_m[side], level.height_m);
    if (next.x() < kLeastInset_m) {
      rise = {{0.0, level.height_m}};
    } else if ((next - rise.back()).norm() > kClean_m) {
      rise.push_back(next);
    }
  }
  while (rise.size() > 1 && !(rise.back().y() > rise[rise.size() - 2].y())) rise.pop_back();  // A last ledge.
  return rise.size() > 1 ? rise : Ring{};
}

/// All that is outside of a rise.
Ring OutsideOf(const Ring& rise) {
  const Eigen::Vector2d first = rise[1] - rise.front(), last = rise.back() - rise[rise.size() - 2];
  Ring outside = rise;
  outside.front() -= kOvercut_m / first.x() * first;
  outside.push_back(rise.back() + kOvercut_m / last.y() * last);
  for (Eigen::Vector2d& p : outside) p.x() += kClean_m;
  outside.emplace_back(outside.front().x(), outside.back().y());
  return outside;
}

struct Reach {
  double left_m = 0.0, right_m = 0.0;
};

/// From where to where, along a side, the footprint goes that one reaches from the side without going deeper
/// than this: farther than the side itself where its neighbours spread.
Reach ReachOf(const Ring& outer, int side, double depth_m) {
  const Wall wall = WallOf(outer, side);
  const std::size_t n = outer.size();
  Reach reach{0.0, wall.width_m};
  const auto walk = [&](std::size_t from, std::size_t step) {
    for (std::size_t k = 0, at = from; k < n; ++k, at = (at + step) % n) {
      const Eigen::Vector2d &a = outer[at], &b = outer[(at + step) % n];
      const double of_a = -wall.Front(a), of_b = -wall.Front(b);
      const double share = of_b > depth_m ? (depth_m - of_a) / (of_b - of_a) : 1.0;
      const double u = wall.U(a + share * (b - a));
      reach = {std::min(reach.left_m, u), std::max(reach.right_m, u)};
      if (share < 1.0) return;
    }
  };
  walk((static_cast<std::size_t>(side) + 1) % n, 1);
  walk(static_cast<std::size_t>(side), n - 1);
  return reach;
}

Eigen::Vector3d Level3d(const Eigen::Vector2d& plan) { return {plan.x(), plan.y(), 0.0}; }

}  // namespace

std::optional<Prism> CutAbove(const Footprint& footprint, int side) {
  const Ring rise = RiseOf(footprint.levels, static_cast<std::size_t>(side));
  if (rise.empty()) return std::nullopt;
  const Ring& outer = footprint.polygon_in_map_m.outer;
  const Wall wall = WallOf(outer, side);
  const Reach reach = ReachOf(outer, side, kReachShare * rise.back().x());
  const double length_m = reach.right_m - reach.left_m + 2.0 * kOvercut_m;
  return Prism{OutsideOf(rise), Level3d(wall.InPlan(reach.left_m - kOvercut_m)), Level3d(-wall.outward),
               Eigen::Vector3d::UnitZ(), Level3d(length_m * wall.along)};
}

}  // namespace soffit
