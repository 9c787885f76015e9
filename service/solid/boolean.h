#pragma once

#include <compare>
#include <utility>
#include <vector>

#include "service/solid/solid.h"

namespace soffit {

/// A planar polygon swept along a straight line: `origin + a x_axis + b y_axis + t sweep`, t from 0 to 1.
struct Prism {
  Ring ring;  ///< Counter-clockwise seen against `x_axis` x `y_axis`, simple.
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d x_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d y_axis = Eigen::Vector3d::UnitY();
  Eigen::Vector3d sweep_m = Eigen::Vector3d::UnitZ();
};

/// Polygons with as many corners, each joined to the next by straight lines from corner to corner; the first
/// is counter-clockwise seen from outside. Where four corners are not in one plane, two triangles fill the
/// side.
struct Tube {
  explicit Tube(std::vector<std::vector<Eigen::Vector3d>> rings) : rings_m(std::move(rings)) {}
  Tube(const Prism& prism);  // NOLINT(google-explicit-constructor): every prism is one.

  std::vector<std::vector<Eigen::Vector3d>> rings_m;
};

/// Which polygon of which tube a triangle lies on.
struct Origin {
  std::size_t tube = 0;   ///< 0: the body; else a cut, counted from 1.
  std::size_t piece = 0;  ///< Of a side: between which rings it lies. Of an end: which of the two.
  int side = -1;          ///< On the ring's corners `side` and the next; -1: an end.
  auto operator<=>(const Origin&) const = default;
};

struct Difference : Mesh {
  std::vector<Origin> origins;  ///< Of each triangle.
};

/// Whether it encloses a volume and does not cross itself.
bool IsSound(const Tube& tube);

/// `body` less all `cuts`, by corefinement with exact constructions (CGAL, Polygon Mesh Processing: S. Loriot
/// et al.). An error when one is degenerate or the difference is not a solid.
Result<Difference> Subtract(const Tube& body, const std::vector<Tube>& cuts);

}  // namespace soffit
