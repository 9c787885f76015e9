#pragma once

#include <filesystem>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// The triangles that `wanted` asks for (its `mesh` is not read), by the file's ending: `.obj`, all else is
/// CityGML. Coordinates are taken relative to the origin before anything is done with them, so that projected
/// ones (millions of metres) keep their last digit. An error names the file, and which surface is wrong, or
/// which name it does not have.
Result<Mesh> ReadMesh(const MeshFile& wanted, const std::filesystem::path& folder);

}  // namespace soffit::sim
