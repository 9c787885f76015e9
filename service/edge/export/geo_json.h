#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/edge/files/gis_layers.h"
#include "shared/flight/flight.h"
#include "shared/result/result.h"

namespace soffit {

/// All features that are somewhere, as one collection (RFC 7946: WGS 84, rings counter-clockwise seen from
/// above); the property `layer` names the layer. An error without an origin.
Result<std::string> ToGeoJson(const std::vector<GisLayer>& layers,
                              const std::optional<GeodeticOrigin>& origin);

}  // namespace soffit
