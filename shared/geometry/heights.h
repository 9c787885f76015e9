#pragma once

#include <limits>

#include "shared/geometry/polygon.h"

namespace soffit {

/// Numbers from `low` to `high`; as it is made, none.
struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  double Length() const { return high - low; }
  void Include(double value);
};

/// Lowest and highest point at x = `u` of an outline that no upright line enters twice; empty beside it.
Span HeightsAt(const Ring& ring, double u);

}  // namespace soffit
