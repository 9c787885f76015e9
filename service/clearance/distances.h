#pragma once

#include <vector>

#include "service/scene/scene.h"
#include "shared/flight/flight.h"

namespace soffit {

/// How near the body of a vehicle comes to things on its path, without any margin. 0: it touches them.
struct Distances {
  double to_occupied_m = 0.0;  ///< To an occupied voxel of the OctoMap.
  double to_unknown_m = 0.0;   ///< To one, above the ground, that nothing is known of.
  double to_surface_m = 0.0;   ///< To the surface of a model.
};

/// Exact to 5 mm for the models, and as exact as the voxels are for the others. What is farther away
/// than `reach_m` counts as that.
///
/// @param path_in_map_m  Level; two points at least.
Distances MeasureDistances(const Scene& scene, const std::vector<Eigen::Vector3d>& path_in_map_m,
                           const VehicleEnvelope& vehicle, double reach_m);

}  // namespace soffit
