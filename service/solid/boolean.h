#pragma once

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

/// `body` less all `cuts`, by corefinement with exact constructions (CGAL, Polygon Mesh Processing: S. Loriot
/// et al.). An error when a prism is degenerate or the difference is not a solid.
Result<Mesh> Subtract(const Prism& body, const std::vector<Prism>& cuts);

}  // namespace soffit
