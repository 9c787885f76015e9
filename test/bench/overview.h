#pragma once

#include <vector>

#include "shared/capture/capture.h"
#include "shared/geometry/polygon.h"

namespace soffit::bench {

/// A 4:3 picture straight down, as JPEG: painted boxes in any direction on textured ground, with sensor
/// noise. The same number of boxes at any size. With `has_lens`, its lens distorts by about as much as that
/// of a small drone.
Capture MakeOverview(int width_px, bool has_lens);

/// `count` buildings, no two alike: rectangles with up to three corners cut out, in any direction.
std::vector<Polygon> MakeVectorMap(std::size_t count);

}  // namespace soffit::bench
