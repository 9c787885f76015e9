#pragma once

#include <vector>

#include "service/clearance/clearance.h"
#include "shared/geometry/polygon.h"

namespace soffit {

Ring3 Lift(const Ring& ring, double height_m);

/// The wall over side `side` from the ground to `height_m`, counter-clockwise seen from outside of the ring.
Ring3 WallOver(const Ring& ring, std::size_t side, double height_m);

/// Newell's normal, unit length.
Eigen::Vector3d PolygonNormal(const Ring3& ring);

/// The decisions whose corridors are drawn: those with a corridor that has a free width, CLEAR ones first,
/// and of the two directions of the same corridor only one.
std::vector<ClearanceDecision> ChooseShownDecisions(const std::vector<ClearanceDecision>& decisions);

}  // namespace soffit
