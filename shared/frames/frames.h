#pragma once

#include <Eigen/Geometry>

namespace soffit {

struct Map;  ///< World, ENU: x east, y north, z up [m]; origin is the home point on the ground (REP 103/105).
struct Camera;  ///< OpenCV optical frame: x right, y down, z forward [m].
struct Body;    ///< Vehicle, FLU: x forward, y left, z up [m] (REP 103).

template <class Frame>
struct Point {
  Eigen::Vector3d xyz_m = Eigen::Vector3d::Zero();
};

/// Rigid transform, target first: `p_in_map = map_from_camera * p_in_camera`.
template <class To, class From>
struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< Unit norm, Hamilton.
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();       ///< Origin of From, in To.

  Pose<From, To> Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation_m)};
  }
};

template <class To, class From>
Point<To> operator*(const Pose<To, From>& pose, const Point<From>& point) {
  return {pose.rotation * point.xyz_m + pose.translation_m};
}

template <class To, class Middle, class From>
Pose<To, From> operator*(const Pose<To, Middle>& left, const Pose<Middle, From>& right) {
  return {(left.rotation * right.rotation).normalized(),
          left.rotation * right.translation_m + left.translation_m};
}

/// The camera's attitude when it looks along `yaw_rad` (map: counter-clockwise from east) and is pitched by
/// `pitch_rad` (0: horizontal, -pi/2: straight down, then the picture's top points along `yaw_rad`), without
/// roll.
Eigen::Quaterniond CameraAttitude(double yaw_rad, double pitch_rad);

}  // namespace soffit
