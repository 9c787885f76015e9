#pragma once

#include <vector>

#include "service/clearance/clearance.h"
#include "service/edge/ros/ros_types.h"
#include "service/scene/scene.h"

namespace soffit::ros {

/// The enriched scene as any viewer of markers draws it. The first marker deletes all earlier ones.
/// Namespaces: `footprints` (lines on the ground and at roof height), `models` (triangles), `openings`
/// (lines; through: green), `obstacles` (cylinders), `corridors` (the free rectangle, swept), `decisions`
/// (text above the building: verdict and reason). CLEAR is green, BLOCKED red, INSUFFICIENT_DATA amber.
MarkerArray_ MakeSceneMarkers(std::int64_t stamp_utc_ns, const Scene& scene,
                              const std::vector<ClearanceDecision>& decisions);

/// The occupied voxels as cubes, one list for each size of them: a viewer needs no OctoMap.
MarkerArray_ MakeVoxelMarkers(std::int64_t stamp_utc_ns, const octomap::OcTree& octree);

}  // namespace soffit::ros
