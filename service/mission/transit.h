#pragma once

#include <vector>

#include "service/footprint/footprint.h"
#include "shared/flight/flight.h"

namespace soffit {

/// Height of the vehicle's centre that is above everything known by `clearance_m` beside its envelope. At
/// least `unknown_m` while the height of any building is not known.
double TransitAltitude(const std::vector<Footprint>& map, const VehicleEnvelope& vehicle, double clearance_m,
                       double unknown_m);

/// From one place to another over everything: straight up, across at `altitude_m`, straight down. The start
/// is not part of it. A part of no length is left out; never empty.
std::vector<Eigen::Vector3d> FlyOver(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                     double altitude_m);

}  // namespace soffit
