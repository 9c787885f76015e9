#pragma once

#include <Eigen/Core>
#include <vector>

namespace soffit {

/// Corners in order, not closed (the last corner is not the first again). Unit: that of the coordinates.
using Ring = std::vector<Eigen::Vector2d>;
using Ring3 = std::vector<Eigen::Vector3d>;

/// A region of the plane: the inside of `outer` without the insides of `holes`.
/// Valid when every ring is simple with n >= 3, `outer` counter-clockwise (in a y-up frame) and holes
/// clockwise.
struct Polygon {
  Ring outer;
  std::vector<Ring> holes;
};

double SignedArea(const Ring& ring);  ///< Positive for counter-clockwise, in a y-up frame.
double Area(const Polygon& polygon);  ///< Holes taken off.
double Perimeter(const Ring& ring);
Eigen::Vector2d Centroid(const Polygon& polygon);               ///< Of the area, holes taken off.
bool Contains(const Ring& ring, const Eigen::Vector2d& point);  ///< Even-odd; the boundary is undefined.
bool Contains(const Polygon& polygon, const Eigen::Vector2d& point);
double DistanceToSegment(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
double DistanceToRing(const Eigen::Vector2d& point, const Ring& ring);  ///< To the nearest side, >= 0.
/// Whether a segment goes through a side of the ring; one that only touches it does not.
bool Crosses(const Ring& ring, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
/// Between a segment and the area within a ring; 0 when they meet.
double DistanceToSegment(const Ring& ring, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
bool IsSimple(const Ring& ring);  ///< No two sides meet but neighbours at their corner. O(n^2).
std::vector<Eigen::Vector2d> GridOver(const Ring& ring);      ///< 24 x 24 points all over its bounding box.
double ShareInside(const Ring& inner, const Ring& outer);     ///< Of the area of `inner`, told by GridOver().
Ring ConvexHull(const std::vector<Eigen::Vector2d>& points);  ///< Counter-clockwise, no collinear corners.

}  // namespace soffit
