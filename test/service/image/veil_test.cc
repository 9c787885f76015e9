#include "service/image/veil.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

/// A red wall, half of it in shade, on grey ground.
cv::Mat3b Wall() {
  cv::Mat3b picture(120, 160, cv::Vec3b(110, 112, 114));
  picture(cv::Rect(40, 20, 40, 60)) = cv::Vec3b(30, 30, 160);
  picture(cv::Rect(80, 20, 40, 60)) = cv::Vec3b(12, 12, 60);
  return picture;
}

/// The same through haze: `share` of its light is that of a pale sky.
cv::Mat3b Haze(const cv::Mat3b& picture, double share) {
  cv::Mat3b hazy = picture.clone();
  for (cv::Vec3b& color : hazy) {
    for (uchar& level : color.val)
      level = cv::saturate_cast<uchar>(std::sqrt((1.0 - share) * level * level + share * 200.0 * 200.0));
  }
  return hazy;
}

double Saturation(const cv::Vec3b& color) {
  const auto [least, most] = std::minmax({color[0], color[1], color[2]});
  return (most - least) / std::max(1.0, static_cast<double>(most));
}

Image LevelView(const cv::Mat3b& picture) {
  Image image;
  image.bgr = picture;
  image.has_trusted_pose = true;
  image.view.map_from_camera.rotation = CameraAttitude(0.0, 0.0);
  return image;
}

cv::Mat3b Unveil(const cv::Mat3b& picture) {
  cv::Mat3b clear;
  cv::LUT(picture, UnveilTable(LevelView(picture)), clear);
  return clear;
}

TEST(UnveilTable, ChangesNothingInAClearPicture) {
  const cv::Mat3b picture = Wall();
  EXPECT_EQ(cv::norm(Unveil(picture), picture, cv::NORM_INF), 0.0);
}

TEST(UnveilTable, GivesAShadedWallItsColourBack) {
  const cv::Mat3b hazy = Haze(Wall(), 0.08);
  ASSERT_LT(Saturation(hazy(50, 100)), 0.35);
  const cv::Mat3b clear = Unveil(hazy);
  EXPECT_GT(Saturation(clear(50, 100)), 0.55);
  EXPECT_GT(Saturation(clear(50, 60)), 0.7);
  EXPECT_LT(Saturation(clear(110, 10)), 0.08) << "grey ground stays grey";
}

TEST(UnveilTable, TakesPaleGroundAloneForNoHazeToBeLifted) {
  cv::Mat3b ground(120, 160, cv::Vec3b(150, 152, 154));
  cv::Mat noise(ground.size(), CV_8UC3);
  cv::RNG random(3);
  random.fill(noise, cv::RNG::UNIFORM, 0, 6);
  ground += noise;
  const cv::Mat3b clear = Unveil(ground);
  for (const cv::Vec3b& color : clear) EXPECT_LT(Saturation(color), 0.12);
}

TEST(UnveilTable, ChangesNothingInPicturesThatLookDownOrThatNobodyKnowsWhereTheyLook) {
  Image image = LevelView(Haze(Wall(), 0.3));
  EXPECT_NE(UnveilTable(image)(100), 100);
  image.view.map_from_camera.rotation = CameraAttitude(0.0, -1.5);
  EXPECT_EQ(UnveilTable(image)(100), 100);
  image = LevelView(Haze(Wall(), 0.3));
  image.has_trusted_pose = false;
  EXPECT_EQ(UnveilTable(image)(100), 100);
}

TEST(UnveilTable, RisesWithTheLevelAndKeepsWhite) {
  const cv::Mat1b table = UnveilTable(LevelView(Haze(Wall(), 0.3)));
  for (int level = 1; level < 256; ++level) EXPECT_GE(table(level), table(level - 1));
  EXPECT_GE(table(255), 225);
}

}  // namespace
}  // namespace soffit
