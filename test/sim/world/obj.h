#pragma once

#include <filesystem>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// Vertices and faces of a Wavefront OBJ file; faces with more than three corners are split as fans,
/// everything else is ignored. Errors name file and line.
Result<Mesh> ReadObj(const std::filesystem::path& file);

}  // namespace soffit::sim
