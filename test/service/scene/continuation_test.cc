#include "service/scene/continuation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/support/painted_world.h"

namespace soffit {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kHorizon_y = 240;
constexpr int kReach_px = 6;

/// Level ground and sky; a grey thing before both in columns 300 to 320 down to row 330.
Sight Look(const cv::Vec3b& thing) {
  Sight sight;
  sight.view = test::LevelView({0.0, 0.0, 1.5}, 0.0);
  sight.bgr = test::Paint(sight.view, {});
  sight.bgr(cv::Range(150, 331), cv::Range(300, 321)).setTo(thing);
  sight.seen = cv::Mat1b(sight.bgr.size(), static_cast<uchar>(Seen::kSky));
  sight.seen.rowRange(kHorizon_y, sight.seen.rows) = static_cast<uchar>(Seen::kGround);
  sight.seen(cv::Range(150, kHorizon_y), cv::Range(300, 321)) = static_cast<uchar>(Seen::kUnexplained);
  return sight;
}

cv::Mat1b Strange(const Sight& sight) {
  cv::Mat1b strange;
  cv::compare(sight.seen, static_cast<double>(Seen::kUnexplained), strange, cv::CMP_EQ);
  return strange;
}

TEST(FollowDown, FollowsAGreyThingOnGreyGroundToItsFoot) {
  const Sight sight = Look({95, 97, 98});
  const auto found = FollowDown(sight, Strange(sight), kReach_px);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rows.front().y, kHorizon_y);
  EXPECT_NEAR(found[0].rows.back().y, 330, 1);
  EXPECT_NEAR(found[0].rows.back().left, 300, 1);
  EXPECT_NEAR(found[0].rows.back().right, 320, 1);
  EXPECT_FALSE(found[0].meets_structure);
}

TEST(FollowDown, FollowsItThoughRowsAtTheHorizonAreLeftOpenAndItsEndsWereNotStrange) {
  Sight sight = Look({95, 97, 98});
  cv::Mat1b strange = Strange(sight);
  strange.rowRange(kHorizon_y - 4, kHorizon_y) = 0;
  strange.colRange(0, 305) = 0;
  const auto found = FollowDown(sight, strange, kReach_px);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_NEAR(found[0].rows.back().left, 300, 1);
}

TEST(FollowDown, TakesGroundBetweenJambsForNoThing) {
  Sight sight = Look({95, 97, 98});
  sight.bgr(cv::Range(kHorizon_y, 400), cv::Range(280, 300)).setTo(test::kBlueWall);
  sight.bgr(cv::Range(kHorizon_y, 400), cv::Range(321, 341)).setTo(test::kBlueWall);
  sight.seen(cv::Range(kHorizon_y, 400), cv::Range(280, 300)) = static_cast<uchar>(Seen::kStructure);
  sight.seen(cv::Range(kHorizon_y, 400), cv::Range(321, 341)) = static_cast<uchar>(Seen::kStructure);
  EXPECT_THAT(FollowDown(sight, Strange(sight), kReach_px), IsEmpty());
}

TEST(FollowDown, SaysWhereItEndsBeforeABuilding) {
  Sight sight = Look({95, 97, 98});
  sight.seen.rowRange(300, 360) = static_cast<uchar>(Seen::kStructure);
  const auto found = FollowDown(sight, Strange(sight), kReach_px);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_TRUE(found[0].meets_structure);
  EXPECT_EQ(found[0].rows.back().y, 299);
}

TEST(FollowDown, StopsWhereAThingsShadowMakesItWide) {
  Sight sight = Look({60, 61, 62});
  sight.bgr(cv::Range(325, 345), cv::Range(200, 321)).setTo(cv::Vec3b(58, 59, 60));
  const auto found = FollowDown(sight, Strange(sight), kReach_px);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_NEAR(found[0].rows.back().y, 324, 2);
}

TEST(FollowDown, FindsNothingOnOpenGround) {
  const Sight sight = Look({95, 97, 98});
  Sight far = sight;  // A thing that ends at the horizon.
  far.bgr(cv::Range(kHorizon_y, 331), cv::Range(300, 321)).setTo(test::kGreyGround);
  EXPECT_THAT(FollowDown(far, Strange(far), kReach_px), IsEmpty());
  EXPECT_THAT(FollowDown(sight, cv::Mat1b(sight.seen.size(), uchar{0}), kReach_px), IsEmpty());
}

}  // namespace
}  // namespace soffit
