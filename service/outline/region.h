#pragma once

#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "shared/geometry/polygon.h"

namespace soffit {

/// 4-connected pixels that have the same label.
struct Region {
  std::uint8_t label = 0;
  Polygon boundary;  ///< Exact: a staircase along the sides of pixels.
};

/// The regions of all labels but 0, by decreasing area. Pixel centres are at integer coordinates, so corners
/// lie at halves. x right, y down; outer rings have SignedArea > 0 and holes < 0 in these coordinates. A ring
/// may touch itself in a corner where pixels meet diagonally. Regions and holes of less than `min_area_px`
/// are left out, and all but the `max_regions` greatest regions.
///
/// Runs of equal labels are joined row by row (L. He, Y. Chao and K. Suzuki, "A run-based two-scan labeling
/// algorithm", IEEE TIP 17(5), 2008), so that the cost beyond reading the labels is that of the boundaries.
/// Pure.
std::vector<Region> TraceRegions(const cv::Mat1b& labels, double min_area_px,
                                 std::size_t max_regions = std::numeric_limits<std::size_t>::max());

}  // namespace soffit
