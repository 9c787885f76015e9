#pragma once

#include <octomap/OcTree.h>

#include "service/edge/ros/ros_types.h"

namespace soffit::ros {

/// What octomap_msgs' conversions read back: `octree` with occupied, free and unknown alone, or with the
/// probability of each voxel. An empty tree has no data.
Octomap_ MakeBinaryOctomap(const octomap::OcTree& octree, std::int64_t stamp_utc_ns);
Octomap_ MakeFullOctomap(const octomap::OcTree& octree, std::int64_t stamp_utc_ns);

}  // namespace soffit::ros
