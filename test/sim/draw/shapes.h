#pragma once

#include <vector>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// Outlines about the origin, counter-clockwise.
Ring BoxRing(const Eigen::Vector2d& size_m);
Ring TeeRing(double width_m, double height_m, double thickness_m);
Ring EllRing(double length_m, double height_m, double foot_m,
             double stem_m);          ///< Foot along x at the bottom, stem at the left.
Ring MirroredRing(const Ring& ring);  ///< About the y axis.

Part UprightPart(const Ring& outline, double low_m, double high_m);
Part BoxPart(const Eigen::Vector2d& center_m, const Eigen::Vector2d& size_m, double low_m, double high_m);

/// A wall's elevation, symmetric about z, pushed through `depth_m` along y.
Part WallPart(const Polygon& elevation, double depth_m);

/// Where an opening is in an elevation: `left_m` and `right_m` of the middle, `low_m` above ground, `high_m`
/// its top; round-headed: the head is a half circle below `high_m`.
struct Opening {
  double left_m = 0.0;
  double right_m = 0.0;
  double low_m = 0.0;
  double high_m = 0.0;
  bool is_round = false;
};
Polygon WallWithOpening(double length_m, double height_m, const Opening& opening);

std::vector<Part> TableParts(const Eigen::Vector2d& size_m, double leg_m, double free_m, double height_m);

/// A box with a passage below `opening.high_m` that leads through it turned by `slant_rad` from y towards x,
/// as wide across itself as the opening and in the middle where that is.
std::vector<Part> SlantedParts(const Eigen::Vector2d& size_m, double slant_rad, const Opening& opening,
                               double height_m);

/// An L of which the foot has a passage from `left_m` to `right_m` below `free_m`.
std::vector<Part> EllWithPassage(const Ring& ell, double foot_m, double stem_m, const Opening& opening,
                                 double height_m);

}  // namespace soffit::sim
