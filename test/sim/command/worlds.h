#pragma once

#include <cstdint>
#include <string>

#include "shared/result/result.h"

namespace soffit::sim {

/// `soffit-sim truth`: prints, as JSON, what is truly passable in a world and how a mission has to end.
Status PrintTruth(const std::string& world_file);

/// `soffit-sim draw`: writes the random world of a seed.
Status WriteRandomWorld(std::uint64_t seed, const std::string& file);

}  // namespace soffit::sim
