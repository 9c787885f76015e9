#pragma once

#include <utility>
#include <vector>

#include "shared/geometry/polygon.h"

namespace soffit {

/// target = scale * turn(source) + translation, as target = (a -b; b a) source + translation.
struct Similarity {
  double a = 1.0;
  double b = 0.0;
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();

  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const {
    return {a * p.x() - b * p.y() + translation.x(), b * p.x() + a * p.y() + translation.y()};
  }
  double Scale() const { return std::hypot(a, b); }
  double RotationCcw_rad() const { return std::atan2(b, a); }
};

Polygon operator*(const Similarity& similarity, const Polygon& polygon);

/// A shape of the reference and the shape of the map on which it is to be laid.
using ShapePair = std::pair<const Polygon*, const Polygon*>;

/// How closely outlines are looked at.
struct Effort {
  int samples = 128;  ///< On each outline.
  int iterations = 25;
};
inline constexpr Effort kGlance{32, 4};  ///< Tells what is worth more.

/// Moves the sources onto their targets, all by one similarity: least squares over the distances of the
/// outlines to each other, both ways, with little weight for what lies far off (iterated closest points,
/// point to line). The start has to be roughly right.
Similarity RefineSimilarity(const std::vector<ShapePair>& pairs, const Similarity& start,
                            const Effort& effort = {});

/// How far two outlines lie apart, after `similarity`, as a share of the square root of the target's area:
/// the greatest mean distance, to one side, along any stretch of one sixteenth of either outer ring. Noise
/// averages out in it, a side that lies elsewhere does not. A hole that the other shape lacks counts by its
/// width.
double Misfit(const ShapePair& pair, const Similarity& similarity, const Effort& effort = {});

}  // namespace soffit
