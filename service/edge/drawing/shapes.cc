#include "service/edge/drawing/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "service/clearance/describe.h"
#include "shared/result/say.h"

namespace soffit {

Ring3 Lift(const Ring& ring, double height_m) {
  Ring3 lifted;
  for (const Eigen::Vector2d& corner : ring) lifted.emplace_back(corner.x(), corner.y(), height_m);
  return lifted;
}

Ring3 Circle(const Eigen::Vector3d& center, double radius_m) {
  constexpr int kCorners = 24;
  Ring3 circle;
  for (int i = 0; i <= kCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCorners;
    circle.push_back(center + radius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0));
  }
  return circle;
}

std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> Creases(const Mesh& mesh) {
  constexpr double kFlat = 0.97;
  std::map<std::pair<int, int>, Eigen::Vector3d> normals;
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> creases;
  const auto& vertices = mesh.vertices_in_map_m;
  for (const auto& triangle : mesh.triangles) {
    const auto at = [&](int i) {
      return vertices[static_cast<std::size_t>(triangle[static_cast<std::size_t>(i)])];
    };
    const Eigen::Vector3d normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (int i = 0; i < 3; ++i) {
      const int a = triangle[static_cast<std::size_t>(i)];
      const int b = triangle[static_cast<std::size_t>((i + 1) % 3)];
      const auto [entry, is_first] = normals.try_emplace(std::minmax({a, b}), normal);
      if (!is_first && entry->second.dot(normal) < kFlat) creases.emplace_back(at(i), at((i + 1) % 3));
    }
  }
  return creases;
}

Eigen::Vector3d PolygonNormal(const Ring3& ring) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    normal += (ring[i] - ring.front()).cross(ring[(i + 1) % ring.size()] - ring.front());
  }
  return normal.normalized();
}

std::vector<std::string> DescribeDecisions(const Understanding& all) {
  std::vector<std::string> lines;
  for (const ClearanceDecision& decision : all.decisions) {
    lines.push_back(Describe(decision));
    if (!decision.wanted) continue;
    const Viewpoint& wanted = *decision.wanted;
    lines.push_back(Say("A picture would settle it, from ",
                        SayPlace(all.scene.map_origin_m + wanted.position_in_map_m),
                        wanted.reason.empty() ? "" : ": ", wanted.reason));
  }
  for (const ClearanceDecision& decision : ChooseShownDecisions(all.decisions))
    lines.push_back(Say("Side ", decision.side, ": ", DescribeRoom(decision)));
  return lines;
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
