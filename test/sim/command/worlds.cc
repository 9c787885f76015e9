#include "test/sim/command/worlds.h"

#include <fstream>
#include <iostream>

#include "test/sim/draw/draw.h"
#include "test/sim/truth/truth.h"
#include "test/sim/world/world.h"

namespace soffit::sim {

Status PrintTruth(const std::string& world_file) {
  const auto world = LoadWorld(world_file);
  if (!world.ok()) return world.error();
  std::cout << ToJson(FindTruth(world.value())).dump(1) << std::endl;
  return OkStatus();
}

Status WriteRandomWorld(std::uint64_t seed, const std::string& file) {
  std::ofstream stream(file);
  stream << FormatWorld(DrawWorld(seed));
  stream.close();
  if (!stream) return InvalidInput("world file '" + file + "' cannot be written");
  return OkStatus();
}

}  // namespace soffit::sim
