#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "service/edge/drawing/overlay.h"
#include "service/edge/drawing/scene_picture.h"
#include "service/edge/drawing/top_view.h"
#include "test/support/arch_scene.h"

namespace soffit {
namespace {

int CountOf(const cv::Mat3b& picture, const cv::Scalar& color) {
  cv::Mat1b same;
  cv::inRange(picture, color, color, same);
  return cv::countNonZero(same);
}

TEST(DrawOverlay, ShowsTheWantedBuildingItsOpeningsAndTheCorridor) {
  const Drawing drawing = DrawOverlay(test::ArchObservations()[1], test::ArchUnderstanding());
  EXPECT_EQ(drawing.picture.size(), cv::Size(640, 480));
  EXPECT_GT(CountOf(drawing.picture, ink::kYellow), 100);
  EXPECT_GT(CountOf(drawing.picture, ink::kGreen), 100);
  EXPECT_GT(CountOf(drawing.picture, ink::kBlue), 100);
  EXPECT_EQ(CountOf(drawing.picture, ink::kVermilion), 0);
}

TEST(DrawOverlay, DashesARefusedCorridorInAnotherColorAndGivesTheReason) {
  Understanding all = test::ArchUnderstanding();
  all.decisions[0].verdict = Verdict::kBlocked;
  all.decisions[0].reason = "too low by 0.05 m";
  const Drawing drawing = DrawOverlay(test::ArchObservations()[1], all);
  EXPECT_EQ(CountOf(drawing.picture, ink::kBlue), 0);
  EXPECT_GT(CountOf(drawing.picture, ink::kVermilion), 50);
  EXPECT_THAT(drawing.lines, testing::Contains(testing::HasSubstr("too low by 0.05 m")));
}

TEST(DrawOverlay, DrawsNothingOfWhatLiesBehindTheCamera) {
  std::vector<Observation> observations = test::ArchObservations();
  observations[1].image.view.map_from_camera.rotation = CameraAttitude(-1.5707963, 0.0);
  const Drawing drawing = DrawOverlay(observations[1], test::ArchUnderstanding());
  EXPECT_EQ(CountOf(drawing.picture, ink::kYellow), 0);
  EXPECT_EQ(CountOf(drawing.picture, ink::kGreen), 0);
}

TEST(DrawTopView, CanBeDrawnOfAnEmptyScene) {
  Understanding all;
  all.scene.octree = std::make_shared<octomap::OcTree>(0.1);
  EXPECT_FALSE(DrawTopView(all, {}, {}).picture.empty());
  EXPECT_FALSE(DrawScenePicture(all, {}, {}, {64, 48}).picture.empty());
}

TEST(DrawTopView, TellsFreeUnknownAndOccupiedApart) {
  const cv::Mat3b picture = DrawTopView(test::ArchUnderstanding(), test::ArchObservations(), {}).picture;
  EXPECT_GT(CountOf(picture, {250, 246, 236}), 100);
  EXPECT_GT(CountOf(picture, {205, 205, 205}), 1000);
  EXPECT_GT(CountOf(picture, {90, 90, 90}), 20);
}

TEST(DrawScenePicture, IsTheSameEachTime) {
  const std::vector<Eigen::Vector3d> track = {{2, -1.6, 3}, {2, -1.6, 0.7}, {2, 3.1, 0.7}};
  const Understanding all = test::ArchUnderstanding();
  const auto draw = [&] {
    return DrawScenePicture(all, test::ArchObservations(), track, {320, 240}).picture;
  };
  const cv::Mat3b first = draw();
  EXPECT_EQ(cv::norm(first, draw(), cv::NORM_INF), 0.0);
  EXPECT_GT(CountOf(first, ink::kOrange), 20);
}

TEST(AddCaption, PutsTextBelowThePictureAndNotOverIt) {
  const cv::Mat3b picture(300, 400, cv::Vec3b(10, 20, 30));
  const cv::Mat3b sheet =
      AddCaption({picture, "title", {std::string(300, 'x') + " " + std::string(300, 'y')}, {}});
  EXPECT_EQ(sheet.cols, 400);
  EXPECT_GT(sheet.rows, 340);
  EXPECT_EQ(cv::norm(sheet(cv::Rect(0, 0, 400, 300)), picture, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace soffit
