#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <condition_variable>
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

  /// The same, after waiting for up to `patience` until the history has got that far.
  std::optional<FlightPose> Await(std::int64_t utc_ns, std::chrono::milliseconds patience) const;

 private:
  std::optional<FlightPose> Find(std::int64_t utc_ns) const;

  mutable std::mutex mutex_;
  mutable std::condition_variable grown_;
  std::deque<FlightPose> poses_;
};

/// The pose of a camera: all sit at the vehicle's reference point; the fixed ones turn with the vehicle.
Pose<Map, Camera> CameraPose(Mount mount, const FlightPose& pose);

}  // namespace soffit::sim
