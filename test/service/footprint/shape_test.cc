#include "service/footprint/shape.h"

#include <gmock/gmock.h>

#include <numbers>

#include "service/footprint/wireframe.h"
#include "test/support/aerial_world.h"

namespace soffit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::Box;
using test::LookDown;
using test::RelativeDifference;
using test::Turned;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

const Ring kRing = Turned(Box(4.2, 1.8), 0.4, {1.2, 0.3});

Massing Built(const Ring& ring, const std::vector<Level>& levels) { return {{ring}, levels, {}}; }

View LookLevel(double yaw_rad, const Vector2d& at, double distance_m) {
  View view = LookDown({0, 0, 1});
  const Vector2d from = at - distance_m * Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
  view.map_from_camera = {CameraAttitude(yaw_rad, 0.0), {from.x(), from.y(), 1.3}};
  return view;
}

Mask Photograph(const View& view, const Massing& massing) {
  Mask mask;
  mask.classes = {"red"};
  mask.confidence = 1.0;
  mask.label = cv::Mat1b(view.intrinsics.height_px, view.intrinsics.width_px, uchar{0});
  const Wireframe frame = FrameOf(massing);
  for (const auto& face : frame.faces) {
    std::vector<Vector3d> corners;
    for (const std::size_t corner : face.front()) corners.push_back(frame.corners[corner].in_map_m);
    test::FillFace(mask.label, view, corners);
  }
  return mask;
}

/// What two pictures from above and four from beside show of a building; `turn_rad`: by how much the cameras
/// are turned from where they are believed to be.
struct Shown {
  Footprint footprint;
  std::vector<Silhouette> beside;
};

Shown Show(const Massing& massing, double turn_rad = 0.0, int sides = 4) {
  const auto turned = [&](View view, int i) {
    const Vector3d axis = Vector3d(std::cos(i), std::sin(2.0 * i), std::cos(3.0 * i)).normalized();
    view.map_from_camera.rotation = Eigen::AngleAxisd(turn_rad, axis) * view.map_from_camera.rotation;
    return view;
  };
  const auto believed = [&](View view) {
    view.orientation_std_rad = turn_rad;
    return view;
  };
  Shown shown;
  std::vector<Footprint> map;
  std::uint32_t id = 0;
  for (const View& view : {LookDown({0, 0, 9}), LookDown({1.3, 0.2, 7}, 1.9)}) {
    const Mask mask = Photograph(turned(view, static_cast<int>(++id)), massing);
    Image image;
    image.capture_id = id;
    image.view = believed(view);
    image.seen = cv::Rect({0, 0}, mask.label.size());
    map = MergeFootprints(map, TraceFootprints(image, TraceOutlines(mask, image.seen, {}), {}));
  }
  shown.footprint = map.front();
  for (int i = 0; i < sides; ++i) {
    const View view = LookLevel(0.45 + i * std::numbers::pi / 2, {1.2, 0.3}, 6.0);
    const Mask mask = Photograph(turned(view, static_cast<int>(++id)), massing);
    for (const Outline& outline : TraceOutlines(mask, cv::Rect({0, 0}, mask.label.size()), {}))
      shown.beside.push_back({id, believed(view), outline});
  }
  return shown;
}

double MostInset(const Footprint& footprint) {
  const std::vector<double>& roof = footprint.levels.back().inset_m;
  return *std::max_element(roof.begin(), roof.end());
}

TEST(ShapeBuilding, LeavesAPrismAlone) {
  const Shown shown = Show(Built(kRing, {{2.3, {0, 0, 0, 0}}}));
  EXPECT_FALSE(ShapeBuilding(shown.footprint, shown.beside).has_value());
}

TEST(ShapeBuilding, LeavesAPrismAloneThatIsSeenWithNoise) {
  const Shown shown = Show(Built(kRing, {{2.3, {0, 0, 0, 0}}}), 0.014);
  EXPECT_FALSE(ShapeBuilding(shown.footprint, shown.beside).has_value());
}

