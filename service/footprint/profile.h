#pragma once

#include <Eigen/Core>
#include <optional>

#include "service/footprint/footprint.h"

namespace soffit {

inline constexpr double kFootShare = 0.12;  ///< Of a building's height: up to there walls hardly stand back.
inline constexpr double kSideCosine = 0.9;  ///< Between the normal of a wall that is at the end of a profile
                                            ///< and the picture's horizontal; at least.

/// One level picture's outline of a building as an elevation: on the upright plane before the building that
/// faces the camera, where its nearest wall is.
struct Profile {
  Eigen::Vector2d right = Eigen::Vector2d::UnitX();  ///< In the map, along the picture.
  Eigen::Vector2d camera_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d middle_m = Eigen::Vector2d::Zero();
  Ring outline;  ///< (to the right of the middle, up).
  double turn_std_rad = 0.0;

  double Top() const;
  /// The extent at a height, of all parts; none above the top.
  std::optional<Eigen::Vector2d> Extent(double height_m) const;
};

/// None when the outline reaches to where the camera does not look level, or the camera is not before it.
///
/// @param drawn  Where the building stands, roughly.
std::optional<Profile> Elevate(const Silhouette& silhouette, const Ring& drawn);

}  // namespace soffit
