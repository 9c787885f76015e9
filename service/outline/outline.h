#pragma once

#include <string>
#include <vector>

#include "service/mask/mask.h"
#include "shared/geometry/polygon.h"
#include "shared/options/options.h"

namespace soffit {

/// Boundary of one blob of one colour in the picture. Pixels, x right, y down; sub-pixel.
struct Outline {
  std::string color;
  Polygon polygon_px;  ///< Outer ring counter-clockwise when y is taken as up, so SignedArea > 0.
  std::vector<double> corner_std_px;  ///< For each corner of the outer ring.
  bool is_cut = false;                ///< Touches the edge of what the picture shows.
};

struct OutlineOptions {
  double min_area_px = 300.0;
  double simplify_px = 1.5;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("min_area_px", self.min_area_px,
          OptionInfo{1.0, 1e7, "px2", "Smaller blobs and holes are dropped"});
    field("simplify_px", self.simplify_px,
          OptionInfo{0.2, 50.0, "px", "Greatest distance of a side from the boundary"});
  }
};

/// Polygons with holes around the blobs of a mask, by decreasing area; empty when there are none. Every ring
/// is simple. Sides are fitted to the boundary by total least squares, corners are their intersections. Pure.
std::vector<Outline> TraceOutlines(const Mask& mask, const cv::Rect& seen, const OutlineOptions& options);

}  // namespace soffit
