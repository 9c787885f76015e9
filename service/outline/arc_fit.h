#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace soffit {

/// An ellipse that points lie along, all around or a part of the way.
struct Arc {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Matrix2d circle_from_ellipse = Eigen::Matrix2d::Identity();  ///< About the centre; symmetric.
  double squares = 0.0;  ///< Sum of the squared distances of the points that it was fitted to.

  double AngleOf(const Eigen::Vector2d& point) const;  ///< On the circle; radians, -pi to pi.
  Eigen::Vector2d PointAt(double angle_rad) const;
  double LongerRadius() const;
};

/// The circle, or the ellipse if that takes more than `ellipse_price` off the squares, with the least squared
/// distances from the points (Gauss-Newton from I. Kasa's circle, IEEE TIM 25, 1976; distances to first
/// order: P. Sampson, CGIP 18, 1982). Nothing when they lie in a line. Pure; O(points).
std::optional<Arc> FitArc(const std::vector<Eigen::Vector2d>& points, double ellipse_price);

}  // namespace soffit
