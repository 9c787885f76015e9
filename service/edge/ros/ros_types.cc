#include "service/edge/ros/ros_types.h"

namespace soffit::ros {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

}  // namespace

std::string VehicleFrame(std::uint32_t vehicle_id, const std::string& part) {
  return "vehicle_" + std::to_string(vehicle_id) + (part.empty() ? "" : "/" + part);
}

Header_ MakeHeader(std::int64_t stamp_utc_ns, const std::string& frame) {
  Header_ header;
  header.stamp_().sec_(static_cast<std::int32_t>(stamp_utc_ns / kNsPerSecond));
  header.stamp_().nanosec_(static_cast<std::uint32_t>(stamp_utc_ns % kNsPerSecond));
  header.frame_id_(frame);
  return header;
}

geometry_msgs::msg::dds_::Point_ MakePoint(const Eigen::Vector3d& point_m) {
  geometry_msgs::msg::dds_::Point_ point;
  point.x_(point_m.x());
  point.y_(point_m.y());
  point.z_(point_m.z());
  return point;
}

geometry_msgs::msg::dds_::Vector3_ MakeVector(const Eigen::Vector3d& vector) {
  geometry_msgs::msg::dds_::Vector3_ message;
  message.x_(vector.x());
  message.y_(vector.y());
  message.z_(vector.z());
  return message;
}

geometry_msgs::msg::dds_::Quaternion_ MakeQuaternion(const Eigen::Quaterniond& rotation) {
  geometry_msgs::msg::dds_::Quaternion_ message;
  message.x_(rotation.x());
  message.y_(rotation.y());
  message.z_(rotation.z());
  message.w_(rotation.w());
  return message;
}

geometry_msgs::msg::dds_::Pose_ MakePose(const Eigen::Vector3d& position_m,
                                         const Eigen::Quaterniond& rotation) {
  geometry_msgs::msg::dds_::Pose_ pose;
  pose.position_(MakePoint(position_m));
  pose.orientation_(MakeQuaternion(rotation));
  return pose;
}

Eigen::Quaterniond Heading(double yaw_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
}

}  // namespace soffit::ros
