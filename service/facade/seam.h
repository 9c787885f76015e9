#pragma once

#include <opencv2/core.hpp>

#include "service/facade/elevation.h"

namespace soffit {

/// Where a wall ends, its colour and that of what is behind it mix in a narrow seam that is neither. The true
/// edge is where they have equal shares: 0 in the cells that are not labelled as the wall and yet coloured
/// more like it, 255 elsewhere. What is no mixture of the two stays 255. Size of the elevation.
cv::Mat1b SplitSeams(const Elevation& view);

}  // namespace soffit
