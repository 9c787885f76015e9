#include "service/scene/ridge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

cv::Mat1b Grey() { return cv::Mat1b(120, 160, uchar{150}); }

/// A line of any width, drawn eight times as large and averaged.
cv::Mat1b WithLine(const cv::Point2d& from, const cv::Point2d& to, double width_px, int value) {
  constexpr int kFiner = 8;
  cv::Mat1b large(120 * kFiner, 160 * kFiner, uchar{150});
  const auto enlarge = [&](const cv::Point2d& at) {
    return cv::Point(cvRound((at.x + 0.5) * kFiner), cvRound((at.y + 0.5) * kFiner));
  };
  cv::line(large, enlarge(from), enlarge(to), cv::Scalar(value), cvRound(width_px * kFiner));
  cv::Mat1b picture;
  cv::resize(large, picture, cv::Size(160, 120), 0.0, 0.0, cv::INTER_AREA);
  return picture;
}

void AddNoise(cv::Mat1b& picture, double std) {
  cv::RNG random(7);
  for (uchar& value : picture) value = cv::saturate_cast<uchar>(value + random.gaussian(std));
}

std::vector<Ridge> FindClear(const cv::Mat1b& picture) {
  std::vector<Ridge> ridges = FindRidges(picture);
  std::erase_if(ridges, [](const Ridge& ridge) { return !ridge.is_clear; });
  return ridges;
}

TEST(FindRidges, FindsNoneInAnEmptyOrEvenPicture) {
  EXPECT_THAT(FindRidges(cv::Mat1b()), IsEmpty());
  EXPECT_THAT(FindRidges(cv::Mat1b(1, 1, uchar{9})), IsEmpty());
  EXPECT_THAT(FindRidges(Grey()), IsEmpty());
}

TEST(FindRidges, FindsNoClearOneInNoise) {
  cv::Mat1b picture = Grey();
  AddNoise(picture, 8.0);
  EXPECT_THAT(FindClear(picture), IsEmpty());
}

TEST(FindRidges, MeasuresALineOfHalfAPixel) {
  const auto ridges = FindClear(WithLine({40.0, 10.0}, {52.0, 100.0}, 0.5, 20));
  ASSERT_THAT(ridges, SizeIs(1));
  EXPECT_NEAR(ridges[0].length_px(), std::hypot(12.0, 90.0), 5.0);
  EXPECT_GT(std::abs(ridges[0].along.dot(cv::Point2d(12.0, 90.0))), 0.999 * std::hypot(12.0, 90.0));
  for (const cv::Point& pixel : ridges[0].pixels)
    EXPECT_NEAR(pixel.x, 40.0 + 12.0 * (pixel.y - 10.0) / 90.0, 2.0);
}

TEST(FindRidges, FindsBrightLinesAndDarkOnesUpToFourPixelsWideInNoise) {
  for (const double width_px : {1.0, 2.0, 4.0}) {
    for (const int value : {100, 200}) {
      cv::Mat1b picture = WithLine({20.0, 90.0}, {140.0, 30.0}, width_px, value);
      AddNoise(picture, 5.0);
      double length_px = 0.0;
      for (const Ridge& ridge : FindClear(picture)) length_px += ridge.length_px();
      EXPECT_GT(length_px, 100.0) << width_px << " px, of " << value;
    }
  }
}

TEST(FindRidges, FollowsALineThatSags) {
  cv::Mat1b picture = Grey();
  cv::ellipse(picture, cv::Point(80, 20), cv::Size(70, 30), 0.0, 10.0, 170.0, cv::Scalar(40), 1, cv::LINE_AA);
  const auto ridges = FindClear(picture);
  ASSERT_THAT(ridges, SizeIs(1));
  EXPECT_GT(ridges[0].length_px(), 120.0);
}

TEST(FindRidges, TakesAnEdgeForNoClearLine) {
  for (const double slope : {0.0, 0.3}) {
    cv::Mat1b picture = Grey();
    const std::vector<cv::Point> half = {{0, 60}, {159, cvRound(60 + 159 * slope)}, {159, 119}, {0, 119}};
    cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{half}, cv::Scalar(40), cv::LINE_AA);
    EXPECT_THAT(FindClear(picture), IsEmpty()) << slope;
  }
}

TEST(FindRidges, TakesAShortDashForNoClearLine) {
  EXPECT_THAT(FindClear(WithLine({40.0, 40.0}, {50.0, 40.0}, 1.0, 20)), IsEmpty());
}

TEST(JoinRidges, JoinsThePiecesOfALineThatIsBroken) {
  cv::Mat1b picture = WithLine({80.0, 10.0}, {80.0, 110.0}, 1.0, 60);
  picture.rowRange(50, 56).setTo(60);
  const std::vector<Ridge> ridges = FindRidges(picture);
  const auto first = std::find_if(ridges.begin(), ridges.end(), [](const Ridge& ridge) {
    return ridge.is_clear && std::abs(ridge.along.y) > 0.9;
  });
  ASSERT_NE(first, ridges.end());
  EXPECT_LT(first->length_px(), 60.0);
  EXPECT_NEAR(JoinRidges(*first, ridges, 1.0).length_px(), 100.0, 5.0);
}

TEST(JoinRidges, LeavesOtherLinesAlone) {
  cv::Mat1b picture = WithLine({80.0, 10.0}, {80.0, 50.0}, 1.0, 60);
  cv::min(picture, cv::Mat(WithLine({86.0, 56.0}, {86.0, 110.0}, 1.0, 60)), picture);
  const std::vector<Ridge> ridges = FindClear(picture);
  ASSERT_THAT(ridges, SizeIs(2));
  EXPECT_LT(JoinRidges(ridges[0], ridges, 1.0).length_px(), 45.0);
}

}  // namespace
}  // namespace soffit
