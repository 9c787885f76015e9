#include "service/outline/arc_fit.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace soffit {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int kMaxSteps = 10;
constexpr double kLeastGain = 1e-3;  ///< A step that takes less off the squares is the last one.

/// Centre, and the three numbers of the symmetric matrix.
using Parameters = Eigen::Matrix<double, 5, 1>;
/// Columns: the ways in which the parameters may change.
template <int kWays>
using Freedom = Eigen::Matrix<double, 5, kWays>;

Freedom<3> CircleFreedom() {
  Freedom<3> freedom = Freedom<3>::Zero();
  freedom(0, 0) = freedom(1, 1) = 1.0;
  freedom(2, 2) = freedom(4, 2) = 1.0;
  return freedom;
}

/// How a distance from the arc changes with the parameters, and the distance.
struct Residual {
  double distance = 0.0;
  Parameters slope = Parameters::Zero();
};

Residual ResidualOf(const Arc& arc, const Vector2d& point) {
  const Vector2d v = point - arc.center;
  const Vector2d q = arc.circle_from_ellipse * v;
  const double radius = q.norm();
  const Vector2d gradient = arc.circle_from_ellipse * q / radius;
  const double steepness = gradient.norm();
  Residual residual;
  residual.distance = (radius - 1.0) / steepness;
  residual.slope << -gradient, q.x() * v.x() / radius, (q.x() * v.y() + q.y() * v.x()) / radius,
      q.y() * v.y() / radius;
  residual.slope /= steepness;
  return residual;
}

double SquaresOf(const Arc& arc, const std::vector<Vector2d>& points) {
  double squares = 0.0;
  for (const Vector2d& point : points) {
    const double distance = ResidualOf(arc, point).distance;
    squares += distance * distance;
  }
  return squares;
}

bool IsEllipse(const Arc& arc) {
  return arc.center.allFinite() && arc.circle_from_ellipse.determinant() > 0.0 &&
         arc.circle_from_ellipse.trace() > 0.0 && std::isfinite(arc.squares);
}

Arc Moved(const Arc& arc, const Parameters& by, const std::vector<Vector2d>& points) {
  Arc moved = arc;
  moved.center += by.head<2>();
  moved.circle_from_ellipse += (Matrix2d() << by[2], by[3], by[3], by[4]).finished();
  moved.squares = SquaresOf(moved, points);
  return moved;
}

template <int kWays>
Arc Refine(Arc arc, const Freedom<kWays>& freedom, const std::vector<Vector2d>& points) {
  for (int step = 0; step < kMaxSteps; ++step) {
    Eigen::Matrix<double, kWays, kWays> normal = Eigen::Matrix<double, kWays, kWays>::Zero();
    Eigen::Matrix<double, kWays, 1> right = Eigen::Matrix<double, kWays, 1>::Zero();
    for (const Vector2d& point : points) {
      const Residual residual = ResidualOf(arc, point);
      const Eigen::Matrix<double, kWays, 1> slope = freedom.transpose() * residual.slope;
      normal += slope * slope.transpose();
      right -= slope * residual.distance;
    }
    const Arc moved = Moved(arc, freedom * normal.ldlt().solve(right), points);
    if (!IsEllipse(moved) || moved.squares >= arc.squares) break;
    const bool is_last = moved.squares > (1.0 - kLeastGain) * arc.squares;
    arc = moved;
    if (is_last) break;
  }
  return arc;
}

/// The circle with the least squares of its equation.
std::optional<Arc> StartCircle(const std::vector<Vector2d>& points) {
  Vector2d mean = Vector2d::Zero();
  for (const Vector2d& p : points) mean += p / static_cast<double>(points.size());
  Matrix2d normal = Matrix2d::Zero();
  Vector2d right = Vector2d::Zero();
  double spread = 0.0;
  for (const Vector2d& p : points) {
    const Vector2d v = p - mean;
    normal += v * v.transpose();
    right += 0.5 * v.squaredNorm() * v;
    spread += v.squaredNorm() / static_cast<double>(points.size());
  }
  if (!(normal.determinant() > 1e-9 * normal.trace() * normal.trace())) return std::nullopt;
  const Vector2d center = normal.inverse() * right;
  Arc arc;
  arc.center = mean + center;
  arc.circle_from_ellipse = Matrix2d::Identity() / std::sqrt(spread + center.squaredNorm());
  arc.squares = SquaresOf(arc, points);
  if (!IsEllipse(arc)) return std::nullopt;
  return arc;
}

}  // namespace

double Arc::AngleOf(const Vector2d& point) const {
  const Vector2d q = circle_from_ellipse * (point - center);
  return std::atan2(q.y(), q.x());
}

Vector2d Arc::PointAt(double angle_rad) const {
  return center + circle_from_ellipse.inverse() * Vector2d(std::cos(angle_rad), std::sin(angle_rad));
}

double Arc::LongerRadius() const {
  const Eigen::SelfAdjointEigenSolver<Matrix2d> axes(circle_from_ellipse);
  return 1.0 / axes.eigenvalues().minCoeff();
}

std::optional<Arc> FitArc(const std::vector<Vector2d>& points, double ellipse_price) {
  if (points.size() < 6) return std::nullopt;
  const std::optional<Arc> start = StartCircle(points);
  if (!start) return std::nullopt;
  const Arc circle = Refine<3>(*start, CircleFreedom(), points);
  const Arc ellipse = Refine<5>(circle, Freedom<5>::Identity(), points);
  return ellipse.squares + ellipse_price < circle.squares ? ellipse : circle;
}

}  // namespace soffit
