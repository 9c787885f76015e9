#include "vehicle_agent/pose/camera_mount.h"

#include <numbers>

namespace soffit {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

}  // namespace

Pose<Body, Camera> BodyFromCamera(const CameraMount& mount) {
  // The body is laid out like the map (x, y, z: forward, left, up for east, north, up).
  const Eigen::Quaterniond aimed = CameraAttitude(mount.yaw_deg * kRadPerDeg, mount.pitch_deg * kRadPerDeg);
  const Eigen::Quaterniond rolled(Eigen::AngleAxisd(mount.roll_deg * kRadPerDeg, Eigen::Vector3d::UnitZ()));
  return {(aimed * rolled).normalized(), {mount.forward_m, mount.left_m, mount.up_m}};
}

}  // namespace soffit
