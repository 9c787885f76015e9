#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include "service/edge/ros/camera_messages.h"
#include "service/edge/ros/frame_messages.h"
#include "service/edge/ros/marker_messages.h"
#include "service/edge/ros/octomap_message.h"
#include "service/edge/ros/path_message.h"
#include "test/support/arch_scene.h"

namespace soffit::ros {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
namespace constants = visualization_msgs::msg::dds_::Marker_Constants;

constexpr std::int64_t kStamp = 1'700'000'000'123'456'789;

// ---- OctoMap ----

std::map<std::array<float, 3>, bool> Leaves(const octomap::OcTree& tree) {
  std::map<std::array<float, 3>, bool> leaves;
  for (auto it = tree.begin_leafs(); it != tree.end_leafs(); ++it) {
    const octomap::point3d center = it.getCoordinate();
    leaves[{center.x(), center.y(), center.z()}] = tree.isNodeOccupied(*it);
  }
  return leaves;
}

TEST(MakeBinaryOctomap, IsReadBackByOctoMapWithTheSameCells) {
  const auto scene = test::ArchUnderstanding().scene;
  const Octomap_ message = MakeBinaryOctomap(*scene.octree, kStamp);
  EXPECT_TRUE(message.binary_());
  EXPECT_EQ(message.id_(), "OcTree");
  EXPECT_EQ(message.header_().frame_id_(), "map");
  octomap::OcTree read(message.resolution_());
  std::stringstream data(std::string(message.data_().begin(), message.data_().end()));
  read.readBinaryData(data);
  octomap::OcTree most_likely(*scene.octree);
  most_likely.toMaxLikelihood();
  EXPECT_EQ(Leaves(read), Leaves(most_likely));
}

TEST(MakeFullOctomap, IsReadBackByOctoMapAsTheSameTree) {
  const auto scene = test::ArchUnderstanding().scene;
  const Octomap_ message = MakeFullOctomap(*scene.octree, kStamp);
  EXPECT_FALSE(message.binary_());
  octomap::OcTree read(message.resolution_());
  std::stringstream data(std::string(message.data_().begin(), message.data_().end()));
  read.readData(data);
  EXPECT_TRUE(read == *scene.octree);
}

TEST(MakeBinaryOctomap, OfAnEmptyTreeHasNoData) {
  EXPECT_THAT(MakeBinaryOctomap(octomap::OcTree(0.2), kStamp).data_(), IsEmpty());
  EXPECT_THAT(MakeFullOctomap(octomap::OcTree(0.2), kStamp).data_(), IsEmpty());
}

// ---- Markers ----

std::vector<Marker_> Named(const MarkerArray_& all, const std::string& name) {
  std::vector<Marker_> found;
  for (const Marker_& marker : all.markers_()) {
    if (marker.ns_() == name && marker.action_() == constants::ADD_) found.push_back(marker);
  }
  return found;
}

TEST(MakeSceneMarkers, DeletesAllEarlierOnesFirst) {
  const auto all = MakeSceneMarkers(kStamp, Scene{}, {});
  ASSERT_THAT(all.markers_(), SizeIs(1));
  EXPECT_EQ(all.markers_()[0].action_(), constants::DELETEALL_);
}

TEST(MakeSceneMarkers, DrawsEverythingOfTheScene) {
  const auto arch = test::ArchUnderstanding();
  Scene scene = arch.scene;
  scene.obstacles = {{{1, -2, 0}, 0.2, 1.5, false, 0.01, {}}};
  const auto all = MakeSceneMarkers(kStamp, scene, arch.decisions);
  EXPECT_THAT(Named(all, "footprints"), SizeIs(4)) << "two buildings, on the ground and at the roof";
  ASSERT_THAT(Named(all, "models"), SizeIs(1));
  EXPECT_EQ(Named(all, "models")[0].points_().size(), 3 * scene.solids[0].mesh.triangles.size());
  EXPECT_THAT(Named(all, "openings"), SizeIs(2));
  ASSERT_THAT(Named(all, "obstacles"), SizeIs(1));
  EXPECT_DOUBLE_EQ(Named(all, "obstacles")[0].pose_().position_().z_(), 0.75);
  ASSERT_THAT(Named(all, "corridors"), SizeIs(1));
  EXPECT_THAT(Named(all, "corridors")[0].points_(), SizeIs(24)) << "twelve edges of a box";
  ASSERT_THAT(Named(all, "decisions"), SizeIs(1));
  EXPECT_EQ(
      Named(all, "decisions")[0].text_(),
      "CLEAR: clear by 0.20 m\nfree 1.60 x 1.40 m; margins left 0.20, right 0.20, up 0.30, down 0.30 m, "
      "least at the left; to occupied over 1.00 m, to unknown 0.35 m, to the model 0.45 m");
}

TEST(MakeSceneMarkers, GivesEveryMarkerAnIdAndAPoseThatViewersTake) {
  const auto arch = test::ArchUnderstanding();
  std::set<std::pair<std::string, int>> ids;
  for (const Marker_& marker : MakeSceneMarkers(kStamp, arch.scene, arch.decisions).markers_()) {
    EXPECT_TRUE(ids.emplace(marker.ns_(), marker.id_()).second) << marker.ns_() << marker.id_();
    EXPECT_EQ(marker.pose_().orientation_().w_(), 1.0);
    if (marker.type_() == constants::TRIANGLE_LIST_) {
      EXPECT_EQ(marker.points_().size() % 3, 0u);
    }
  }
}

TEST(MakeSceneMarkers, DrawsTheCorridorsFreeRectangleWhereItIs) {
  Corridor corridor;
  corridor.entry_in_map_m = {0, 0, 1.0};
  corridor.exit_in_map_m = {10, 0, 1.0};
  corridor.left_m = 0.5;
  corridor.free_width_m = 2.0;
  corridor.free_height_m = 1.5;
  corridor.floor_m = 0.25;
  ClearanceDecision decision;
  decision.corridor = corridor;
  const auto markers = Named(MakeSceneMarkers(kStamp, Scene{}, {decision}), "corridors");
  ASSERT_THAT(markers, SizeIs(1));
  Eigen::AlignedBox3d box;
  for (const auto& p : markers[0].points_()) box.extend(Eigen::Vector3d(p.x_(), p.y_(), p.z_()));
  EXPECT_TRUE(box.min().isApprox(Eigen::Vector3d(0, -1.5, 0.25))) << box.min().transpose();
  EXPECT_TRUE(box.max().isApprox(Eigen::Vector3d(10, 0.5, 1.75))) << box.max().transpose();
}

TEST(MakeSceneMarkers, FollowsTheBendsOfACorridor) {
  ClearanceDecision decision = test::ArchUnderstanding().decisions[0];
  decision.corridor->bends_in_map_m = {{2.2, 0.5, 0.7}, {2.0, 1.0, 0.7}};
  const auto all = MakeSceneMarkers(kStamp, Scene{}, {decision});
  ASSERT_THAT(Named(all, "corridor_paths"), SizeIs(1));
  EXPECT_THAT(Named(all, "corridor_paths")[0].points_(), SizeIs(4));
  EXPECT_THAT(Named(all, "corridors")[0].points_(), SizeIs(2 * (4 * 4 + 3 * 4)));
  EXPECT_THAT(MakeCorridorPath(kStamp, {decision}).poses_(), SizeIs(4));
}

TEST(MakeVoxelMarkers, ShowsOccupiedVoxelsAlone) {
  octomap::OcTree tree(0.1);
  tree.updateNode(octomap::point3d(0.05F, 0.05F, 0.05F), true);
  tree.updateNode(octomap::point3d(1.05F, 0.05F, 0.05F), false);
  const auto cubes = Named(MakeVoxelMarkers(kStamp, tree), "occupied");
  ASSERT_THAT(cubes, SizeIs(1));
  EXPECT_THAT(cubes[0].points_(), SizeIs(1));
  EXPECT_NEAR(cubes[0].scale_().x_(), 0.1, 1e-9);
}

// ---- Paths ----

TEST(MakePath, LooksAlongTheWay) {
  const Path_ path = MakePath(kStamp, {{0, 0, 1}, {0, 2, 1}});
  ASSERT_THAT(path.poses_(), SizeIs(2));
  for (const auto& pose : path.poses_())
    EXPECT_NEAR(pose.pose_().orientation_().z_(), std::sin(std::numbers::pi / 4), 1e-12);
  EXPECT_EQ(path.poses_()[1].pose_().position_().y_(), 2.0);
}

TEST(MakeCorridorPath, ShowsNoWayThatIsNotClear) {
  auto decisions = test::ArchUnderstanding().decisions;
  EXPECT_THAT(MakeCorridorPath(kStamp, decisions).poses_(), SizeIs(2));
  decisions[0].verdict = Verdict::kInsufficientData;
  EXPECT_THAT(MakeCorridorPath(kStamp, decisions).poses_(), IsEmpty());
}

// ---- Camera ----

Capture SomeCapture() {
  Capture capture;
  capture.vehicle_id = 3;
  capture.exposure_utc_ns = kStamp;
  capture.intrinsics = {640, 480, 500.0, 501.0, 320.5, 240.5, {0.1, 0.2, 0.3, 0.4, 0.5}};
  capture.map_from_camera.translation_m = {1, 2, 3};
  capture.bytes = {0xff, 0xd8, 0xff};
  return capture;
}

TEST(MakeCameraInfo, HoldsTheIntrinsicsAsRosOrdersThem) {
  const CameraInfo_ info = MakeCameraInfo(SomeCapture());
  EXPECT_EQ(info.distortion_model_(), "plumb_bob");
  EXPECT_THAT(info.d_(), ElementsAre(0.1, 0.2, 0.3, 0.4, 0.5));
  EXPECT_THAT(info.k_(), ElementsAre(500, 0, 320.5, 0, 501, 240.5, 0, 0, 1));
  EXPECT_THAT(info.p_(), ElementsAre(500, 0, 320.5, 0, 0, 501, 240.5, 0, 0, 0, 1, 0));
  EXPECT_EQ(info.width_(), 640u);
}

TEST(MakeCompressedImage, TellsTheFormatByTheFirstBytesAndFitsItsCameraInfo) {
  Capture capture = SomeCapture();
  const CompressedImage_ jpeg = MakeCompressedImage(capture);
  EXPECT_THAT(jpeg.format_(), HasSubstr("jpeg"));
  EXPECT_EQ(jpeg.header_(), MakeCameraInfo(capture).header_());
  EXPECT_EQ(jpeg.header_().stamp_().sec_(), 1'700'000'000);
  EXPECT_EQ(jpeg.header_().stamp_().nanosec_(), 123'456'789u);
  capture.bytes = {0x89, 'P', 'N', 'G'};
  EXPECT_THAT(MakeCompressedImage(capture).format_(), HasSubstr("png"));
}

TEST(MakeCameraTransform, PutsTheCameraWhereThePictureWasTaken) {
  const auto transform = MakeCameraTransform(SomeCapture()).transforms_().at(0);
  EXPECT_EQ(transform.header_().frame_id_(), "map");
  EXPECT_EQ(transform.child_frame_id_(), "vehicle_3/camera_optical_frame");
  EXPECT_EQ(transform.transform_().translation_().z_(), 3.0);
}

// ---- Frames ----

TEST(MakeEarthTransform, PutsTheMapOnTheEllipsoidWithEastNorthUp) {
  const auto transform = MakeEarthTransform(kStamp, {0.0, 90.0, 100.0}).transform_();
  EXPECT_NEAR(transform.translation_().y_(), 6378137.0 + 100.0, 1e-6);
  const Eigen::Quaterniond earth_from_map(transform.rotation_().w_(), transform.rotation_().x_(),
                                          transform.rotation_().y_(), transform.rotation_().z_());
  EXPECT_TRUE((earth_from_map * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitX(), 1e-9))
      << "east";
  EXPECT_TRUE((earth_from_map * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitZ(), 1e-9))
      << "north";
}

TEST(MakeObjectTransforms, NamesAFrameForEveryBuilding) {
  const auto transforms = MakeObjectTransforms(kStamp, 1, test::ArchUnderstanding().scene);
  ASSERT_THAT(transforms, SizeIs(2));
  EXPECT_EQ(transforms[0].child_frame_id_(), "vehicle_1/object_1");
  EXPECT_NEAR(transforms[0].transform_().translation_().x_(), 2.0, 1e-9);
  EXPECT_NEAR(transforms[0].transform_().rotation_().z_(), -std::sin(0.25), 1e-9) << "clockwise by 0.5 rad";
}

}  // namespace
}  // namespace soffit::ros
