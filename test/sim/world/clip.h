#pragma once

#include <cstddef>

namespace soffit::sim {

/// The part of a convex polygon with `axis` . p >= `least`.
template <class Points, class Axis>
Points Clip(const Points& polygon, const Axis& axis, double least) {
  Points kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& p = polygon[i];
    const auto& q = polygon[(i + 1) % polygon.size()];
    const double at_p = axis.dot(p) - least, at_q = axis.dot(q) - least;
    if (at_p >= 0.0) kept.push_back(p);
    if ((at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0))
      kept.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
  return kept;
}

}  // namespace soffit::sim
