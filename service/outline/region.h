#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "shared/geometry/polygon.h"

namespace soffit {

/// The exact boundaries of the 4-connected regions of non-zero pixels, by decreasing area: staircases along the sides
/// of pixels (pixel centres are at integer coordinates, so corners lie at halves). x right, y down; outer rings have
/// SignedArea > 0 and holes < 0 in these coordinates. A ring may touch itself in a corner where pixels meet
/// diagonally. Regions and holes of less than `min_area_px` are left out. Pure; O(pixels).
std::vector<Polygon> TraceRegions(const cv::Mat1b& bitmap, double min_area_px);

}  // namespace soffit
