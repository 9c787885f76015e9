#include "shared/geometry/heights.h"

#include <gtest/gtest.h>

namespace soffit {
namespace {

const Ring kGable = {{0, 1}, {4, 1}, {4, 2}, {2, 4}, {0, 2}};

TEST(HeightsAt, GivesTheLowestAndTheHighestPoint) {
  const Span heights = HeightsAt(kGable, 1.0);
  EXPECT_DOUBLE_EQ(heights.low, 1.0);
  EXPECT_DOUBLE_EQ(heights.high, 3.0);
  EXPECT_DOUBLE_EQ(heights.Length(), 2.0);
}

TEST(HeightsAt, TakesAllOfAnUprightSide) {
  EXPECT_DOUBLE_EQ(HeightsAt(kGable, 4.0).low, 1.0);
  EXPECT_DOUBLE_EQ(HeightsAt(kGable, 4.0).high, 2.0);
}

TEST(HeightsAt, IsEmptyBesideTheOutline) {
  EXPECT_LT(HeightsAt(kGable, 4.1).Length(), 0.0);
  EXPECT_LT(HeightsAt({}, 0.0).Length(), 0.0);
}

}  // namespace
}  // namespace soffit
