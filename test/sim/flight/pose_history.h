#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "shared/frames/frames.h"
#include "test/sim/camera/camera_server.h"

namespace soffit::sim {

/// Where vehicle and gimbal camera were at a moment.
struct FlightPose {
  std::int64_t utc_ns = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond map_from_body = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond map_from_gimbal =
      Eigen::Quaterniond::Identity();  ///< Of the camera on the gimbal (optical frame).
};

/// The poses of the last seconds, for cameras that look back to the moment of exposure. For any thread.
class PoseHistory {
 public:
  void Add(const FlightPose& pose);

  /// Interpolated; the newest pose stands for up to 0.1 s after it. None for other moments.
  std::optional<FlightPose> At(std::int64_t utc_ns) const;

  /// The pose of a camera: all sit at the vehicle's reference point; the fixed ones turn with the vehicle.
  std::optional<Pose<Map, Camera>> CameraAt(Mount mount, std::int64_t utc_ns) const;

 private:
  mutable std::mutex mutex_;
  std::deque<FlightPose> poses_;
};

}  // namespace soffit::sim
