#pragma once

#include <optional>
#include <vector>

#include "service/footprint/footprint.h"

namespace soffit {

/// A building that is no plain prism, and the pictures of it, adjusted to each other.
struct Shaping {
  Footprint footprint;             ///< With levels.
  std::vector<Silhouette> beside;  ///< Those of the level pictures that show it, with adjusted views.
};

/// Finds setbacks, wings of different heights, sloped roofs and walls: where level pictures show that the
/// outline of a building stands back from its foot on the way up, the footprint, its levels and the poses of
/// all pictures are fitted together. None when the pictures do not show that it is more than a prism, at
/// least two of them, or when it is described as well (minimum description length) without levels.
///
/// @param beside  Outlines of the level pictures, of any buildings.
/// What stands back behind a part that hides it is not seen and not modelled: the solid is too large there.
/// Pure.
std::optional<Shaping> ShapeBuilding(const Footprint& footprint, const std::vector<Silhouette>& beside);

}  // namespace soffit
