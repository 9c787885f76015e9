#include "service/edge/files/geodetic.h"

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/UTMUPS.hpp>

namespace soffit {

GeodeticPoint GeodeticFrame::Place(const Eigen::Vector3d& in_map_m) const {
  const GeographicLib::LocalCartesian local(origin_.latitude_deg, origin_.longitude_deg,
                                            origin_.altitude_amsl_m);
  GeodeticPoint point;
  local.Reverse(in_map_m.x(), in_map_m.y(), in_map_m.z(), point.latitude_deg, point.longitude_deg,
                point.altitude_amsl_m);
  return point;
}

int GeodeticFrame::UtmCode() const {
  using GeographicLib::UTMUPS;
  return UTMUPS::EncodeEPSG(UTMUPS::StandardZone(origin_.latitude_deg, origin_.longitude_deg),
                            origin_.latitude_deg >= 0.0);
}

Eigen::Vector3d GeodeticFrame::PlaceInUtm(const Eigen::Vector3d& in_map_m) const {
  using GeographicLib::UTMUPS;
  const GeodeticPoint point = Place(in_map_m);
  int zone = 0;
  bool is_north = false;
  Eigen::Vector3d placed(0.0, 0.0, point.altitude_amsl_m);
  UTMUPS::Forward(point.latitude_deg, point.longitude_deg, zone, is_north, placed.x(), placed.y(),
                  UTMUPS::StandardZone(origin_.latitude_deg, origin_.longitude_deg));
  return placed;
}

}  // namespace soffit
