#include "shared/geometry/polygon.h"

#include <gmock/gmock.h>

namespace soffit {
namespace {

using ::testing::SizeIs;

const Ring kSquare = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};

TEST(SignedArea, IsPositiveCounterClockwiseAndNegativeClockwise) {
  EXPECT_DOUBLE_EQ(SignedArea(kSquare), 4.0);
  EXPECT_DOUBLE_EQ(SignedArea(Ring(kSquare.rbegin(), kSquare.rend())), -4.0);
  EXPECT_DOUBLE_EQ(SignedArea({}), 0.0);
}

TEST(SignedArea, KeepsPrecisionFarFromTheOrigin) {
  const Eigen::Vector2d far(691000.0, 5335000.0);
  Ring moved = kSquare;
  for (auto& corner : moved) corner += far;
  EXPECT_DOUBLE_EQ(SignedArea(moved), 4.0);
  EXPECT_LT((Centroid({moved, {}}) - far - Eigen::Vector2d(1, 1)).norm(), 1e-8);
}

TEST(Area, TakesHolesOff) {
  const Polygon courtyard{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{{1, 1}, {1, 2}, {2, 2}, {2, 1}}}};
  EXPECT_DOUBLE_EQ(Area(courtyard), 15.0);
  EXPECT_TRUE(Contains(courtyard, {3, 3}));
  EXPECT_FALSE(Contains(courtyard, {1.5, 1.5}));
}

TEST(Centroid, MovesAwayFromAHole) {
  const Polygon polygon{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{{0.5, 0.5}, {0.5, 1.5}, {1.5, 1.5}, {1.5, 0.5}}}};
  EXPECT_GT(Centroid(polygon).x(), 2.0);
  EXPECT_GT(Centroid(polygon).y(), 2.0);
}

TEST(DistanceToRing, IsThatToTheNearestSide) {
  EXPECT_DOUBLE_EQ(DistanceToRing({1, 1.5}, kSquare), 0.5);
  EXPECT_DOUBLE_EQ(DistanceToRing({5, 6}, kSquare), 5.0);
}

TEST(IsSimple, RefusesBowTiesSpikesRepeatedCornersAndTouchingSides) {
  EXPECT_TRUE(IsSimple(kSquare));
  EXPECT_FALSE(IsSimple({{0, 0}, {2, 2}, {2, 0}, {0, 2}}));
  EXPECT_FALSE(IsSimple({{0, 0}, {2, 0}, {1, 0}}));
  EXPECT_FALSE(IsSimple({{0, 0}, {0, 0}, {2, 0}, {1, 1}}));
  EXPECT_FALSE(IsSimple({{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}));
  EXPECT_FALSE(IsSimple({{0, 0}, {1, 1}}));
}

TEST(ShareInside, TellsHowMuchOfOneRingLiesInAnother) {
  const Ring square = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  const Ring right = {{1, -1}, {5, -1}, {5, 3}, {1, 3}};
  EXPECT_DOUBLE_EQ(ShareInside(square, square), 1.0);
  EXPECT_NEAR(ShareInside(square, right), 0.5, 0.05);
  EXPECT_DOUBLE_EQ(ShareInside(square, {{3, 0}, {4, 0}, {4, 1}}), 0.0);
  EXPECT_DOUBLE_EQ(ShareInside({}, square), 0.0);
}

TEST(ConvexHull, DropsInnerAndCollinearPoints) {
  EXPECT_THAT(ConvexHull({{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1}, {0, 0}}), SizeIs(4));
  EXPECT_GT(SignedArea(ConvexHull({{0, 0}, {0, 2}, {2, 2}, {2, 0}})), 0.0);
  EXPECT_THAT(ConvexHull({{0, 0}, {1, 1}, {2, 2}}), SizeIs(2));
}

TEST(DistanceToSegment, IsZeroWhereTheSegmentMeetsTheArea) {
  const Ring square = {{0, 0}, {2, 0}, {2, 2}, {0, 2}};
  EXPECT_EQ(DistanceToSegment(square, {-1, 1}, {3, 1}), 0.0);
  EXPECT_EQ(DistanceToSegment(square, {0.5, 0.5}, {1, 1}), 0.0);
  EXPECT_EQ(DistanceToSegment(square, {1, 1}, {5, 5}), 0.0);
  EXPECT_NEAR(DistanceToSegment(square, {-1, 3}, {4, 3}), 1.0, 1e-12);
  EXPECT_NEAR(DistanceToSegment(square, {4, 1}, {6, 7}), 2.0, 1e-12);
  EXPECT_NEAR(DistanceToSegment(square, {3, 0}, {3, 5}), 1.0, 1e-12);
}

}  // namespace
}  // namespace soffit
