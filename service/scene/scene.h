#pragma once

#include <octomap/OcTree.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "service/facade/facade.h"
#include "service/footprint/footprint.h"
#include "service/match/match.h"
#include "service/solid/solid.h"
#include "shared/options/options.h"

namespace soffit {

struct SceneObject {
  Footprint footprint;
  bool is_matched = false;
  Match match;                             ///< Meaningful when `is_matched`.
  std::vector<std::uint32_t> neighbours;   ///< Ids of the nearest objects, nearest first.
};

/// The enriched scene: vector map, models and occupancy. A snapshot: never modified, shared freely between threads.
struct Scene {
  std::uint64_t revision = 0;
  std::vector<SceneObject> objects;
  std::vector<Solid> solids;
  std::shared_ptr<const octomap::OcTree> octree;   ///< Never null. Unknown is where there is no node.
};

struct SceneOptions {
  double voxel_m = 0.10;
  double margin_m = 3.0;
  int neighbours = 4;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("voxel_m", self.voxel_m, OptionInfo{0.01, 2.0, "m", "Edge of an OctoMap voxel"});
    field("margin_m", self.margin_m, OptionInfo{0.5, 100.0, "m", "How far around the models space is mapped"});
    field("neighbours", self.neighbours, OptionInfo{0, 16, "", "Neighbours that are listed for an object"});
  }
};

/// Builds the next snapshot. Voxels that a solid or an unexplained obstacle touches are occupied; a voxel is free when
/// a trusted picture saw through all of it (the ray to every pixel that it covers goes on to ground or sky, or to the
/// model's surface behind it); all others are unknown.
Scene BuildScene(std::uint64_t revision, std::vector<SceneObject> objects, std::vector<Solid> solids,
                 const std::vector<Sight>& sights, const SceneOptions& options);

/// Ids of the nearest objects, nearest first.
std::vector<std::uint32_t> FindNeighbours(const Footprint& object, const std::vector<Footprint>& map, int count);

}  // namespace soffit
