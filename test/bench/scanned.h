#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/result/result.h"
#include "test/sim/world/world.h"

namespace soffit::bench {

/// Worlds about one scanned building (CityGML) with a passage, which ends at the building's largest upright
/// ClosureSurface, where the scanner did not get further: as it was delivered, led straight through to the
/// other side, and then with something in it, or too tight for the vehicle; their titles tell which, up to
/// the first comma. Whether one is passable is for FindTruth to say. Errors name the file: it cannot be read,
/// or has no such surface.
Result<std::vector<sim::World>> BuildScannedWorlds(const std::filesystem::path& file);

}  // namespace soffit::bench
