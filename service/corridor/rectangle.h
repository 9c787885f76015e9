#pragma once

#include <optional>

#include "shared/geometry/polygon.h"

namespace soffit {

struct Rectangle {
  double left = 0.0, right = 0.0, bottom = 0.0, top = 0.0;
};

/// The upright rectangle inside an x-monotone polygon that is best relative to a need: the largest k for
/// which k width x k height fits, then as high and as wide as it can be. Exact but for the bisection (1e-8 of
/// the size). None when the polygon is empty.
std::optional<Rectangle> FitRectangle(const Ring& ring, double width, double height);

}  // namespace soffit
