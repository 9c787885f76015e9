#pragma once

#include "service/solid/boolean.h"
#include "service/solid/solid.h"

namespace soffit {

/// Whether a solid and a prism share any point, surfaces and insides included; exact predicates (CGAL, AABB
/// tree: P. Alliez, S. Tayeb, C. Wormser). A mesh that is not closed meets everything.
bool Meets(const Mesh& solid, const Prism& prism);

/// A vertical cylinder of this radius swept from `from` to `to`, from `bottom_m` to `top_m`, circumscribed by
/// a prism.
Prism SweepCylinder(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius_m, double bottom_m,
                    double top_m);

}  // namespace soffit
