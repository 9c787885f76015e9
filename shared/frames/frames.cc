#include "shared/frames/frames.h"

#include <cmath>

namespace soffit {

Eigen::Quaterniond CameraAttitude(double yaw_rad, double pitch_rad) {
  const Eigen::Vector3d heading(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
  const Eigen::Vector3d up(0.0, 0.0, 1.0);
  Eigen::Matrix3d map_from_camera;
  map_from_camera.col(0) = heading.cross(up);
  map_from_camera.col(2) = std::cos(pitch_rad) * heading + std::sin(pitch_rad) * up;
  map_from_camera.col(1) = map_from_camera.col(2).cross(map_from_camera.col(0));
  return Eigen::Quaterniond(map_from_camera).normalized();
}

}  // namespace soffit
