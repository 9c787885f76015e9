#pragma once

#include <optional>
#include <string>

#include "service/pipeline/pipeline.h"
#include "shared/flight/flight.h"
#include "shared/result/result.h"

namespace soffit {

/// The plan file of QGroundControl: take off, above everything known to the entry of the widest CLEAR
/// corridor, down, through it, up again, and home. Altitudes are above the home point. An error without an
/// origin or without a CLEAR corridor.
Result<std::string> ToFlightPlan(const Understanding& understanding,
                                 const std::optional<GeodeticOrigin>& origin);

}  // namespace soffit
