#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "shared/flight/flight.h"

namespace soffit {

/// The map (ENU, origin home on the ground) seen from the autopilot's local frame (NED, origin where its
/// estimator began).
///
/// The first home that is heard is the map's origin for the life of this object: that autopilots set home
/// anew when they arm, or begin their local frame anew when they reboot, does not move the map.
class MapFrame {
 public:
  void SetLocalOrigin(const GeodeticOrigin& origin);
  void SetHome(const GeodeticOrigin& home);
  void ForgetLocalOrigin() { local_origin_.reset(); }

  const std::optional<GeodeticOrigin>& origin() const { return origin_; }
  /// Height of the newest home in the map: autopilots count a takeoff's height from there. 0 before the
  /// first.
  double home_height_m() const { return home_height_m_; }
  bool HasLocalOrigin() const { return local_origin_.has_value(); }
  bool IsKnown() const { return origin_.has_value() && local_origin_.has_value(); }

  /// IsKnown() must hold.
  Eigen::Vector3d ToMap(const Eigen::Vector3d& local_ned_m) const;
  Eigen::Vector3d ToLocalNed(const Eigen::Vector3d& in_map_m) const;

 private:
  void Update();

  std::optional<GeodeticOrigin> origin_;
  std::optional<GeodeticOrigin> local_origin_;
  double home_height_m_ = 0.0;
  Eigen::Vector3d map_origin_in_local_enu_m_ = Eigen::Vector3d::Zero();
};

Eigen::Vector3d SwapEnuNed(const Eigen::Vector3d& vector);  ///< Its own inverse.

/// From MAVLink's attitude (forward-right-down in NED) to the map's (forward-left-up in ENU).
Eigen::Quaterniond MapFromBody(const Eigen::Quaterniond& ned_from_frd);

/// Counter-clockwise from east to clockwise from north, and back; in (-pi, pi].
double SwapYaw(double yaw_rad);

double YawOf(const Eigen::Quaterniond& map_from_body);

}  // namespace soffit
