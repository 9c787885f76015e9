#include "service/pipeline/pipeline.h"

#include <gmock/gmock.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr VehicleEnvelope kVehicle{0.35, 0.30, 0.25};

/// A picture from 9 m straight above, north up: shapes on grey.
Capture Overview(const std::vector<std::pair<std::vector<cv::Point>, cv::Scalar>>& shapes) {
  cv::Mat3b picture(480, 640, cv::Vec3b(120, 130, 125));
  for (const auto& [shape, color] : shapes)
    cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{shape}, color);
  Capture capture;
  capture.capture_id = 1;
  capture.name = "overview.png";
  capture.purpose = Purpose::kOverview;
  capture.intrinsics = {640, 480, 425.0, 425.0, 319.5, 239.5, {}};
  capture.map_from_camera = {CameraAttitude(1.5707963267948966, -1.5707963267948966), {0.0, 0.0, 9.0}};
  capture.has_trusted_pose = true;
  cv::imencode(".png", picture, capture.bytes);
  return capture;
}

using Shapes = std::vector<std::pair<std::vector<cv::Point>, cv::Scalar>>;

/// The same from `east_px` pixels farther to the east.
Observation SeenFromTheEast(int east_px, std::uint32_t capture_id, Shapes shapes) {
  for (auto& [shape, color] : shapes) {
    for (cv::Point& corner : shape) corner.x -= east_px;
  }
  Capture capture = Overview(shapes);
  capture.capture_id = capture_id;
  capture.map_from_camera.translation_m.x() = east_px * 9.0 / capture.intrinsics.fx_px;
  return Observe(capture, {}).value();
}

const cv::Scalar kRed(40, 30, 200);

/// An L that has no mirror symmetry, with its corner at (x, y).
std::vector<cv::Point> L(int x, int y) {
  return {{x, y}, {x + 120, y}, {x + 120, y + 40}, {x + 50, y + 40}, {x + 50, y + 160}, {x, y + 160}};
}

Reference ReferenceOfL() {
  cv::Mat1b bitmap(120, 120, uchar{255});
  std::vector<cv::Point> shape = L(40, 20);
  for (cv::Point& corner : shape) corner = {20 + (corner.x - 40) / 2, 10 + (corner.y - 20) / 2};
  cv::fillPoly(bitmap, std::vector<std::vector<cv::Point>>{shape}, cv::Scalar(0));
  return ReadReference(bitmap).value();
}

std::vector<Observation> Seen(const Capture& capture) {
  const Result<Observation> seen = Observe(capture, {});
  EXPECT_TRUE(seen.ok());
  return {seen.value()};
}

TEST(Observe, NamesThePictureThatDoesNotDecode) {
  Capture capture = Overview({});
  capture.bytes.resize(capture.bytes.size() / 2);
  const Result<Observation> seen = Observe(capture, {});
  ASSERT_FALSE(seen.ok());
  EXPECT_THAT(seen.error().message, HasSubstr("overview.png"));
}

TEST(Observe, GivesAnErrorWhenATopPictureDoesNotLookDown) {
  Capture capture = Overview({{L(100, 100), kRed}});
  capture.map_from_camera.rotation = CameraAttitude(0.0, 0.0);
  const Result<Observation> seen = Observe(capture, {});
  ASSERT_FALSE(seen.ok());
  EXPECT_THAT(seen.error().message, HasSubstr("overview.png"));
}

TEST(Observe, TakesNoRaggedPatchForABuilding) {
  std::vector<cv::Point> patch;
  for (int i = 0; i < 80; ++i) {
    const double radius_px = i % 2 == 0 ? 100.0 : 80.0 + 7.0 * (i % 3);
    patch.emplace_back(300 + static_cast<int>(radius_px * std::cos(0.0785398 * i)),
                       240 + static_cast<int>(radius_px * std::sin(0.0785398 * i)));
  }
  const Observation seen = Seen(Overview({{patch, kRed}})).front();
  EXPECT_THAT(seen.outlines, IsEmpty());
  EXPECT_THAT(seen.footprints, IsEmpty());
  ASSERT_THAT(seen.refused, SizeIs(1));
  EXPECT_THAT(seen.refused.front().reason, HasSubstr("ragged"));
}

