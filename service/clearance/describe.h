#pragma once

#include <string>

#include "service/clearance/clearance.h"

namespace soffit {

/// "Building 3, side 0: CLEAR: free: 1.65 m wide, 1.50 m high, least margin 0.21 m (left)".
std::string Describe(const ClearanceDecision& decision);

/// What there is of room, in one line: the free rectangle, the margins, the one that binds, the three
/// distances, and how often the corridor bends. Empty without a corridor.
std::string DescribeRoom(const ClearanceDecision& decision);

}  // namespace soffit
