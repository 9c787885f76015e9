#include "test/sim/draw/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace soffit::sim {

using Eigen::Vector2d;

Ring BoxRing(const Vector2d& size_m) {
  const Vector2d half = size_m / 2;
  return {-half, {half.x(), -half.y()}, half, {-half.x(), half.y()}};
}

Ring TeeRing(double width_m, double height_m, double thickness_m) {
  const double w = width_m / 2, h = height_m / 2, t = thickness_m / 2;
  return {{-w, -h}, {w, -h}, {w, -h + 2 * t},  {t, -h + 2 * t},
          {t, h},   {-t, h}, {-t, -h + 2 * t}, {-w, -h + 2 * t}};
}

Ring EllRing(double length_m, double height_m, double foot_m, double stem_m) {
  const double w = length_m / 2, h = height_m / 2;
  return {{-w, -h}, {w, -h}, {w, -h + foot_m}, {-w + stem_m, -h + foot_m}, {-w + stem_m, h}, {-w, h}};
}

Ring MirroredRing(const Ring& ring) {
  Ring mirrored;
  for (auto corner = ring.rbegin(); corner != ring.rend(); ++corner)
    mirrored.emplace_back(-corner->x(), corner->y());
  return mirrored;
}

Part UprightPart(const Ring& outline, double low_m, double high_m) {
  Prism prism;
  prism.section.outer = outline;
  prism.low_m = low_m;
  prism.high_m = high_m;
  return {prism, {}};
}

Part BoxPart(const Vector2d& center_m, const Vector2d& size_m, double low_m, double high_m) {
  Ring ring = BoxRing(size_m);
  for (Vector2d& corner : ring) corner += center_m;
  return UprightPart(ring, low_m, high_m);
}

Part WallPart(const Polygon& elevation, double depth_m) {
  Prism prism;
  prism.section = elevation;
  prism.low_m = -depth_m / 2;
  prism.high_m = depth_m / 2;
  prism.is_lying = true;
  return {prism, {}};
}

Polygon WallWithOpening(double length_m, double height_m, const Opening& opening) {
  constexpr int kArcSteps = 24;
  const double half = length_m / 2;
  Ring edge = {{opening.left_m, opening.low_m}};  // From the lower left over the top to the lower right.
  if (opening.is_round) {
    const double radius_m = (opening.right_m - opening.left_m) / 2,
                 middle_m = (opening.right_m + opening.left_m) / 2;
    for (int i = 0; i <= kArcSteps; ++i) {
      const double angle = std::numbers::pi * (1.0 - static_cast<double>(i) / kArcSteps);
      edge.emplace_back(middle_m + radius_m * std::cos(angle),
                        opening.high_m - radius_m + radius_m * std::sin(angle));
    }
  } else {
    edge.emplace_back(opening.left_m, opening.high_m);
    edge.emplace_back(opening.right_m, opening.high_m);
  }
  edge.emplace_back(opening.right_m, opening.low_m);
  Polygon wall;
  if (opening.low_m > 0.0) {
    wall.outer = {{-half, 0}, {half, 0}, {half, height_m}, {-half, height_m}};
    wall.holes = {edge};
  } else {
    wall.outer = {{-half, 0}};
    wall.outer.insert(wall.outer.end(), edge.begin(), edge.end());
    wall.outer.insert(wall.outer.end(), {{half, 0}, {half, height_m}, {-half, height_m}});
  }
  return wall;
}

std::vector<Part> TableParts(const Vector2d& size_m, double leg_m, double free_m, double height_m) {
  std::vector<Part> parts;
  const Vector2d leg(leg_m, leg_m), corner = (size_m - leg) / 2;
  for (const double x : {-corner.x(), corner.x()}) {
    for (const double y : {-corner.y(), corner.y()}) parts.push_back(BoxPart({x, y}, leg, 0.0, free_m));
  }
  parts.push_back(BoxPart(Vector2d::Zero(), size_m, free_m, height_m));
  return parts;
}

std::vector<Part> SlantedParts(const Vector2d& size_m, double slant_rad, const Opening& opening,
                               double height_m) {
  const Vector2d half = size_m / 2;
  const double lean_m = half.y() * std::tan(slant_rad);
  const double middle_m = (opening.left_m + opening.right_m) / 2;
  const double reach_m = (opening.right_m - opening.left_m) / 2 / std::cos(slant_rad);
  const double left_m = middle_m - reach_m, right_m = middle_m + reach_m;
  const Ring left = {-half, {left_m - lean_m, -half.y()}, {left_m + lean_m, half.y()}, {-half.x(), half.y()}};
  const Ring right = {
      {right_m - lean_m, -half.y()}, {half.x(), -half.y()}, half, {right_m + lean_m, half.y()}};
  return {UprightPart(left, 0.0, opening.high_m), UprightPart(right, 0.0, opening.high_m),
          BoxPart(Vector2d::Zero(), size_m, opening.high_m, height_m)};
}

std::vector<Part> EllWithPassage(const Ring& ell, double foot_m, double stem_m, const Opening& opening,
                                 double height_m) {
  const Vector2d low = ell[0], high(ell[1].x(), ell[4].y());
  const double inner_y = low.y() + foot_m, inner_x = low.x() + stem_m;
  const Ring left = {low,
                     {opening.left_m, low.y()},
                     {opening.left_m, inner_y},
                     {inner_x, inner_y},
                     {inner_x, high.y()},
                     {low.x(), high.y()}};
  const Ring right = {
      {opening.right_m, low.y()}, {high.x(), low.y()}, {high.x(), inner_y}, {opening.right_m, inner_y}};
  return {UprightPart(left, 0.0, opening.high_m), UprightPart(right, 0.0, opening.high_m),
          UprightPart(ell, opening.high_m, height_m)};
}

}  // namespace soffit::sim
