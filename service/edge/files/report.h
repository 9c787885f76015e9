#pragma once

#include <filesystem>

#include "service/edge/files/flight_record.h"
#include "service/pipeline/pipeline.h"
#include "shared/result/result.h"

namespace soffit {

/// Writes `report.html`: one page for people about a survey or a mission, with the pictures that
/// `WritePictures` put beside it. `reference_file` and the pictures' names are taken relative to `folder`.
Status WriteReport(const std::filesystem::path& folder, const Understanding& understanding,
                   const std::vector<Observation>& observations, const FlightRecord& flight,
                   const std::string& reference_file);

}  // namespace soffit
