#include "service/scene/bar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/support/painted_world.h"

namespace soffit {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

const cv::Vec3b kDark(40, 45, 42);

std::vector<Bar> Find(const View& view, const std::vector<test::Thing>& others) {
  std::vector<test::Thing> things = {test::Arch{}.thing()};
  things.insert(things.end(), others.begin(), others.end());
  const Sight sight = test::Look({view}, things).sights.front();
  return FindBars(sight, Predict(sight.view, {&things.front().mesh}));
}

test::Thing PoleAt(double x, double y, const cv::Vec3b& bgr) {
  return test::Block(test::Box(x - 0.05, y - 0.05, x + 0.05, y + 0.05), 0.0, 1.5, bgr);
}

TEST(FindBars, FindsNoneInAnOpeningThatIsFree) { EXPECT_THAT(Find(test::FromSouth(), {}), IsEmpty()); }

TEST(FindBars, FindsAPoleInThePassageNoFartherThanWhatItCovers) {
  const auto bars = Find(test::FromSouth(), {PoleAt(0.2, 0.0, kDark)});
  ASSERT_THAT(bars, SizeIs(1));
  EXPECT_GE(bars[0].far_m, 5.0F);
  EXPECT_LE(bars[0].far_m, 5.75F);  // Where the passage ends.
  EXPECT_EQ(bars[0].runs_px.front().height, 1);
  EXPECT_NEAR(bars[0].runs_px.front().width, 440.0 * 0.1 / 5.0, 4.0);
}

TEST(FindBars, FindsAPoleThatIsColouredLikeTheGround) {
  EXPECT_THAT(Find(test::FromSouth(), {PoleAt(0.2, 0.0, {98, 100, 102})}), SizeIs(1));
}

TEST(FindBars, FindsABeamFromJambToJamb) {
  const auto bars = Find(test::FromSouth(), {test::Block(test::Box(-0.8, -0.1, 0.8, 0.1), 0.7, 0.8, kDark)});
  ASSERT_THAT(bars, SizeIs(1));
  EXPECT_EQ(bars[0].runs_px.front().width, 1);
  EXPECT_GE(bars[0].far_m, 4.9F);
  EXPECT_LE(bars[0].far_m, 5.75F);
}

TEST(FindBars, PutsAMastThatStandsFarBehindWhereItStands) {
  for (const Bar& bar :
       Find(test::FromSouth(), {test::Block(test::Box(0.6, 9.0, 1.0, 9.4), 0.0, 9.0, kDark)})) {
    EXPECT_GT(bar.near_m, 10.0F);
    EXPECT_LT(bar.near_m, 14.0F);
    EXPECT_GT(bar.far_m, 14.0F);
  }
}

TEST(FindBars, PutsAPoleInFrontOnItsFoot) {
  const auto bars = Find(test::FromSouth(), {PoleAt(0.2, -2.0, {98, 100, 102})});
  ASSERT_THAT(bars, SizeIs(1));
  EXPECT_LT(bars[0].near_m, 3.0F);
  EXPECT_GT(bars[0].near_m, 2.2F);
  EXPECT_GT(bars[0].far_m, 3.0F);
  EXPECT_LT(bars[0].far_m, 3.8F);
}

TEST(FindBars, DoesNotTakeAHedgeBehindForOne) {
  EXPECT_THAT(Find(test::FromSouth(), {test::Block(test::Box(-9.0, 12.0, 9.0, 12.5), 0.0, 1.4, kDark)}),
              IsEmpty());
}

TEST(FindBars, DoesNotTakeAMarkOnTheGroundForOne) {
  const test::Thing mark = test::Block(test::Box(0.1, -3.0, 0.2, 6.0), -0.01, 0.0005, kDark);
  EXPECT_THAT(Find(test::FromSouth(), {mark}), IsEmpty());
}

TEST(FindBars, DoesNotTakeTheSideOfAPassageForOne) {
  EXPECT_THAT(Find(test::LevelView({1.6, -4.5, 1.1}, 1.9), {}), IsEmpty());
}

}  // namespace
}  // namespace soffit
