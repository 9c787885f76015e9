#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "service/clearance/clearance.h"
#include "shared/geometry/polygon.h"

namespace soffit {

Ring3 Lift(const Ring& ring, double height_m);

/// The wall over side `side` from the ground to `height_m`, counter-clockwise seen from outside of the ring.
Ring3 WallOver(const Ring& ring, std::size_t side, double height_m);

/// Newell's normal, unit length.
Eigen::Vector3d PolygonNormal(const Ring3& ring);

/// The free space of a corridor from entry to exit: four corners at the entry, four at the exit, each
/// counter-clockwise seen along the way back.
std::array<Eigen::Vector3d, 8> CorridorBox(const Corridor& corridor);

std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> BoxEdges(const std::array<Eigen::Vector3d, 8>& box);

/// The decisions whose corridors are drawn: those with a corridor that has a free width, CLEAR ones first,
/// and of the two directions of the same corridor only one.
std::vector<ClearanceDecision> ChooseShownDecisions(const std::vector<ClearanceDecision>& decisions);

/// "Building 3, side 0: CLEAR, free 1.65 m wide, 1.50 m high (reason)".
std::string Describe(const ClearanceDecision& decision);

}  // namespace soffit
