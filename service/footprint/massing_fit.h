#pragma once

#include <limits>

#include "service/footprint/footprint.h"
#include "service/footprint/wireframe.h"

namespace soffit {

/// What is known of a height before the pictures are looked at.
struct HeightPrior {
  double value_m = 0.0;
  double std_m = std::numeric_limits<double>::infinity();  ///< 0: it is that height.
};

/// A building as silhouettes show it.
struct MassingFit {
  Polygon polygon;                   ///< `outer` is empty when nothing fits.
  std::vector<double> corner_std_m;  ///< For each corner of the outer ring, per axis.
  double height_m = 0.0;
  double height_std_m = 0.0;
  std::vector<Level> levels;  ///< One, with plumb walls, unless others were asked for.
  std::vector<View> views;    ///< As adjusted, one for each silhouette; deviations relative to the building.
  double explained_ratio = 0.0;  ///< Share of the outlines that is near the building's.
  double cost = std::numeric_limits<double>::infinity();  ///< Half of chi squared, and a price for each
                                                          ///< corner, inset and level.
};

/// Fits footprint, height and camera poses together to what silhouettes show.
///
/// The outline of a building in a picture is made of those of its edges that have it on one side only. Points
/// of the traced outlines are drawn to the edge of the predicted outline that is nearest and runs the same
/// way (Gauss-Newton on distances in pixels, robust: S. Geman and D. McClure, 1987); poses are held by their
/// standard deviations. What is left over of walls and roofs in the start's ring, corners that the outlines
/// do not need, is taken out as long as that makes the whole cheaper (minimum description length).
///
/// @param start  Valid; its corners are near the footprint's, and there are no fewer of them than it has.
/// @param prior  A height below all cameras, from which the fit starts.
/// Outlines that are cut count as far as they go; those that others dent (openings, neighbours) up to a
/// bound. Pure.
MassingFit FitPrism(const std::vector<Silhouette>& silhouettes, const Polygon& start,
                    const HeightPrior& prior);

/// The same with all corners of the start, and half as exact: to compare starts.
MassingFit FitRoughly(const std::vector<Silhouette>& silhouettes, const Polygon& start,
                      const HeightPrior& prior);

/// The same for a building with levels, as any pictures show it, from above or from beside. Its heights and
/// insets are fitted too, and those that the outlines do not need are taken out.
MassingFit FitMassing(const std::vector<Silhouette>& silhouettes, const Massing& start);

}  // namespace soffit
