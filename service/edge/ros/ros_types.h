#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>

#include "ros2.h"
#include "shared/frames/frames.h"

/// ROS 2's messages (Humble) without their mangled names, and what all of them are made of.
namespace soffit::ros {

using geometry_msgs::msg::dds_::PoseStamped_;
using nav_msgs::msg::dds_::Path_;
using octomap_msgs::msg::dds_::Octomap_;
using sensor_msgs::msg::dds_::CameraInfo_;
using sensor_msgs::msg::dds_::CompressedImage_;
using std_msgs::msg::dds_::Header_;
using tf2_msgs::msg::dds_::TFMessage_;
using visualization_msgs::msg::dds_::Marker_;
using visualization_msgs::msg::dds_::MarkerArray_;

inline constexpr const char* kMapFrame = "map";  ///< REP 105: ENU, fixed, its origin is home on the ground.
inline constexpr const char* kEarthFrame = "earth";  ///< REP 105: WGS84, earth-centred, earth-fixed.

/// "vehicle_3", or with a part of it: "vehicle_3/base_link".
std::string VehicleFrame(std::uint32_t vehicle_id, const std::string& part = "");

Header_ MakeHeader(std::int64_t stamp_utc_ns, const std::string& frame);
geometry_msgs::msg::dds_::Point_ MakePoint(const Eigen::Vector3d& point_m);
geometry_msgs::msg::dds_::Vector3_ MakeVector(const Eigen::Vector3d& vector);
geometry_msgs::msg::dds_::Quaternion_ MakeQuaternion(const Eigen::Quaterniond& rotation);
geometry_msgs::msg::dds_::Pose_ MakePose(const Eigen::Vector3d& position_m,
                                         const Eigen::Quaterniond& rotation);

/// Turned about z, counter-clockwise from east.
Eigen::Quaterniond Heading(double yaw_rad);

}  // namespace soffit::ros
