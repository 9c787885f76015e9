#include "service/outline/judge.h"

#include <gmock/gmock.h>

#include <numbers>
#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

using ::testing::HasSubstr;

cv::Mat1b DrawSlanted() {
  cv::Mat1b label(220, 240, uchar{0});
  const std::vector<cv::Point> ring = {{40, 30}, {211, 78}, {182, 184}, {11, 137}};
  cv::fillConvexPoly(label, ring, cv::Scalar(1));
  return label;
}

cv::Mat1b DrawDisc(double radius, int size) {
  cv::Mat1b label(size, size, uchar{0});
  cv::circle(label, {size / 2, size / 2}, static_cast<int>(radius), cv::Scalar(1), cv::FILLED);
  return label;
}

/// A picture with noise in patches of `grain_px`, as of grass and trees, and a blob that is as much brighter.
Image Textured(const cv::Mat1b& label, double brighter, double noise, int grain_px) {
  cv::Mat1f coarse(label.size() / grain_px + cv::Size(1, 1));
  cv::RNG(5).fill(coarse, cv::RNG::NORMAL, 100.0, noise);
  cv::Mat1f grey;
  cv::resize(coarse, grey, label.size(), 0.0, 0.0, cv::INTER_NEAREST);
  cv::add(grey, brighter, grey, label);
  cv::Mat1b levels;
  grey.convertTo(levels, CV_8U);
  Image image;
  cv::cvtColor(levels, image.bgr, cv::COLOR_GRAY2BGR);
  image.seen = cv::Rect({0, 0}, label.size());
  return image;
}

/// Why the only blob is no building; empty when it is one.
std::string Refusal(const cv::Mat1b& label, const Image& image) {
  const JudgedOutlines judged = JudgeOutlines(TraceOutlines({label, {"red"}}, image.seen, {}), image);
  EXPECT_EQ(judged.buildings.size() + judged.refused.size(), 1U);
  return judged.refused.empty() ? "" : judged.refused[0].reason;
}

TEST(JudgeOutlines, KeepsBuildingsInHazeAndNoise) {
  const cv::Mat1b label = DrawSlanted();
  EXPECT_EQ(Refusal(label, Textured(label, 100.0, 15.0, 1)), "");
  EXPECT_EQ(Refusal(label, Textured(label, 20.0, 5.0, 1)), "");
  EXPECT_EQ(Refusal(label, Textured(label, 60.0, 10.0, 8)), "");
}

TEST(JudgeOutlines, KeepsRoundBuildingsOfAnySize) {
  for (const double radius : {12.0, 60.0, 200.0}) {
    const auto size = static_cast<int>(2.0 * radius + 40.0);
    const cv::Mat1b label = DrawDisc(radius, size);
    EXPECT_EQ(Refusal(label, Textured(label, 100.0, 5.0, 1)), "") << radius;
  }
}

TEST(JudgeOutlines, KeepsWhatTheEdgeOfThePictureCuts) {
  cv::Mat1b label(200, 200, uchar{0});
  label(cv::Rect(0, 0, 200, 60)) = 1;
  EXPECT_EQ(Refusal(label, Textured(label, 100.0, 5.0, 1)), "");
}

TEST(JudgeOutlines, RefusesWhatIsRagged) {
  cv::RNG random(11);
  cv::Mat1b label(400, 400, uchar{0});
  cv::circle(label, {200, 200}, 110, cv::Scalar(1), -1);
  for (int i = 0; i < 300; ++i) {  // Leaves.
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const cv::Point at(200 + static_cast<int>(115 * std::cos(angle)),
                       200 + static_cast<int>(115 * std::sin(angle)));
    cv::circle(label, at, random.uniform(3, 9), cv::Scalar(i % 2), -1);
  }
  EXPECT_THAT(Refusal(label, Textured(label, 100.0, 5.0, 1)), HasSubstr("ragged"));
}

TEST(JudgeOutlines, RefusesAPatchThatDiffersNoMoreThanItsSurroundings) {
  const cv::Mat1b label = DrawSlanted();
  EXPECT_THAT(Refusal(label, Textured(label, 0.0, 15.0, 1)), HasSubstr("no edge"));
  EXPECT_THAT(Refusal(label, Textured(label, 40.0, 30.0, 8)), HasSubstr("no edge"));
}

TEST(JudgeOutlines, RefusesNothingForLackOfAPictureAroundIt) {
  cv::Mat1b label(60, 60, uchar{1});
  EXPECT_EQ(Refusal(label, Textured(label, 0.0, 0.0, 1)), "");
}

}  // namespace
}  // namespace soffit
