#include "service/scene/range_pyramid.h"

#include <gtest/gtest.h>

#include <random>

namespace soffit {
namespace {

cv::Mat1f Noise(cv::Size size) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> value(-5.0F, 5.0F);
  cv::Mat1f picture(size);
  for (float& v : picture) v = value(random);
  return picture;
}

TEST(RangePyramid, GivesTheValueOfASinglePixel) {
  const cv::Mat1f picture = Noise({13, 7});
  const RangePyramid pyramid(picture, picture);
  EXPECT_EQ(pyramid.Bound(12, 6, 12, 6).least, picture(6, 12));
  EXPECT_EQ(pyramid.Bound(12, 6, 12, 6).greatest, picture(6, 12));
}

TEST(RangePyramid, IsNeverNarrowerThanTheWindow) {
  const cv::Mat1f picture = Noise({61, 47});
  const RangePyramid pyramid(picture, picture);
  std::mt19937 random(3);
  const auto below = [&](int end) { return static_cast<int>(random() % static_cast<unsigned>(end)); };
  for (int i = 0; i < 2000; ++i) {
    const int x0 = below(61), y0 = below(47);
    const int x1 = x0 + below(61 - x0), y1 = y0 + below(47 - y0);
    double least = 0.0, greatest = 0.0;
    cv::minMaxLoc(picture(cv::Rect(x0, y0, x1 - x0 + 1, y1 - y0 + 1)), &least, &greatest);
    const RangePyramid::Range bound = pyramid.Bound(x0, y0, x1, y1);
    ASSERT_LE(bound.least, least);
    ASSERT_GE(bound.greatest, greatest);
  }
}

TEST(RangePyramid, KeepsLeastAndGreatestOfDifferentPicturesApart) {
  const cv::Mat1f low(9, 9, 1.0F);
  const cv::Mat1f high(9, 9, 4.0F);
  const RangePyramid::Range bound = RangePyramid(low, high).Bound(0, 0, 8, 8);
  EXPECT_EQ(bound.least, 1.0F);
  EXPECT_EQ(bound.greatest, 4.0F);
}

}  // namespace
}  // namespace soffit
