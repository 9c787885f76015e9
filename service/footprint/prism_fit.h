#pragma once

#include <limits>

#include "service/footprint/footprint.h"

namespace soffit {

/// What is known of a height before the pictures are looked at.
struct HeightPrior {
  double value_m = 0.0;
  double std_m = std::numeric_limits<double>::infinity();  ///< 0: it is that height.
};

/// A building with plumb walls and a level roof, as silhouettes show it.
struct PrismFit {
  Polygon polygon;  ///< `outer` is empty when nothing fits.
  std::vector<double>
      corner_std_m;  ///< For each corner of the outer ring: of its place in the map, per axis.
  double height_m = 0.0;
  double height_std_m = 0.0;
  double explained_ratio = 0.0;  ///< Share of the outlines that is near the prism's.
  double cost =
      std::numeric_limits<double>::infinity();  ///< Half of chi squared, and a price for each corner.
};

/// Fits footprint, height and camera poses together to what silhouettes show.
///
/// The outline of a prism in a picture is made of edges of its foot, edges of its roof and upright edges.
/// Points of the traced outlines are drawn to the edge of the predicted outline that is nearest and runs the
/// same way (Gauss-Newton on distances in pixels, robust: S. Geman and D. McClure, 1987); poses are held by
/// their standard deviations. What is left over of walls and roofs in the start's ring, corners that the
/// outlines do not need, is taken out as long as that makes the whole cheaper (minimum description length).
///
/// @param start  Valid; its corners are near the footprint's, and there are no fewer of them than it has.
/// @param prior  A height below all cameras, from which the fit starts.
/// Outlines that are cut count as far as they go; those that others dent (openings, neighbours) up to a
/// bound. Pure.
PrismFit FitPrism(const std::vector<Silhouette>& silhouettes, const Polygon& start, const HeightPrior& prior);

/// The same with all corners of the start, and half as exact: to compare starts.
PrismFit FitRoughly(const std::vector<Silhouette>& silhouettes, const Polygon& start,
                    const HeightPrior& prior);

}  // namespace soffit
