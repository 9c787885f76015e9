#include "service/mask/mask.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "shared/result/result.h"

namespace soffit {
namespace {

using ::testing::ElementsAre;

const cv::Scalar kGrass(45, 112, 95);
const cv::Scalar kOchre(75, 117, 130);
const cv::Scalar kAsphalt(78, 80, 80);
const cv::Scalar kSky(220, 180, 150);

const cv::Rect kBuilding(40, 30, 60, 50);

Image Scene(const cv::Scalar& ground, const cv::Scalar& building) {
  Image image;
  image.bgr = cv::Mat3b(120, 160);
  image.bgr.setTo(ground);
  image.bgr(kBuilding).setTo(building);
  image.seen = cv::Rect({0, 0}, image.bgr.size());
  return image;
}

/// Share of the building's pixels with this label, and of the others that have any.
struct Shares {
  double right = 0.0;
  double wrong = 0.0;
};

Shares Rate(const Image& image, std::uint8_t label, const MaskOptions& options = {}) {
  const Mask mask = SegmentBuildings(image, options);
  cv::Mat1b outside(mask.label.size(), uchar{255});
  outside(kBuilding).setTo(0);
  cv::Mat1b is_right;
  cv::compare(mask.label(kBuilding), static_cast<double>(label), is_right, cv::CMP_EQ);
  cv::Mat1b elsewhere;
  mask.label.copyTo(elsewhere, outside);
  return {static_cast<double>(cv::countNonZero(is_right)) / kBuilding.area(),
          static_cast<double>(cv::countNonZero(elsewhere)) / cv::countNonZero(outside)};
}

TEST(SegmentBuildings, FindsRedBlueAndYellow) {
  const std::vector<cv::Scalar> colors = {{25, 30, 180}, {170, 60, 45}, {25, 180, 225}};
  for (std::size_t i = 0; i < colors.size(); ++i) {
    for (const cv::Scalar& ground : {kGrass, kOchre, kAsphalt}) {
      const Shares shares = Rate(Scene(ground, colors[i]), static_cast<std::uint8_t>(i + 1));
      EXPECT_GT(shares.right, 0.98) << i;
      EXPECT_LT(shares.wrong, 0.005) << i;
    }
  }
}

TEST(SegmentBuildings, KeepsDarkWallsOfTheBuildingsColour) {
  EXPECT_GT(Rate(Scene(kAsphalt, {55, 15, 5}), 2).right, 0.98);
  EXPECT_GT(Rate(Scene(kGrass, {4, 5, 60}), 1).right, 0.98);
}

TEST(SegmentBuildings, DoesNotPartALitRoofFromAShadedWall) {
  Image image = Scene(kGrass, {165, 75, 63});
  cv::Rect wall = kBuilding;
  wall.width /= 2;
  image.bgr(wall).setTo(cv::Scalar(90, 20, 10));
  EXPECT_GT(Rate(image, 2).right, 0.98);
}

TEST(SegmentBuildings, TakesNeitherSkyNorOchreGroundForBuildings) {
  for (const cv::Scalar& background :
       {kSky, kOchre, kGrass, kAsphalt, cv::Scalar(255, 255, 255), cv::Scalar(0, 0, 0)}) {
    const Mask mask = SegmentBuildings(Scene(background, background), {});
    EXPECT_EQ(cv::countNonZero(mask.label), 0) << background;
  }
}

TEST(SegmentBuildings, SurvivesNoise) {
  Image image = Scene(kAsphalt, {25, 30, 180});
  cv::Mat noise(image.bgr.size(), CV_16SC3);
  cv::RNG(5).fill(noise, cv::RNG::NORMAL, 0.0, 12.0);
  cv::Mat noisy;
  image.bgr.convertTo(noisy, CV_16SC3);
  noisy += noise;
  noisy.convertTo(image.bgr, CV_8UC3);
  const Shares shares = Rate(image, 1);
  EXPECT_GT(shares.right, 0.97);
  EXPECT_LT(shares.wrong, 0.02);
}

TEST(SegmentBuildings, IsSureOfColoursFarFromTheGround) {
  EXPECT_GT(SegmentBuildings(Scene(kAsphalt, {25, 30, 180}), {}).confidence, 0.8);
  EXPECT_LT(SegmentBuildings(Scene(kAsphalt, {100, 105, 185}), {}).confidence, 0.6);
}

TEST(SegmentBuildings, FindsASmallBuildingInAHighPicture) {
  Image image = Scene(kOchre, kOchre);
  image.bgr = cv::Mat3b(3000, 400);
  image.bgr.setTo(kOchre);
  const cv::Rect building(200, 1711, 40, 30);
  image.bgr(building).setTo(cv::Scalar(25, 180, 225));
  const Mask mask = SegmentBuildings(image, {});
  EXPECT_GT(cv::countNonZero(mask.label(building)), building.area() - 60);
  EXPECT_LE(cv::countNonZero(mask.label), building.area());
}

TEST(SegmentBuildings, LabelsInTheOrderOfTheOptions) {
  MaskOptions options;
  options.colors = {"magenta", "green"};
  EXPECT_THAT(SegmentBuildings(Scene(kAsphalt, {200, 20, 200}), options).classes,
              ElementsAre("magenta", "green"));
  EXPECT_GT(Rate(Scene(kAsphalt, {200, 20, 200}), 1, options).right, 0.98);
  EXPECT_GT(Rate(Scene(kAsphalt, {40, 190, 40}), 2, options).right, 0.98);
}

TEST(SegmentBuildings, RefusesUnknownColoursAndEvenMedians) {
  MaskOptions options;
  options.colors = {"mauve"};
  EXPECT_THROW(SegmentBuildings(Scene(kGrass, kGrass), options), ContractViolation);
  options = {};
  options.median_px = 6;
  EXPECT_THROW(SegmentBuildings(Scene(kGrass, kGrass), options), ContractViolation);
  EXPECT_THROW(SegmentBuildings(Image{}, {}), ContractViolation);
}

TEST(SegmentBuildings, GivesTheSameForTheSame) {
  const Image image = Scene(kGrass, {170, 60, 45});
  EXPECT_EQ(cv::norm(SegmentBuildings(image, {}).label, SegmentBuildings(image, {}).label, cv::NORM_INF),
            0.0);
}

}  // namespace
}  // namespace soffit
