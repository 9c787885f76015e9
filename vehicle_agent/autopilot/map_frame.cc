#include "vehicle_agent/autopilot/map_frame.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <numbers>

namespace soffit {

void MapFrame::SetLocalOrigin(const GeodeticOrigin& origin) {
  local_origin_ = origin;
  Update();
}

void MapFrame::SetHome(const GeodeticOrigin& home) {
  if (!origin_) {
    origin_ = home;
    Update();
  }
  home_height_m_ = home.altitude_amsl_m - origin_->altitude_amsl_m;
}

void MapFrame::Update() {
  if (!IsKnown()) return;
  const GeographicLib::LocalCartesian local(local_origin_->latitude_deg, local_origin_->longitude_deg,
                                            local_origin_->altitude_amsl_m);
  Eigen::Vector3d& enu = map_origin_in_local_enu_m_;
  local.Forward(origin_->latitude_deg, origin_->longitude_deg, origin_->altitude_amsl_m, enu.x(), enu.y(),
                enu.z());
}

Eigen::Vector3d MapFrame::ToMap(const Eigen::Vector3d& local_ned_m) const {
  return SwapEnuNed(local_ned_m) - map_origin_in_local_enu_m_;
}

Eigen::Vector3d MapFrame::ToLocalNed(const Eigen::Vector3d& in_map_m) const {
  return SwapEnuNed(in_map_m + map_origin_in_local_enu_m_);
}

Eigen::Vector3d SwapEnuNed(const Eigen::Vector3d& vector) { return {vector.y(), vector.x(), -vector.z()}; }

Eigen::Quaterniond MapFromBody(const Eigen::Quaterniond& ned_from_frd) {
  const double half = std::sqrt(0.5);
  const Eigen::Quaterniond enu_from_ned(0.0, half, half,
                                        0.0);  // Half a turn about the diagonal of east and north.
  const Eigen::Quaterniond frd_from_flu(0.0, 1.0, 0.0, 0.0);  // Half a turn about forward.
  return (enu_from_ned * ned_from_frd * frd_from_flu).normalized();
}

double SwapYaw(double yaw_rad) {
  return std::remainder(0.5 * std::numbers::pi - yaw_rad, 2.0 * std::numbers::pi);
}

double YawOf(const Eigen::Quaterniond& map_from_body) {
  const Eigen::Vector3d forward = map_from_body * Eigen::Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

}  // namespace soffit
