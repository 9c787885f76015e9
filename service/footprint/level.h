#pragma once

#include <vector>

#include "shared/geometry/polygon.h"

namespace soffit {

/// One height of a building, and how far each side of its footprint stands back from there, at right angles
/// to the side.
struct Level {
  double height_m = 0.0;
  std::vector<double> inset_m;  ///< For each side of the outer ring (corner i to i + 1); at least 0.
};

/// The outline of a building where its sides stand back by `inset_m`: corner i is where side i - 1 and side i
/// meet then. `inset_m` has an entry for each side of `outer`.
Ring InsetRing(const Ring& outer, const std::vector<double>& inset_m);

/// The share, from 0 to 1, of the way from insets `from_m` to insets `to_m` at which no side has turned round
/// yet. At 1 all of the way can be gone; where a roof has a ridge, sides end as points.
double LargestShare(const Ring& outer, const std::vector<double>& from_m, const std::vector<double>& to_m);

/// How far side `side` stands back at this height, between the levels and on the ground (0). `levels` rise.
double InsetAt(const std::vector<Level>& levels, std::size_t side, double height_m);

}  // namespace soffit
