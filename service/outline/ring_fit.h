#pragma once

#include <vector>

#include "shared/geometry/polygon.h"

namespace soffit {

/// A polygon drawn through the boundary of a region.
struct FittedRing {
  Ring ring;                       ///< Simple, orientation as the boundary's; empty when there is none.
  std::vector<double> corner_std;  ///< For each corner.
  double roughness = 0.0;          ///< Root mean square of the distances of the boundary from its sides.
};

/// The polygon that explains a boundary best with few sides: breakpoints minimise the squared distances to
/// total least squares lines plus a price for each side (dynamic programming over Douglas-Peucker candidates,
/// as in J. Perez and E. Vidal, "Optimum polygonal approximation of digitized curves", PRL 15, 1994); corners
/// are the intersections of neighbouring sides. Three or more sides that a part of a circle or an ellipse
/// explains no worse are drawn as such: as chords from which it bulges by a third of `tolerance`. `boundary`
/// may be a staircase; `step` is the distance at which it is sampled (1 for a bitmap), `tolerance` how far
/// the sides may pass from it. Pure; O(length + candidates^2).
FittedRing FitRing(const Ring& boundary, double step, double tolerance);

/// The corners through the middles of the pixel sides of a staircase, without those that lie nearer than
/// `tolerance_px` to the ring of the others: as near to the truth as pixels tell, everywhere, but rough.
/// Pure.
Ring ThinRing(const Ring& staircase, double tolerance_px);

}  // namespace soffit
