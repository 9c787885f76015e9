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

TEST(DrawOverlay, ShowsObstaclesWhereNoModelHidesThem) {
  Understanding all = test::ArchUnderstanding();
  const auto count = [&] {
    return CountOf(DrawOverlay(test::ArchObservations()[1], all).picture, ink::kOrange);
  };
  all.scene.obstacles = {{{0.5, 5.0, 0.0}, 0.2, 1.5, true, 0.01, {}}};
  EXPECT_EQ(count(), 0) << "behind the arch";
  all.scene.obstacles[0].base_in_map_m.y() = -1.5;
  EXPECT_GT(count(), 50);
}

TEST(DrawOverlay, TellsWhatAnOpeningWasTakenForAndWhy) {
  Understanding all = test::ArchUnderstanding();
  Facade wall;
  wall.object_id = 1;
  wall.side = 0;
  Opening opening;
  opening.ring_in_wall_m = {{1.2, 0}, {2.8, 0}, {2.8, 1.4}, {1.2, 1.4}};
  opening.evidence = "sky or ground in 0.01 of what is seen through it";
  opening.recess = Recess{opening.ring_in_wall_m, 0.3, 0.01};
  opening.captures = {2};
  wall.openings = {opening};
  all.facades = {wall};
  EXPECT_THAT(DrawOverlay(test::ArchObservations()[1], all).lines,
              testing::Contains("opening 0.1: a recess, 0.30 m deep: sky or ground in 0.01 of what is seen "
                                "through it"));
  EXPECT_THAT(DrawOverlay(test::ArchObservations()[0], all).lines,
              testing::Not(testing::Contains(testing::HasSubstr("opening 0.1"))));
}

TEST(DrawOverlay, TellsWhatWouldSettleItInTheCoordinatesThatPeopleAreTold) {
  Understanding all = test::ArchUnderstanding();
  all.scene.map_origin_m = {691000, 5335000, 0};
  all.decisions[0].wanted = Viewpoint{Purpose::kWall, {1, 2, 3}, 0.0, 0.0, 1, 2, "the far side"};
  EXPECT_THAT(
      DrawOverlay(test::ArchObservations()[1], all).lines,
      testing::Contains("A picture would settle it, from (691001.00, 5335002.00, 3.00): the far side"));
}

TEST(DrawOverlay, DrawsAsThePictureWasAdjusted) {
  Understanding all = test::ArchUnderstanding();
  std::vector<Observation> observations = test::ArchObservations();
  const cv::Mat3b expected = DrawOverlay(observations[1], all).picture;
  all.views[2] = observations[1].image.view;
  observations[1].image.view.map_from_camera.translation_m.x() += 0.3;
  EXPECT_EQ(cv::norm(DrawOverlay(observations[1], all).picture, expected, cv::NORM_INF), 0.0);
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
