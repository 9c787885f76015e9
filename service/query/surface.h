#pragma once

#include <cstdint>
#include <optional>

#include "service/scene/scene.h"

namespace soffit {

/// From a point to the nearest surface of any model.
struct SurfaceDistance {
  double signed_m = 0.0;  ///< Negative inside the model.
  Eigen::Vector3d point_in_map_m = Eigen::Vector3d::Zero();
  std::uint32_t object_id = 0;
};

/// Exact on the triangles (closest point: C. Ericson, Real-Time Collision Detection, 5.1.5); the side by the
/// winding number of the closed mesh (A. van Oosterom, J. Strackee, 1983). None within `range_m`. Pure;
/// O(triangles) of the models that are near enough.
std::optional<SurfaceDistance> DistanceToModels(const Scene& scene, const Eigen::Vector3d& from_m,
                                                double range_m);

/// Height of the highest model surface above or below a place; none when no model is there.
std::optional<double> ModelHeightAt(const Scene& scene, const Eigen::Vector2d& place_m);

}  // namespace soffit