TEST(ShapeBuilding, FindsATowerSetBackOnAllSides) {
  const Shown shown =
      Show(Built(kRing, {{1.6, {0, 0, 0, 0}}, {1.6, {0.4, 1.0, 0.5, 0.9}}, {2.8, {0.4, 1.0, 0.5, 0.9}}}));
  const auto shaping = ShapeBuilding(shown.footprint, shown.beside);
  ASSERT_TRUE(shaping.has_value());
  const Footprint& found = shaping->footprint;
  EXPECT_NEAR(found.height_m, 2.8, 0.02);
  EXPECT_LT(RelativeDifference(kRing, found.polygon_in_map_m.outer), 0.015);
  ASSERT_THAT(found.levels, SizeIs(3));
  EXPECT_NEAR(found.levels[0].height_m, 1.6, 0.02);
  EXPECT_THAT(found.levels[0].inset_m, Each(0.0));
  EXPECT_NEAR(MostInset(found), 1.0, 0.02);
  EXPECT_THAT(shaping->beside, SizeIs(4));
}

TEST(ShapeBuilding, FindsTheLowerWing) {
  const Shown shown = Show(Built(kRing, {{1.5, {0, 0, 0, 0}}, {1.5, {0, 2.2, 0, 0}}, {2.6, {0, 2.2, 0, 0}}}));
  const auto shaping = ShapeBuilding(shown.footprint, shown.beside);
  ASSERT_TRUE(shaping.has_value());
  EXPECT_LT(RelativeDifference(kRing, shaping->footprint.polygon_in_map_m.outer), 0.015);
  EXPECT_NEAR(MostInset(shaping->footprint), 2.2, 0.03);
  EXPECT_NEAR(shaping->footprint.height_m, 2.6, 0.02);
}

TEST(ShapeBuilding, FindsTheRidgeOfAGable) {
  const Shown shown = Show(Built(kRing, {{1.6, {0, 0, 0, 0}}, {2.5, {0.9, 0, 0.9, 0}}}));
  const auto shaping = ShapeBuilding(shown.footprint, shown.beside);
  ASSERT_TRUE(shaping.has_value());
  EXPECT_LT(RelativeDifference(kRing, shaping->footprint.polygon_in_map_m.outer), 0.015);
  EXPECT_NEAR(shaping->footprint.height_m, 2.5, 0.03);
  EXPECT_NEAR(MostInset(shaping->footprint), 0.9, 0.03);
  EXPECT_NEAR(InsetAt(shaping->footprint.levels, 0, 1.6) + InsetAt(shaping->footprint.levels, 1, 1.6), 0.0,
              0.03);
}

TEST(ShapeBuilding, FindsWallsThatLeanThoughThePosesAreOff) {
  const double inset_m = 2.3 * std::tan(10.0 * std::numbers::pi / 180.0);
  const Shown shown = Show(Built(kRing, {{2.3, std::vector<double>(4, inset_m)}}), 0.014);
  const auto shaping = ShapeBuilding(shown.footprint, shown.beside);
  ASSERT_TRUE(shaping.has_value());
  EXPECT_LT(RelativeDifference(kRing, shaping->footprint.polygon_in_map_m.outer), 0.05);
  EXPECT_NEAR(shaping->footprint.height_m, 2.3, 0.08);
  for (const double found_m : shaping->footprint.levels.back().inset_m) EXPECT_NEAR(found_m, inset_m, 0.08);
}

TEST(ShapeBuilding, FindsAGableOnAHouseWithACutCornerThatIsHighForTheCamera) {
  const Ring ring = Turned({{-2.1, -0.9}, {2.1, -0.9}, {2.1, 0.1}, {1.1, 0.9}, {-2.1, 0.9}}, 0.4, {1.2, 0.3});
  const Shown shown = Show(Built(ring, {{2.1, {0, 0, 0, 0, 0}}, {2.8, {0.8, 0, 0, 0.8, 0}}}));
  const auto shaping = ShapeBuilding(shown.footprint, shown.beside);
  ASSERT_TRUE(shaping.has_value());
  EXPECT_LT(RelativeDifference(ring, shaping->footprint.polygon_in_map_m.outer), 0.02);
}

TEST(ShapeBuilding, AsksForTwoPicturesFromBeside) {
  const Shown shown = Show(Built(kRing, {{1.6, {0, 0, 0, 0}}, {2.5, {0.9, 0, 0.9, 0}}}), 0.0, 1);
  EXPECT_FALSE(ShapeBuilding(shown.footprint, shown.beside).has_value());
  EXPECT_FALSE(ShapeBuilding(shown.footprint, {}).has_value());
}

}  // namespace
}  // namespace soffit
