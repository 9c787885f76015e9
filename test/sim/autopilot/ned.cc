#include "test/sim/autopilot/ned.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "test/sim/autopilot/flight_control.h"

namespace soffit::sim {

NedFrame::NedFrame(const GeodeticOrigin& map_origin, const Eigen::Vector3d& origin_in_map_m)
    : projection_(map_origin.latitude_deg, map_origin.longitude_deg, map_origin.altitude_amsl_m),
      origin_in_map_m_(origin_in_map_m) {}

Eigen::Vector3d NedFrame::FromMap(const Eigen::Vector3d& in_map_m) const {
  return SwapVector(in_map_m - origin_in_map_m_);
}

Eigen::Vector3d NedFrame::ToMap(const Eigen::Vector3d& in_ned_m) const {
  return SwapVector(in_ned_m) + origin_in_map_m_;
}

GeodeticOrigin NedFrame::GeodeticOf(const Eigen::Vector3d& in_map_m) const {
  GeodeticOrigin geodetic;
  projection_.Reverse(in_map_m.x(), in_map_m.y(), in_map_m.z(), geodetic.latitude_deg, geodetic.longitude_deg,
                      geodetic.altitude_amsl_m);
  return geodetic;
}

Eigen::Vector3d NedFrame::MapOf(const GeodeticOrigin& geodetic) const {
  Eigen::Vector3d in_map_m;
  projection_.Forward(geodetic.latitude_deg, geodetic.longitude_deg, geodetic.altitude_amsl_m, in_map_m.x(),
                      in_map_m.y(), in_map_m.z());
  return in_map_m;
}

Eigen::Quaterniond NedFrame::SwapAttitude(const Eigen::Quaterniond& attitude) {
  const double half = std::numbers::sqrt2 / 2.0;
  const Eigen::Quaterniond ned_from_enu(0.0, half, half, 0.0);  // Half a turn about the line between x and y.
  const Eigen::Quaterniond flu_from_frd(0.0, 1.0, 0.0, 0.0);
  return (ned_from_enu * attitude * flu_from_frd).normalized();
}

double NedFrame::SwapYaw(double angle_rad) { return WrapAngle(0.5 * std::numbers::pi - angle_rad); }

EulerAngles EulerOf(const Eigen::Quaterniond& ned_from_frd) {
  const Eigen::Matrix3d m = ned_from_frd.toRotationMatrix();
  return {std::atan2(m(2, 1), m(2, 2)), std::asin(std::clamp(-m(2, 0), -1.0, 1.0)),
          std::atan2(m(1, 0), m(0, 0))};
}

}  // namespace soffit::sim