TEST(Understand, MakesNoDecisionFromNothing) {
  const Understanding all = Understand({}, ReferenceOfL(), kVehicle, 3, {});
  EXPECT_THAT(all.decisions, IsEmpty());
  EXPECT_THAT(all.problems, ElementsAre(HasSubstr("not among those that were seen")));
  EXPECT_NE(all.scene.octree, nullptr);
  EXPECT_EQ(all.scene.revision, 3U);
}

TEST(Understand, MarksTheWantedBuildingAmongOthers) {
  const std::vector<cv::Point> box = {{400, 120}, {520, 120}, {520, 200}, {400, 200}};
  const Understanding all =
      Understand(Seen(Overview({{L(100, 200), kRed}, {box, kRed}})), ReferenceOfL(), kVehicle, 1, {});
  ASSERT_THAT(all.scene.objects, SizeIs(2));
  const auto is_matched = [](const SceneObject& object) { return object.is_matched; };
  ASSERT_EQ(std::count_if(all.scene.objects.begin(), all.scene.objects.end(), is_matched), 1);
  const SceneObject& wanted = *std::find_if(all.scene.objects.begin(), all.scene.objects.end(), is_matched);
  EXPECT_EQ(wanted.footprint.polygon_in_map_m.outer.size(), 6U);
  EXPECT_LT(Centroid(wanted.footprint.polygon_in_map_m).x(), 0.0);
}

TEST(Understand, PutsSeveralOverviewsIntoOneMap) {
  const std::vector<cv::Point> box = {{40, 120}, {140, 120}, {140, 200}, {40, 200}};
  const Shapes shapes = {{L(860, 180), kRed}, {box, kRed}};
  const Understanding all = Understand({SeenFromTheEast(0, 1, shapes), SeenFromTheEast(400, 2, shapes)},
                                       ReferenceOfL(), kVehicle, 1, {});
  ASSERT_THAT(all.scene.objects, SizeIs(2));
  EXPECT_FALSE(all.scene.objects[0].is_matched);
  EXPECT_TRUE(all.scene.objects[1].is_matched);
  EXPECT_THAT(all.scene.objects[1].footprint.captures, ElementsAre(2));
}

TEST(Understand, RecognizesWhatOneOverviewCutsAndAnotherShowsWhole) {
  const Shapes shapes = {{L(560, 180), kRed}};
  const Observation cut = SeenFromTheEast(0, 1, shapes);
  EXPECT_THAT(Understand({cut}, ReferenceOfL(), kVehicle, 1, {}).matches, IsEmpty());
  const Understanding all =
      Understand({cut, SeenFromTheEast(300, 2, shapes)}, ReferenceOfL(), kVehicle, 1, {});
  ASSERT_THAT(all.scene.objects, SizeIs(1));
  EXPECT_TRUE(all.scene.objects[0].is_matched);
  EXPECT_FALSE(all.scene.objects[0].footprint.is_cut);
}

TEST(Understand, NeverClearsWhatWasOnlySeenFromAbove) {
  const Understanding all =
      Understand(Seen(Overview({{L(250, 150), kRed}})), ReferenceOfL(), kVehicle, 9, {});
  ASSERT_FALSE(all.decisions.empty());
  for (const ClearanceDecision& decision : all.decisions) {
    EXPECT_EQ(decision.verdict, Verdict::kInsufficientData) << decision.reason;
    EXPECT_EQ(decision.scene_revision, 9U);
  }
}

TEST(Understand, DoesNotGuessBetweenTwoBuildingsThatFitAlike) {
  const Understanding all =
      Understand(Seen(Overview({{L(100, 200), kRed}, {L(400, 200), kRed}})), ReferenceOfL(), kVehicle, 1, {});
  EXPECT_THAT(all.matches, SizeIs(2));
  EXPECT_THAT(all.decisions, IsEmpty());
  EXPECT_THAT(all.problems, ElementsAre(HasSubstr("matches: 2")));
  for (const SceneObject& object : all.scene.objects) EXPECT_FALSE(object.is_matched);
}

TEST(Understand, DoesNotTakeTheMirroredBuilding) {
  std::vector<cv::Point> mirrored = L(100, 200);
  for (cv::Point& corner : mirrored) corner.x = 640 - corner.x;
  const Understanding all = Understand(Seen(Overview({{mirrored, kRed}})), ReferenceOfL(), kVehicle, 1, {});
  EXPECT_THAT(all.matches, IsEmpty());
  EXPECT_THAT(all.decisions, IsEmpty());
}

}  // namespace
}  // namespace soffit
