#pragma once

#include <vector>

#include "service/facade/facade.h"

namespace soffit {

/// A building and the horizontal pictures of it, adjusted to each other.
struct Alignment {
  Footprint footprint;  ///< With the height that the walls' upper edges show, drawn again for it and moved.
  std::vector<Sight> sights;  ///< With adjusted views; those that do not show the building are as they were.
};

/// Adjusts the poses of the sights, the building's height and its place so that the building's outline (wall
/// bases, upper edges, upright corners) falls on the outline that the pictures show: least squares on
/// distances in the picture, with the reported standard deviations of the poses as priors. The common shift
/// of all pictures is shared between them and the building by their number, which makes its place better than
/// that of any single pose. The standard deviations of the adjusted views are those relative to the building.
/// Pure.
Alignment AlignSights(const Footprint& object, const std::vector<Mask>& masks,
                      const std::vector<Sight>& sights, const FacadeOptions& options);

}  // namespace soffit
