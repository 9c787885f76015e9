#pragma once

#include <Eigen/Core>

namespace soffit {

/// Twice the area that two vectors span; positive when `b` is to the left of `a`.
inline double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace soffit
