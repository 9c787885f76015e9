#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "shared/geometry/polygon.h"

namespace soffit::sim {

/// Corner triples, counter-clockwise, that tile the polygon exactly (constrained Delaunay triangulation by
/// GEOS).
/// @throws std::runtime_error  the polygon is not valid.
std::vector<std::array<Eigen::Vector2d, 3>> Triangulate(const Polygon& polygon);

/// The polygon itself when it is valid, else what its sides enclose an odd number of times, as valid
/// polygons: a spike vanishes, a figure of eight becomes two.
std::vector<Polygon> MakeValid(const Polygon& polygon);

/// The union of triangles (in any orientation; flat ones are ignored) as polygons without collinear corners,
/// largest first. Gaps and spikes below 1e-6 vanish.
std::vector<Polygon> Union(const std::vector<std::array<Eigen::Vector2d, 3>>& triangles);

}  // namespace soffit::sim
