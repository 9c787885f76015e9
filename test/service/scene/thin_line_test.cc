#include "service/scene/thin_line.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "test/support/painted_world.h"

namespace soffit {
namespace {

const cv::Vec3b kDark(40, 45, 42);

/// The thin lines of the first of some pictures of an arch; what else is there is not in the model.
cv::Mat1b Find(const std::vector<View>& views, const std::vector<test::Thing>& others) {
  std::vector<test::Thing> things = {test::Arch{}.thing()};
  things.insert(things.end(), others.begin(), others.end());
  ThinLines lines;
  for (const Sight& sight : test::Look(views, things).sights)
    lines.Add(sight, Predict(sight.view, {&things.front().mesh}));
  return lines.Settle(0);
}

int CountLines(const cv::Mat1b& marks) {
  return static_cast<int>(std::count(marks.begin(), marks.end(), static_cast<uchar>(LineMark::kLine)));
}

bool IsShownAt(const cv::Mat1b& lines, const View& view, const Eigen::Vector3d& place) {
  const Eigen::Vector2d pixel = Project(view, place).value();
  return lines(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x()))) ==
         static_cast<uchar>(LineMark::kLine);
}

test::Thing Rod(double x0, double y0, double x1, double y1, double low_m, double high_m) {
  return test::Block(test::Box(x0, y0, x1, y1), low_m, high_m, kDark);
}

TEST(ThinLines, AreNoneWhereThePassageIsFree) { EXPECT_EQ(CountLines(Find({test::FromSouth()}, {})), 0); }

TEST(ThinLines, AreACableThatHangsInThePassageUpToTheModel) {
  const View view = test::FromSouth();
  const cv::Mat1b lines = Find({view}, {Rod(0.19, -0.01, 0.21, 0.01, 0.4, 1.5)});
  for (const double z : {0.5, 0.8, 1.1}) EXPECT_TRUE(IsShownAt(lines, view, {0.2, 0.0, z})) << z;
  EXPECT_FALSE(IsShownAt(lines, view, {0.3, 0.0, 0.8}));
}

TEST(ThinLines, AreARopeFromJambToJamb) {
  const View view = test::FromSouth();
  const cv::Mat1b lines = Find({view}, {Rod(-0.8, -0.01, 0.8, 0.01, 0.72, 0.74)});
  for (const double x : {-0.5, 0.0, 0.5}) EXPECT_TRUE(IsShownAt(lines, view, {x, 0.0, 0.73})) << x;
}

TEST(ThinLines, AreASlimPoleThatStandsFree) {
  const View view = test::FromSouth();
  const cv::Mat1b lines = Find({view}, {Rod(2.5, -1.01, 2.52, -0.99, 0.0, 1.0)});
  EXPECT_TRUE(IsShownAt(lines, view, {2.51, -1.0, 0.5}));
}

TEST(ThinLines, MayHideAtTheHorizon) {
  const View view = test::FromSouth();
  const Eigen::Vector2d far = Project(view, {0.0, 5000.0, 0.0}).value();
  const cv::Mat1b marks = Find({view}, {});
  EXPECT_EQ(marks(static_cast<int>(std::lround(far.y())), static_cast<int>(std::lround(far.x()))),
            static_cast<uchar>(LineMark::kTrace));
}

TEST(ThinLines, AreNoMarksOfTheGroundThatAnotherPictureShowsThereToo) {
  const View view = test::FromSouth();
  const test::Thing joint = Rod(0.2, -3.5, 0.23, -0.8, 0.0, 0.001);
  EXPECT_GT(CountLines(Find({view}, {joint})), 0);
  const View besides = test::LevelView({3.5, -3.0, 1.1}, 2.4);
  EXPECT_EQ(CountLines(Find({view, besides}, {joint})), 0);
}

TEST(ThinLines, AreNotWhatTheModelInterrupts) {
  const View view = test::FromSouth();
  const test::Thing far_rope = Rod(-20.0, 9.99, 20.0, 10.04, 0.7, 0.76);
  EXPECT_EQ(CountLines(Find({view}, {far_rope})), 0);
  EXPECT_GT(CountLines(Find({view}, {Rod(-2.0, 9.99, 2.5, 10.04, 0.7, 0.76)})), 0)
      << "it might be in the passage";
}

TEST(ThinLines, AreNotLookedForInPicturesFromAbove) {
  View view = test::LevelView({0.0, 0.0, 6.0}, 0.0);
  view.map_from_camera.rotation = CameraAttitude(0.0, -1.57);
  EXPECT_EQ(CountLines(Find({view}, {Rod(2.5, -1.0, 2.53, 1.0, 0.0, 0.01)})), 0);
}

}  // namespace
}  // namespace soffit
