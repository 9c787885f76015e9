#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "shared/result/result.h"
#include "test/support/painted_world.h"

namespace soffit {
namespace {

using test::Arch;
using test::Look;

Seen At(const Sight& sight, const Eigen::Vector3d& point) {
  const auto pixel = Project(sight.view, point);
  return static_cast<Seen>(sight.seen(static_cast<int>(pixel->y()), static_cast<int>(pixel->x())));
}

TEST(LabelSight, TellsStructureGroundAndSkyApart) {
  const auto seeing = Look({test::FromSouth()}, {Arch{}.thing()});
  const Sight& sight = seeing.sights.front();
  EXPECT_EQ(At(sight, {1.5, -0.75, 1.0}), Seen::kStructure);
  EXPECT_EQ(At(sight, {1.5, -1.5, 0.0}), Seen::kGround);
  EXPECT_EQ(At(sight, {0.0, 20.0, 1.8}), Seen::kSky);
}

TEST(LabelSight, TakesADarkPoleForUnexplained) {
  const test::Thing pole = test::Block(test::Box(-0.05, -1.3, 0.05, -1.2), 0.0, 2.5, {30, 60, 30});
  const auto seeing = Look({test::FromSouth()}, {Arch{}.thing(), pole});
  EXPECT_EQ(At(seeing.sights.front(), {0.0, -1.3, 1.3}), Seen::kUnexplained);
  EXPECT_EQ(At(seeing.sights.front(), {0.0, -1.3, 0.5}), Seen::kUnexplained);
}

TEST(LabelSight, LearnsNoSkyFromWhatIsSeenBelowALintel) {
  const Arch tall{1.6, 2.1};
  const test::Thing pole = test::Block(test::Box(-0.06, -0.06, 0.06, 0.06), 0.0, 2.05, {170, 166, 162});
  const auto seeing = Look({test::FromSouth()}, {tall.thing(), pole});
  EXPECT_EQ(At(seeing.sights.front(), {0.0, -0.06, 1.9}), Seen::kUnexplained);
  EXPECT_EQ(At(seeing.sights.front(), {0.4, -0.06, 1.9}), Seen::kSky);
}

TEST(LabelSight, KnowsTheSkyInAnOpeningThatIsAllThatIsSeenOfIt) {
  const test::Thing board = test::Block(test::Box(-9.0, -0.75, 9.0, 0.75), 2.1, 9.0, test::kBlueWall);
  const auto seeing = Look({test::FromSouth()}, {Arch{1.6, 2.1}.thing(), board});
  EXPECT_EQ(At(seeing.sights.front(), {0.0, 20.0, 4.0}), Seen::kSky);
}

TEST(LabelSight, GivesTheSameBytesTwice) {
  const auto a = Look({test::FromSouth()}, {Arch{}.thing()});
  const auto b = Look({test::FromSouth()}, {Arch{}.thing()});
  EXPECT_EQ(cv::norm(a.sights[0].seen, b.sights[0].seen, cv::NORM_INF), 0.0);
}

TEST(LabelSight, RefusesAMaskOfAnotherSize) {
  Image image;
  image.bgr = cv::Mat3b(10, 10);
  Mask mask;
  mask.label = cv::Mat1b(5, 5);
  EXPECT_THROW(LabelSight(image, mask, {}), ContractViolation);
}

const View kLevel = test::LevelView({0.0, 0.0, 1.5}, 0.0);

/// Grass that fades into the haze at the horizon, as light does, with bright sky above.
cv::Mat3b Haze() {
  cv::Mat3b picture = test::Paint(kLevel, {});
  const cv::Vec3f grass = cv::Vec3f(60, 110, 90).mul(cv::Vec3f(60, 110, 90));
  const cv::Vec3f sky = cv::Vec3f(test::kBrightSky).mul(cv::Vec3f(test::kBrightSky));
  for (int y = 240; y < picture.rows; ++y) {
    const float share = 1.0F - std::exp(-3.0F / (static_cast<float>(y) - 239.5F));
    const cv::Vec3f light = grass + share * (sky - grass);
    for (int x = 0; x < picture.cols; ++x) {
      for (int c = 0; c < 3; ++c) picture(y, x)[c] = cv::saturate_cast<uchar>(std::sqrt(light[c]));
    }
  }
  return picture;
}

cv::Mat1b Label(const cv::Mat3b& picture) {
  Image image;
  image.bgr = picture;
  image.view = kLevel;
  image.seen = {0, 0, picture.cols, picture.rows};
  Mask mask;
  mask.label = cv::Mat1b(picture.size(), uchar{0});
  return LabelSight(image, mask, {}).seen;
}

bool Is(uchar seen, Seen wanted) { return seen == static_cast<uchar>(wanted); }

TEST(LabelSight, KnowsGroundUpToTheHorizonThroughHaze) {
  const cv::Mat1b seen = Label(Haze());
  for (int y = 242; y < 480; ++y) ASSERT_TRUE(Is(seen(y, 320), Seen::kGround)) << y;
  EXPECT_TRUE(Is(seen(236, 320), Seen::kSky));
}

/// A bar across the picture, just below the horizon, with edges as blurred as a lens makes them.
cv::Mat3b WithBar(const cv::Vec3b& color) {
  cv::Mat3b picture = Haze();
  picture.rowRange(246, 256).setTo(color);
  cv::GaussianBlur(picture.rowRange(243, 259).clone(), picture.rowRange(243, 259), cv::Size(5, 5), 0.0);
  return picture;
}

TEST(LabelSight, TakesNoBarBeforeTheHazeForGround) {
  for (const cv::Vec3b& color : {cv::Vec3b(70, 30, 90), cv::Vec3b(120, 60, 60), cv::Vec3b(200, 195, 190),
                                 cv::Vec3b(90, 90, 150), cv::Vec3b(160, 160, 160)}) {
    const cv::Mat1b seen = Label(WithBar(color));
    for (int y = 248; y < 254; ++y) ASSERT_FALSE(Is(seen(y, 320), Seen::kGround)) << color << " row " << y;
  }
}

}  // namespace
}  // namespace soffit
