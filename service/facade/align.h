#pragma once

#include <vector>

#include "service/facade/facade.h"

namespace soffit {

/// A building and the pictures of it, adjusted to each other.
struct Alignment {
  Footprint footprint;        ///< With corners, height and the views of its silhouettes as adjusted.
  std::vector<Sight> sights;  ///< With adjusted views; those that do not show the building are as they were.
};

/// Adjusts the corners and the height of a building and the poses of all pictures that show it at once, so
/// that its silhouette falls on what the pictures show of it: on the structure in horizontal ones, on the
/// traced outlines in those from above (bundle adjustment over edges: D. Lowe, Fitting Parameterized
/// Three-Dimensional Models to Images, 1991). Least squares on distances in the picture, with the reported
/// standard deviations of the poses as priors; poses are eliminated one by one. The building's standard
/// deviations are those in the map, those of the adjusted views are relative to the building. What does not
/// converge is returned as it was. Where the height is not known well, or not at all, it is tried from many,
/// and the result with most of its edges in the pictures is taken. Pure.
Alignment AlignSights(const Footprint& object, const std::vector<Mask>& masks,
                      const std::vector<Sight>& sights, const FacadeOptions& options);

}  // namespace soffit
