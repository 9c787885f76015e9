#include "test/sim/flight/pose_history.h"

#include <algorithm>
#include <cmath>

namespace soffit::sim {
namespace {

constexpr std::int64_t kKept_ns = 10'000'000'000;
constexpr std::int64_t kNewestStands_ns = 100'000'000;

FlightPose Interpolate(const FlightPose& a, const FlightPose& b, std::int64_t utc_ns) {
  const double share = static_cast<double>(utc_ns - a.utc_ns) / static_cast<double>(b.utc_ns - a.utc_ns);
  return {utc_ns, a.position_m + share * (b.position_m - a.position_m),
          a.map_from_body.slerp(share, b.map_from_body), a.map_from_gimbal.slerp(share, b.map_from_gimbal)};
}

}  // namespace

void PoseHistory::Add(const FlightPose& pose) {
  const std::lock_guard lock(mutex_);
  if (!poses_.empty() && pose.utc_ns <= poses_.back().utc_ns) return;
  poses_.push_back(pose);
  while (pose.utc_ns - poses_.front().utc_ns > kKept_ns) poses_.pop_front();
  grown_.notify_all();
}

std::optional<FlightPose> PoseHistory::At(std::int64_t utc_ns) const {
  const std::lock_guard lock(mutex_);
  return Find(utc_ns);
}

std::optional<FlightPose> PoseHistory::Await(std::int64_t utc_ns, std::chrono::milliseconds patience) const {
  std::unique_lock lock(mutex_);
  grown_.wait_for(lock, patience, [&] { return !poses_.empty() && poses_.back().utc_ns >= utc_ns; });
  return Find(utc_ns);
}

std::optional<FlightPose> PoseHistory::Find(std::int64_t utc_ns) const {
  const auto next =
      std::lower_bound(poses_.begin(), poses_.end(), utc_ns,
                       [](const FlightPose& pose, std::int64_t wanted) { return pose.utc_ns < wanted; });
  if (next == poses_.end()) {
    if (poses_.empty() || utc_ns - poses_.back().utc_ns > kNewestStands_ns) return std::nullopt;
    return poses_.back();
  }
  if (next == poses_.begin()) return next->utc_ns == utc_ns ? std::optional(*next) : std::nullopt;
  return Interpolate(*std::prev(next), *next, utc_ns);
}

Pose<Map, Camera> CameraPose(Mount mount, const FlightPose& pose) {
  switch (mount) {
    case Mount::kForward:
      return {pose.map_from_body * CameraAttitude(0.0, 0.0), pose.position_m};
    case Mount::kDown:
      return {pose.map_from_body * CameraAttitude(0.0, -M_PI / 2.0), pose.position_m};
    case Mount::kGimbal:
      break;
  }
  return {pose.map_from_gimbal, pose.position_m};
}

}  // namespace soffit::sim
