#pragma once

#include <filesystem>

#include "service/edge/files/analysis.h"
#include "service/edge/files/flight_record.h"
#include "shared/result/result.h"

namespace soffit {

/// Everything that other programs read: `result.json`, `models/`, `scene.bt`, `scene.city.json`,
/// `scene.gpkg`; and with `WritePictures` what people look at.
Status WriteOutputs(const std::filesystem::path& folder, const Analysis& analysis,
                    const FlightRecord& flight);

}  // namespace soffit
