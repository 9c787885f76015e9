#include "service/footprint/level.h"

#include <gtest/gtest.h>

#include "shared/result/result.h"

namespace soffit {
namespace {

using Eigen::Vector2d;

const Ring kBox = {{0, 0}, {4, 0}, {4, 2}, {0, 2}};

TEST(InsetRing, MovesEachSideByItsOwn) {
  const Ring ring = InsetRing(kBox, {0.1, 0.2, 0.3, 0.4});
  EXPECT_LT((ring[0] - Vector2d(0.4, 0.1)).norm(), 1e-12);
  EXPECT_LT((ring[2] - Vector2d(3.8, 1.7)).norm(), 1e-12);
}

TEST(InsetRing, LeavesAnUprightBuildingAsItIs) {
  const Ring bent = {{0, 0}, {2, 0}, {4, 0}, {4, 2}, {0, 2}};
  EXPECT_EQ(InsetRing(bent, {0, 0, 0, 0, 0}), bent);
  EXPECT_LT((InsetRing(bent, {0.5, 0.5, 0, 0, 0})[1] - Vector2d(2, 0.5)).norm(), 1e-12);
  EXPECT_THROW(InsetRing(bent, {0.5}), ContractViolation);
}

TEST(LargestShare, EndsAtTheRidge) {
  const std::vector<double> plumb(4, 0.0);
  EXPECT_DOUBLE_EQ(LargestShare(kBox, plumb, {0.9, 0, 0.9, 0}), 1.0);
  EXPECT_NEAR(LargestShare(kBox, plumb, {2, 0, 2, 0}), 0.5, 1e-12);
  EXPECT_NEAR(LargestShare(kBox, plumb, {0, 0, 4, 0}), 0.5, 1e-12);  // Mono-pitch, up to the far wall.
}

TEST(InsetAt, FollowsSlopesAndLedges) {
  const std::vector<Level> levels = {{1.0, {0.2}}, {1.0, {0.5}}, {3.0, {0.9}}};
  EXPECT_DOUBLE_EQ(InsetAt(levels, 0, 0.5), 0.1);
  EXPECT_DOUBLE_EQ(InsetAt(levels, 0, 2.0), 0.7);
  EXPECT_DOUBLE_EQ(InsetAt(levels, 0, 9.0), 0.9);
  EXPECT_DOUBLE_EQ(InsetAt({}, 0, 1.0), 0.0);
}

}  // namespace
}  // namespace soffit
