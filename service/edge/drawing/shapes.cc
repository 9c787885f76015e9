#include "service/edge/drawing/shapes.h"

#include <algorithm>

namespace soffit {

Ring3 Lift(const Ring& ring, double height_m) {
  Ring3 lifted;
  for (const Eigen::Vector2d& corner : ring) lifted.emplace_back(corner.x(), corner.y(), height_m);
  return lifted;
}

Ring3 WallOver(const Ring& ring, std::size_t side, double height_m) {
  const Eigen::Vector2d& a = ring[side];
  const Eigen::Vector2d& b = ring[(side + 1) % ring.size()];
  return {{a.x(), a.y(), 0.0}, {b.x(), b.y(), 0.0}, {b.x(), b.y(), height_m}, {a.x(), a.y(), height_m}};
}

Eigen::Vector3d PolygonNormal(const Ring3& ring) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    normal += (ring[i] - ring.front()).cross(ring[(i + 1) % ring.size()] - ring.front());
  }
  return normal.normalized();
}

std::vector<ClearanceDecision> ChooseShownDecisions(const std::vector<ClearanceDecision>& decisions) {
  std::vector<ClearanceDecision> sorted = decisions;
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
    return (a.verdict == Verdict::kClear) > (b.verdict == Verdict::kClear);
  });
  std::vector<ClearanceDecision> shown;
  for (const ClearanceDecision& decision : sorted) {
    if (!decision.corridor || !(decision.corridor->free_width_m > 0.0)) continue;
    const Corridor& corridor = *decision.corridor;
    const bool is_known =
        std::any_of(shown.begin(), shown.end(), [&corridor](const ClearanceDecision& other) {
          const double near_m = corridor.free_width_m / 2.0;
          const Corridor& back = *other.corridor;
          return (back.entry_in_map_m - corridor.exit_in_map_m).norm() < near_m &&
                 (back.exit_in_map_m - corridor.entry_in_map_m).norm() < near_m;
        });
    if (!is_known) shown.push_back(decision);
  }
  return shown;
}

}  // namespace soffit
