#include "service/edge/ros/ros_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <condition_variable>

#include "shared/dds/reader.h"
#include "test/support/arch_scene.h"

namespace soffit {
namespace {

using namespace std::chrono_literals;

DdsOptions Loopback() {
  DdsOptions options;
  options.domain_id = 100 + static_cast<int>(getpid() % 100);
  options.udp_only = true;
  options.interfaces = {"127.0.0.1"};
  return options;
}

/// The newest message of one topic, for whoever joins late.
template <class Topic>
class Newest {
 public:
  Newest(const Participant& participant, const std::string& name)
      : reader_(
            participant,
            [this](typename Topic::Value message) {
              const std::lock_guard lock(mutex_);
              message_ = std::move(message);
              changed_.notify_all();
            },
            name) {}

  std::optional<typename Topic::Value> Await() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, 5s, [this] { return message_.has_value(); });
    return message_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<typename Topic::Value> message_;
  Reader<Topic> reader_;
};

class RosTopicsTest : public testing::Test {
 protected:
  Participant ground_ = Participant::Join("soffitd", Loopback(), {}).value();
  RosTopics topics_{ground_};
  Participant viewer_ = Participant::Join("rviz", Loopback(), {}).value();
};

TEST_F(RosTopicsTest, GiveTheLatestSceneToALateJoiner) {
  const auto arch = test::ArchUnderstanding();
  topics_.PublishScene(4, 1, Scene{}, {});
  topics_.PublishScene(4, 2, arch.scene, arch.decisions);
  topics_.PublishWaypoints(4, 2, {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}});
  Newest<ros::OctomapTopic> octomap(viewer_, "rt/soffit/vehicle_4/octomap_binary");
  Newest<ros::MarkersTopic> markers(viewer_, "rt/soffit/vehicle_4/scene");
  Newest<ros::PathTopic> corridor(viewer_, "rt/soffit/vehicle_4/corridor");
  Newest<ros::PathTopic> waypoints(viewer_, "rt/soffit/vehicle_4/waypoints");
  Newest<ros::StaticTransformTopic> frames(viewer_, "rt/tf_static");
  ASSERT_TRUE(octomap.Await().has_value());
  EXPECT_GT(octomap.Await()->data_().size(), 100u);
  ASSERT_TRUE(markers.Await().has_value());
  EXPECT_GT(markers.Await()->markers_().size(), 5u);
  ASSERT_TRUE(corridor.Await().has_value());
  EXPECT_EQ(corridor.Await()->poses_().size(), 2u);
  ASSERT_TRUE(waypoints.Await().has_value());
  EXPECT_EQ(waypoints.Await()->poses_().size(), 3u);
  ASSERT_TRUE(frames.Await().has_value());
  EXPECT_EQ(frames.Await()->transforms_().size(), 2u);
}

TEST_F(RosTopicsTest, AreAnnouncedUnderRos2NamesAndTypes) {
  VehicleState state;
  state.vehicle_id = 1;
  topics_.PublishState(state);
  std::map<std::string, std::string> types;
  for (int i = 0; i < 100 && types.size() < 11; ++i, std::this_thread::sleep_for(50ms)) {
    for (const RemoteEndpoint& endpoint : viewer_.Discovered()) types[endpoint.topic] = endpoint.type;
  }
  const std::map<std::string, std::string> wanted = {
      {"rt/tf", "tf2_msgs::msg::dds_::TFMessage_"},
      {"rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_"},
      {"rt/soffit/vehicle_1/pose", "geometry_msgs::msg::dds_::PoseStamped_"},
      {"rt/soffit/vehicle_1/camera/image_raw/compressed", "sensor_msgs::msg::dds_::CompressedImage_"},
      {"rt/soffit/vehicle_1/camera/camera_info", "sensor_msgs::msg::dds_::CameraInfo_"},
      {"rt/soffit/vehicle_1/waypoints", "nav_msgs::msg::dds_::Path_"},
      {"rt/soffit/vehicle_1/corridor", "nav_msgs::msg::dds_::Path_"},
      {"rt/soffit/vehicle_1/scene", "visualization_msgs::msg::dds_::MarkerArray_"},
      {"rt/soffit/vehicle_1/occupied_cells_vis_array", "visualization_msgs::msg::dds_::MarkerArray_"},
      {"rt/soffit/vehicle_1/octomap_binary", "octomap_msgs::msg::dds_::Octomap_"},
      {"rt/soffit/vehicle_1/octomap_full", "octomap_msgs::msg::dds_::Octomap_"}};
  EXPECT_EQ(types, wanted);
}

}  // namespace
}  // namespace soffit
