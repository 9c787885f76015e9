#include "test/sim/autopilot/gimbal.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/frames/frames.h"
#include "test/sim/autopilot/flight_control.h"
#include "test/sim/autopilot/ned.h"

namespace soffit::sim {
namespace {

constexpr double kMaxRate_radps = std::numbers::pi / 3.0;
constexpr double kLowestPitch_rad = -0.5 * std::numbers::pi;
constexpr double kHighestPitch_rad = std::numbers::pi / 6.0;

}  // namespace

void Gimbal::Point(double pitch_rad, double yaw_rad, bool is_yaw_against_north) {
  if (std::isfinite(pitch_rad))
    target_pitch_rad_ = std::clamp(pitch_rad, kLowestPitch_rad, kHighestPitch_rad);
  if (!std::isfinite(yaw_rad)) return;
  target_yaw_rad_ = WrapAngle(yaw_rad);
  is_yaw_against_north_ = is_yaw_against_north;
}

void Gimbal::Step(const Eigen::Quaterniond& map_from_body, double dt_s) {
  const double nose_rad = NedFrame::SwapYaw(YawOf(map_from_body));
  const double most_rad = kMaxRate_radps * dt_s;
  pitch_rad_ += std::clamp(target_pitch_rad_ - pitch_rad_, -most_rad, most_rad);
  const double wanted_from_nose_rad =
      WrapAngle(is_yaw_against_north_ ? target_yaw_rad_ - nose_rad : target_yaw_rad_);
  yaw_from_nose_rad_ =
      WrapAngle(yaw_from_nose_rad_ +
                std::clamp(WrapAngle(wanted_from_nose_rad - yaw_from_nose_rad_), -most_rad, most_rad));
  heading_rad_ = WrapAngle(nose_rad + yaw_from_nose_rad_);
}

Eigen::Quaterniond Gimbal::MapFromCamera() const {
  return CameraAttitude(NedFrame::SwapYaw(heading_rad_), pitch_rad_);
}

}  // namespace soffit::sim
