#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "ros2PubSubTypes.h"
#include "service/clearance/clearance.h"
#include "service/scene/scene.h"
#include "shared/capture/capture.h"
#include "shared/dds/writer.h"
#include "shared/flight/flight.h"

namespace soffit {

namespace ros {

/// A message that is published as it is, on a topic whose name depends on the vehicle.
template <class PubSubType, TopicKind kind>
struct MessageTopic {
  using Value = typename PubSubType::type;
  using Support = PubSubType;
  static constexpr TopicKind kKind = kind;
  static Value ToWire(const Value& message) { return message; }
  static Result<Value> FromWire(const Value& message) { return message; }
};

using OctomapTopic = MessageTopic<octomap_msgs::msg::dds_::Octomap_PubSubType, TopicKind::kLatched>;
using MarkersTopic = MessageTopic<visualization_msgs::msg::dds_::MarkerArray_PubSubType, TopicKind::kLatched>;
using PathTopic = MessageTopic<nav_msgs::msg::dds_::Path_PubSubType, TopicKind::kLatched>;
using ImageTopic = MessageTopic<sensor_msgs::msg::dds_::CompressedImage_PubSubType, TopicKind::kLatched>;
using CameraTopic = MessageTopic<sensor_msgs::msg::dds_::CameraInfo_PubSubType, TopicKind::kLatched>;
using PoseTopic = MessageTopic<geometry_msgs::msg::dds_::PoseStamped_PubSubType, TopicKind::kStream>;
using TransformTopic = MessageTopic<tf2_msgs::msg::dds_::TFMessage_PubSubType, TopicKind::kStream>;
using StaticTransformTopic = MessageTopic<tf2_msgs::msg::dds_::TFMessage_PubSubType, TopicKind::kLatched>;

}  // namespace ros

/// What the service tells ROS 2, under its names and with its types (table in README.md). Thread-safe.
class RosTopics {
 public:
  explicit RosTopics(const Participant& participant);
  ~RosTopics();

  void PublishState(const VehicleState& state);
  void PublishCapture(const Capture& capture);
  void PublishWaypoints(std::uint32_t vehicle_id, std::int64_t stamp_utc_ns,
                        const std::vector<Eigen::Vector3d>& path_in_map_m);
  /// @param scene  Its octree is null before anything is known.
  void PublishScene(std::uint32_t vehicle_id, std::int64_t stamp_utc_ns, const Scene& scene,
                    const std::vector<ClearanceDecision>& decisions);

 private:
  struct Vehicle;
  Vehicle* FindOrMakeVehicle(std::uint32_t vehicle_id);
  void PublishStaticTransforms(std::int64_t stamp_utc_ns);

  Participant participant_;
  Writer<ros::TransformTopic> transforms_;
  Writer<ros::StaticTransformTopic> static_transforms_;
  std::mutex mutex_;
  std::map<std::uint32_t, std::unique_ptr<Vehicle>> vehicles_;
};

}  // namespace soffit
