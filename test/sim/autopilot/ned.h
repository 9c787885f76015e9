#pragma once

#include <Eigen/Geometry>
#include <GeographicLib/LocalCartesian.hpp>

#include "shared/flight/flight.h"

namespace soffit::sim {

/// Where autopilots live: north, east, down about the estimator's origin; body forward, right, down.
class NedFrame {
 public:
  /// `map_origin`: of the map, on the ground. `origin_in_map_m`: where the estimator put its own.
  NedFrame(const GeodeticOrigin& map_origin, const Eigen::Vector3d& origin_in_map_m);

  Eigen::Vector3d FromMap(const Eigen::Vector3d& in_map_m) const;
  Eigen::Vector3d ToMap(const Eigen::Vector3d& in_ned_m) const;
  GeodeticOrigin GeodeticOf(const Eigen::Vector3d& in_map_m) const;
  Eigen::Vector3d MapOf(const GeodeticOrigin& geodetic) const;

  /// Vectors, east-north-up to north-east-down; its own inverse.
  static Eigen::Vector3d SwapVector(const Eigen::Vector3d& vector) {
    return {vector.y(), vector.x(), -vector.z()};
  }
  /// map-from-FLU to NED-from-FRD; its own inverse.
  static Eigen::Quaterniond SwapAttitude(const Eigen::Quaterniond& attitude);
  /// Heading clockwise from north to yaw counter-clockwise from east; its own inverse.
  static double SwapYaw(double angle_rad);

 private:
  GeographicLib::LocalCartesian projection_;
  Eigen::Vector3d origin_in_map_m_;
};

struct EulerAngles {
  double roll_rad = 0.0;
  double pitch_rad = 0.0;
  double yaw_rad = 0.0;
};

/// Of an NED-from-FRD attitude: turned by yaw, then pitch, then roll.
EulerAngles EulerOf(const Eigen::Quaterniond& ned_from_frd);

}  // namespace soffit::sim
