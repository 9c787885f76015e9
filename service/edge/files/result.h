#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "service/edge/files/flight_record.h"
#include "service/pipeline/pipeline.h"
#include "shared/result/result.h"

namespace soffit {

/// Writes what was understood for other programs into `folder`: `models/ID.obj` (ENU metres), `scene.bt`
/// (OctoMap, with its manifest) and, last, `result.json` (with what `flight` knows of the mission and of the
/// truth). `flight.map_origin_m` is that of the octree. Each file replaces its forerunner as a whole, so
/// readers never see half of one. `observations` are those that it was understood from. Same input, same
/// bytes.
Status WriteResult(const std::filesystem::path& folder, const Understanding& understanding,
                   const std::vector<Observation>& observations, const FlightRecord& flight = {});

nlohmann::ordered_json DecisionToJson(const ClearanceDecision& decision);

}  // namespace soffit
