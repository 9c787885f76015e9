#include "service/edge/live/findings.h"

#include <cmath>
#include <numbers>

namespace soffit {
namespace {

/// An obstacle seen from above, as something to keep off and to fly over: an octagon around it.
Footprint FootprintOf(const Obstacle& obstacle) {
  constexpr int kCorners = 8;
  const double radius_m = (obstacle.radius_m + 3.0 * obstacle.std_m) / std::cos(std::numbers::pi / kCorners);
  Footprint footprint;
  for (int i = 0; i < kCorners; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kCorners;
    footprint.polygon_in_map_m.outer.push_back(obstacle.base_in_map_m.head<2>() +
                                               radius_m *
                                                   Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)));
  }
  footprint.height_m = obstacle.base_in_map_m.z() + obstacle.height_m;
  return footprint;
}

}  // namespace

Findings MakeFindings(const Understanding& understanding) {
  Findings findings;
  findings.scene_revision = understanding.scene.revision;
  for (const SceneObject& object : understanding.scene.objects) {
    findings.map.push_back(object.footprint);
    if (object.is_matched) findings.wanted.push_back(object.footprint.object_id);
  }
  for (const auto* things : {&understanding.scene.obstacles, &understanding.scene.clutter}) {
    for (const Obstacle& thing : *things) findings.map.push_back(FootprintOf(thing));
  }
  findings.is_ambiguous = !understanding.matches.empty() && findings.wanted.empty();
  findings.decisions = understanding.decisions;
  findings.problems = understanding.problems;
  return findings;
}

}  // namespace soffit
