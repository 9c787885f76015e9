#pragma once

#include <filesystem>

#include "service/edge/files/flight_record.h"
#include "service/pipeline/pipeline.h"
#include "shared/result/result.h"

namespace soffit {

/// Writes the scene as a GeoPackage with the layers buildings, openings, decisions, viewpoints and track (all
/// with heights, in metres), as a whole. With a geodetic origin it lies where it belongs (transverse Mercator
/// about the origin), else in a local frame.
Status WriteGeoPackage(const std::filesystem::path& file, const Understanding& understanding,
                       const std::vector<Observation>& observations, const FlightRecord& flight);

}  // namespace soffit
