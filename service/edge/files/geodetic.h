#pragma once

#include <Eigen/Core>

#include "shared/flight/flight.h"

namespace soffit {

struct GeodeticPoint {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_amsl_m = 0.0;
};

/// Where the map lies on Earth. The origin's height above the sea is taken for that above the ellipsoid, and
/// so are those of all points: what they differ by is the same within any scene.
class GeodeticFrame {
 public:
  explicit GeodeticFrame(const GeodeticOrigin& origin) : origin_(origin) {}

  GeodeticPoint Place(const Eigen::Vector3d& in_map_m) const;

  /// EPSG code of the UTM zone that the origin is in, and a point in its metres.
  int UtmCode() const;
  Eigen::Vector3d PlaceInUtm(const Eigen::Vector3d& in_map_m) const;

 private:
  GeodeticOrigin origin_;
};

}  // namespace soffit
