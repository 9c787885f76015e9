#pragma once

#include <cstdint>
#include <filesystem>

#include "shared/result/result.h"
#include "test/sim/world/world.h"

namespace soffit::sim {

/// Writes an offline survey (soffit-survey/1): pictures, reference.png, survey.json with poses that are wrong
/// by the world's pose noise, and truth.json (soffit-truth/1: objects with footprints, solids and passages,
/// the match, the right decisions). Pictures: the overview, one from above of each wanted building and of one
/// other, and of each wanted building the walls from three or four sides, front and back among them; places
/// that something occupies are left out. Same world and seed: same bytes.
Status WriteSurvey(const World& world, std::uint64_t seed, const std::filesystem::path& folder,
                   int threads = 1);

}  // namespace soffit::sim
