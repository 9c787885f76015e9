// Several rendered overviews, through a lens and with noisy poses, make one map.

#include <gmock/gmock.h>

#include <numbers>

#include "service/pipeline/pipeline.h"
#include "test/sim/render/renderer.h"
#include "test/sim/survey/reference.h"
#include "test/sim/truth/truth.h"
#include "test/support/aerial_world.h"

namespace soffit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Of which 26 m by 20 m are seen from 20 m above.
constexpr const char* kStreet = R"(
title: A street that no single picture shows
ground: {color: [128, 126, 120], pattern: grass, grain_m: 2.4, contrast: 0.2}
camera: {width_px: 640, height_px: 480, fx_px: 480, distortion: [-0.06, 0.012, 0.0003, -0.0002, 0]}
vehicle: {radius_m: 0.35, height_m: 0.30, safety_margin_m: 0.25}
mission: {wanted: [WANTED], reference_m_per_px: 0.1, reference_rotation_cw_deg: 35, overview_altitude_m: 20}
buildings:
  - {id: hall, position: [0.5, 0], yaw_deg: 8, color: red, parts: [{polygon: [[-9, -2], [9, -2], [9, 2], [-4, 2], [-4, 5], [-9, 5]], z: [0, 3]}]}
  - {id: west, position: [-14, 1], yaw_deg: 30, color: blue, parts: [{box: {center: [0, 0], size: [3, 4]}, z: [0, 2]}]}
  - {id: middle, position: [1, -6], yaw_deg: -20, color: yellow, parts: [{box: {center: [0, 0], size: [3, 2]}, z: [0, 2]}]}
  - {id: east, position: [14, 2], yaw_deg: 10, color: blue, parts: [{box: {center: [0, 0], size: [3, 4]}, z: [0, 2.5]}]}
)";

sim::World Street(const std::string& wanted) {
  std::string yaml = kStreet;
  yaml.replace(yaml.find("WANTED"), 6, wanted);
  return sim::ParseWorld(yaml, "street", ".").value();
}

/// From above places of the map, 20 m up; poses err by centimetres and tenths of degrees.
std::vector<Observation> LookFrom(const sim::World& world, const std::vector<Vector2d>& places) {
  const sim::Renderer renderer(world, 2);
  std::vector<Observation> seen;
  for (const Vector2d& place : places) {
    Capture capture;
    capture.capture_id = static_cast<std::uint32_t>(seen.size() + 1);
    capture.purpose = Purpose::kOverview;
    capture.intrinsics = world.camera.intrinsics;
    capture.map_from_camera = {CameraAttitude(0.5 * std::numbers::pi, -0.5 * std::numbers::pi),
                               {place.x(), place.y(), 20.0}};
    capture.has_trusted_pose = true;
    capture.position_std_m = 0.05;
    capture.orientation_std_rad = 0.002;
    capture.bytes = sim::EncodeJpeg(renderer.Render({{capture.map_from_camera}, capture.capture_id}), 90, 0);
    const double sign = seen.size() % 2 == 0 ? 1.0 : -1.0;
    capture.map_from_camera.translation_m += sign * Vector3d(0.04, -0.05, 0.06);
    seen.push_back(Observe(capture, {}).value());
  }
  return seen;
}

Understanding UnderstandStreet(const sim::World& world, const std::vector<Observation>& seen) {
  PipelineOptions options;
  options.scene.voxel_m = 0.5;  // Only the map matters here.
  return Understand(seen, ReadReference(sim::DrawReference(world)).value(), world.vehicle, 1, options);
}

std::vector<const SceneObject*> Matched(const Understanding& all) {
  std::vector<const SceneObject*> matched;
  for (const SceneObject& object : all.scene.objects) {
    if (object.is_matched) matched.push_back(&object);
  }
  return matched;
}

TEST(SeveralOverviews, FindABuildingThatEachOfThemCuts) {
  const sim::World world = Street("hall");
  const std::vector<Observation> seen = LookFrom(world, {{-7, 0}, {8, 0}});
  for (const Observation& one : seen) EXPECT_THAT(Matched(UnderstandStreet(world, {one})), IsEmpty());
  const Understanding all = UnderstandStreet(world, seen);
  EXPECT_THAT(all.scene.objects, SizeIs(4));
  ASSERT_THAT(Matched(all), SizeIs(1));
  const Footprint& hall = Matched(all).front()->footprint;
  EXPECT_FALSE(hall.is_cut);
  EXPECT_THAT(hall.captures, ElementsAre(1, 2));
  EXPECT_THAT(hall.polygon_in_map_m.outer, SizeIs(6));
  const Polygon truth = sim::FindFootprint(world.buildings.front()).front();
  EXPECT_LT(test::RelativeDifference(truth.outer, hall.polygon_in_map_m.outer), 0.04);
  EXPECT_NEAR(hall.height_m, 3.0, 0.3);
}

TEST(SeveralOverviews, ShowEveryBuildingOnce) {
  const sim::World world = Street("hall");
  const Understanding all = UnderstandStreet(world, LookFrom(world, {{-7, 0}, {0, -2}, {8, 0}, {0, 3}}));
  ASSERT_THAT(all.scene.objects, SizeIs(4));
  for (const SceneObject& object : all.scene.objects) EXPECT_FALSE(object.footprint.is_cut);
}

TEST(SeveralOverviews, FindAGroupThatNoneOfThemShows) {
  const sim::World world = Street("west, middle, east");
  const std::vector<Observation> seen = LookFrom(world, {{-7, 0}, {8, 0}});
  EXPECT_THAT(Matched(UnderstandStreet(world, {seen[0]})), IsEmpty());
  EXPECT_THAT(Matched(UnderstandStreet(world, {seen[1]})), IsEmpty());
  EXPECT_THAT(Matched(UnderstandStreet(world, seen)), SizeIs(3));
}

}  // namespace
}  // namespace soffit
