#pragma once

#include <cstdint>
#include <string>

#include "shared/result/result.h"

namespace soffit::sim {

/// `soffit-sim truth`: prints, as JSON, what is truly passable in a world and how a mission has to end.
Status PrintTruth(const std::string& world_file);

/// `soffit-sim describe`: prints, as JSON, the camera, vehicle and mission of a world.
Status PrintDescription(const std::string& world_file);

/// `soffit-sim reference`: writes the reference bitmap of what is wanted, as PNG.
Status WriteReference(const std::string& world_file, const std::string& png_file);

/// `soffit-sim survey`: renders a survey of a world for `soffit analyze`, with the truth beside it.
Status WriteSurveyOf(const std::string& world_file, std::uint64_t seed, const std::string& folder);

/// `soffit-sim draw`: writes the random world of a seed.
Status WriteRandomWorld(std::uint64_t seed, const std::string& file);

}  // namespace soffit::sim
