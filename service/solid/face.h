#pragma once

#include <vector>

#include "service/solid/boolean.h"
#include "service/solid/solid.h"

namespace soffit {

/// What the faces that a cut leaves belong to: `wall` and `opening` of Face.
struct Inside {
  int wall = -1;
  int opening = -1;
};

/// The faces of a body, whose side i is wall i, less its cuts. Each is what hangs together of one polygon.
///
/// @param cuts  What each of them leaves.
std::vector<Face> GatherFaces(const Difference& mesh, const std::vector<Inside>& cuts);

/// Unit, outward.
Eigen::Vector3d NormalOf(const Mesh& mesh, std::size_t triangle);

/// The edge of a face: its outer ring, counter-clockwise seen from outside, then its holes, clockwise.
std::vector<Ring3> OutlineOf(const Mesh& mesh, const Face& face);

}  // namespace soffit
