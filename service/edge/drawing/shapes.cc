#include "service/edge/drawing/shapes.h"

#include <algorithm>

#include "service/edge/drawing/canvas.h"

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

std::array<Eigen::Vector3d, 8> CorridorBox(const Corridor& corridor) {
  const Eigen::Vector3d& entry = corridor.entry_in_map_m;
  const Eigen::Vector3d& exit = corridor.exit_in_map_m;
  const Eigen::Vector3d along = (exit - entry).normalized();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(along) * corridor.free_width_m / 2.0;
  std::array<Eigen::Vector3d, 8> box;
  for (std::size_t end = 0; end < 2; ++end) {
    Eigen::Vector3d foot = end == 0 ? entry : exit;
    foot.z() = corridor.floor_m;
    const Eigen::Vector3d head = foot + corridor.free_height_m * Eigen::Vector3d::UnitZ();
    box[4 * end] = foot + left;
    box[4 * end + 1] = foot - left;
    box[4 * end + 2] = head - left;
    box[4 * end + 3] = head + left;
  }
  return box;
}

std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> BoxEdges(const std::array<Eigen::Vector3d, 8>& box) {
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    edges.emplace_back(box[i], box[(i + 1) % 4]);
    edges.emplace_back(box[4 + i], box[4 + (i + 1) % 4]);
    edges.emplace_back(box[i], box[4 + i]);
  }
  return edges;
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

std::string Describe(const ClearanceDecision& decision) {
  std::string text = "Building " + std::to_string(decision.object_id);
  if (decision.side >= 0) text += ", side " + std::to_string(decision.side);
  text += std::string(": ") + ToString(decision.verdict);
  if (decision.corridor) {
    text += ", free " + FormatNumber(decision.corridor->free_width_m, 2) + " m wide, " +
            FormatNumber(decision.corridor->free_height_m, 2) + " m high";
  }
  return text + " (" + decision.reason + ")";
}

}  // namespace soffit
