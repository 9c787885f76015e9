#pragma once

#include <vector>

#include "service/clearance/clearance.h"
#include "service/edge/ros/ros_types.h"

namespace soffit::ros {

/// Each pose looks along the way to the next one, the last as the one before. No points: a path without
/// poses.
Path_ MakePath(std::int64_t stamp_utc_ns, const std::vector<Eigen::Vector3d>& points_in_map_m);

/// Entry and exit of the first corridor that is CLEAR; without any a path without poses, so that nobody
/// follows an earlier one.
Path_ MakeCorridorPath(std::int64_t stamp_utc_ns, const std::vector<ClearanceDecision>& decisions);

}  // namespace soffit::ros
