#pragma once

#include <vector>

#include "service/footprint/footprint.h"
#include "shared/flight/flight.h"

namespace soffit {

/// Height of the vehicle's centre on the way from one place to another: above every building of known height,
/// wherever it stands, by `clearance_m` beside the envelope; at least `unknown_m` where the way leads over,
/// or nearer than `clearance_m` by, something of unknown height, or where nothing is known at all.
double TransitAltitude(const std::vector<Footprint>& map, const Eigen::Vector2d& from,
                       const Eigen::Vector2d& to, const VehicleEnvelope& vehicle, double clearance_m,
                       double unknown_m);

/// From one place to another over everything: straight up, across at `altitude_m`, straight down. The start
/// is not part of it. A part of no length is left out; never empty.
std::vector<Eigen::Vector3d> FlyOver(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                     double altitude_m);

}  // namespace soffit
