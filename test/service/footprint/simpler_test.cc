#include "service/footprint/simpler.h"

#include <gmock/gmock.h>

namespace soffit {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const Ring kDented = {{0, 0}, {2, 0}, {2.05, 0.04}, {4, 0}, {4, 2}, {0, 2}};

Massing Gable() {
  return {{kDented},
          {{1.0, {0, 0, 0, 0, 0, 0}}, {2.0, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6}}},
          {{false, false, false, false, false, false}, {true, true, true, true, true, true}}};
}

TEST(WithFewerCorners, TakesOutWhatHardlyMovesTheRing) {
  const std::vector<Massing> simpler = WithFewerCorners(Gable(), 0.1);
  ASSERT_FALSE(simpler.empty());
  for (const Massing& massing : simpler) {
    EXPECT_LT(massing.rings[0].size(), kDented.size());
    EXPECT_THAT(massing.levels, Each(::testing::Field(&Level::inset_m, SizeIs(massing.rings[0].size()))));
    EXPECT_THAT(massing.is_free, Each(SizeIs(massing.rings[0].size())));
  }
  EXPECT_THAT(WithFewerCorners(Gable(), 1e-6), IsEmpty());
}

TEST(WithFewerCorners, KeepsTheInsetsOfTheSidesThatAreLeft) {
  const Massing simpler = WithFewerCorners(Gable(), 0.1).front();
  ASSERT_THAT(simpler.levels.back().inset_m, SizeIs(5));
  EXPECT_THAT(
      std::vector<double>(simpler.levels.back().inset_m.end() - 3, simpler.levels.back().inset_m.end()),
      ElementsAre(0.4, 0.5, 0.6));
}

TEST(WithFewerCorners, LeavesATriangle) {
  EXPECT_THAT(WithFewerCorners(Upright({{{0, 0}, {1, 0}, {0, 1}}, {}}, 1.0), 9.0), IsEmpty());
}

TEST(WithoutLevel, LeavesWhatStoodBackThereToTheNext) {
  Massing hip = Gable();
  hip.is_free[0][2] = true;
  hip.is_free[1][2] = false;
  const Massing simpler = WithoutLevel(hip, 0);
  ASSERT_THAT(simpler.levels, SizeIs(1));
  EXPECT_EQ(simpler.height_m(), 2.0);
  EXPECT_THAT(simpler.is_free, ElementsAre(std::vector<bool>(6, true)));
  EXPECT_EQ(WithoutLevel(hip, 1).height_m(), 1.0);
}

TEST(WithoutInset, LetsASideGoStraightOn) {
  EXPECT_FALSE(WithoutInset(Gable(), 1, 3).is_free[1][3]);
  EXPECT_TRUE(WithoutInset(Gable(), 1, 3).is_free[1][2]);
}

}  // namespace
}  // namespace soffit
