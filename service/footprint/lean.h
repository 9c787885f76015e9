#pragma once

#include <optional>
#include <vector>

#include "service/footprint/footprint.h"

namespace soffit {

/// Perspective of plumb walls and a level roof, seen from a camera at height H over the point c of the
/// ground. On the ground plane the roof of a building of height h appears scaled about c by s = H / (H - h),
/// and every corner between two walls as a side of the silhouette that runs radially from v to c + s (v - c).
namespace lean {

struct Estimate {
  double value = 0.0;
  double std = 0.0;
};

/// The footprint under a silhouette for a building of this height (0: the silhouette on the ground itself).
/// Roof edges go back towards c, base edges stay, wall corners vanish; a ring that would cross itself is
/// taken for roof altogether. `outer` is empty when the silhouette reaches above the horizon.
Polygon Straighten(const Silhouette& silhouette, double height_m);

/// The height that the wall corners in the silhouette tell, if there are any.
std::optional<Estimate> HeightFromCorners(const Silhouette& silhouette, double max_height_m);

/// The height at which the silhouettes show the same footprint, given what wall corners tell (`priors`). Cut
/// ones count as far as they go.
std::optional<Estimate> HeightFromParallax(const std::vector<Silhouette>& silhouettes,
                                           const std::vector<Estimate>& priors, double max_height_m);

/// Metres on the ground per pixel, at the middle of the silhouette.
double GroundSampling_m(const Silhouette& silhouette);

}  // namespace lean
}  // namespace soffit
