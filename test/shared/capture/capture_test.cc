#include "shared/capture/capture.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace soffit {
namespace {

View LevelView() {
  View view;
  view.intrinsics = {1280, 960, 850, 850, 631.2, 482.8, {}};
  view.map_from_camera = {CameraAttitude(0.0, 0.0), {0, 0, 2}};
  return view;
}

TEST(IsValid, RefusesADefaultAndANotFiniteCamera) {
  EXPECT_FALSE(IsValid(Intrinsics{}));
  Intrinsics intrinsics = LevelView().intrinsics;
  EXPECT_TRUE(IsValid(intrinsics));
  intrinsics.distortion[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(IsValid(intrinsics));
}

TEST(Project, PutsThePointAheadOnThePrincipalPointAndHigherPointsAbove) {
  const View view = LevelView();
  EXPECT_LT((*Project(view, {10, 0, 2}) - Eigen::Vector2d(631.2, 482.8)).norm(), 1e-9);
  EXPECT_LT(Project(view, {10, 0, 3})->y(), 482.8);
  EXPECT_GT(Project(view, {10, -1, 2})->x(), 631.2);
}

TEST(Project, GivesNothingForPointsBehindTheCamera) {
  EXPECT_FALSE(Project(LevelView(), {-1, 0, 2}));
  EXPECT_FALSE(Project(LevelView(), {0, 0, 2}));
}

TEST(RayDirection, LeadsBackToTheProjectedPoint) {
  const View view = LevelView();
  const Eigen::Vector3d point(7, 1.5, 0.4);
  const Eigen::Vector3d along = RayDirection(view, *Project(view, point));
  EXPECT_LT((view.map_from_camera.translation_m +
             along * (point - view.map_from_camera.translation_m).norm() - point)
                .norm(),
            1e-9);
}

TEST(MeetHorizontalPlane, GivesTheGroundBelowTheHorizonOnly) {
  const View view = LevelView();
  EXPECT_FALSE(MeetHorizontalPlane(view, {631.2, 100.0}, 0.0));
  EXPECT_FALSE(MeetHorizontalPlane(view, {631.2, 482.8}, 0.0));
  const auto ground = MeetHorizontalPlane(view, {631.2, 482.8 + 85.0}, 0.0);
  ASSERT_TRUE(ground);
  EXPECT_NEAR(ground->x(), 20.0, 1e-9);
}

TEST(PurposeFromString, ReadsWhatToStringWrites) {
  for (const Purpose purpose : {Purpose::kOverview, Purpose::kTop, Purpose::kWall, Purpose::kCorridor}) {
    EXPECT_EQ(PurposeFromString(ToString(purpose)), purpose);
  }
  EXPECT_FALSE(PurposeFromString("unknown"));
  EXPECT_FALSE(PurposeFromString("Overview"));
}

}  // namespace
}  // namespace soffit
