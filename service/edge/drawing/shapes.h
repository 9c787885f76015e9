#pragma once

#include <string>
#include <utility>
#include <vector>

#include "service/pipeline/pipeline.h"
#include "shared/geometry/polygon.h"

namespace soffit {

Ring3 Lift(const Ring& ring, double height_m);

/// A level circle, as a closed line.
Ring3 Circle(const Eigen::Vector3d& center, double radius_m);

/// Edges of a mesh at which its surface bends.
std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> Creases(const Mesh& mesh);

/// Newell's normal, unit length.
Eigen::Vector3d PolygonNormal(const Ring3& ring);

/// What is said of all decisions: each of them, the room of those that are drawn, and what would settle them.
std::vector<std::string> DescribeDecisions(const Understanding& all);

/// The decisions whose corridors are drawn: those with a corridor that has a free width, CLEAR ones first,
/// and of the two directions of the same corridor only one.
std::vector<ClearanceDecision> ChooseShownDecisions(const std::vector<ClearanceDecision>& decisions);

}  // namespace soffit
