#include "service/outline/arc_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace soffit {
namespace {

using Eigen::Vector2d;

/// Points of an ellipse along the axes, from one angle to another.
std::vector<Vector2d> Points(const Vector2d& center, const Vector2d& radii, double from_rad, double to_rad) {
  constexpr int kCount = 60;
  std::vector<Vector2d> points;
  for (int i = 0; i < kCount; ++i) {
    const double angle = from_rad + (to_rad - from_rad) * i / kCount;
    points.push_back(center + radii.cwiseProduct(Vector2d(std::cos(angle), std::sin(angle))));
  }
  return points;
}

TEST(FitArc, FindsACircleFromAThirdOfIt) {
  const auto arc = FitArc(Points({691000.0, 5335000.0}, {40.0, 40.0}, 0.3, 2.4), 1.0);
  ASSERT_TRUE(arc);
  EXPECT_LT((arc->center - Vector2d(691000.0, 5335000.0)).norm(), 1e-3);
  EXPECT_NEAR(arc->LongerRadius(), 40.0, 1e-3);
  EXPECT_LT(arc->squares, 1e-6);
}

TEST(FitArc, FindsAnEllipseWhereACircleDoesNotDo) {
  const std::vector<Vector2d> points = Points({12.0, -7.0}, {40.0, 30.0}, 0.0, 6.28);
  const auto arc = FitArc(points, 1.0);
  ASSERT_TRUE(arc);
  EXPECT_LT((arc->center - Vector2d(12.0, -7.0)).norm(), 1e-3);
  EXPECT_NEAR(arc->LongerRadius(), 40.0, 1e-2);
  EXPECT_LT(arc->squares, 1e-3);
  for (const Vector2d& p : points) EXPECT_LT((arc->PointAt(arc->AngleOf(p)) - p).norm(), 0.01);
}

TEST(FitArc, PrefersACircleUnlessAnEllipseIsWorthItsPrice) {
  const auto arc = FitArc(Points({0.0, 0.0}, {20.0, 20.1}, 0.0, 6.28), 1.0);
  ASSERT_TRUE(arc);
  EXPECT_NEAR(arc->LongerRadius(), 20.05, 0.01);
}

TEST(FitArc, FindsNothingInALineOrInFewPoints) {
  std::vector<Vector2d> line;
  for (int i = 0; i < 20; ++i) line.emplace_back(3.0 * i, 100.0 - i);
  EXPECT_FALSE(FitArc(line, 1.0));
  EXPECT_FALSE(FitArc({}, 1.0));
  EXPECT_FALSE(FitArc({{0, 0}, {1, 1}, {2, 0}}, 1.0));
  EXPECT_FALSE(FitArc(std::vector<Vector2d>(20, Vector2d(5.0, 5.0)), 1.0));
}

}  // namespace
}  // namespace soffit
