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
  Match match;                            ///< Meaningful when `is_matched`.
  std::vector<std::uint32_t> neighbours;  ///< Ids of the nearest objects, nearest first.
};

/// Something that stands in the scene, or hangs there, and belongs to no building: an upright cylinder about
/// it.
struct Obstacle {
  Eigen::Vector3d base_in_map_m = Eigen::Vector3d::Zero();  ///< On the ground unless it is seen to hang.
  double radius_m = 0.0;
  double height_m = 0.0;     ///< Above its base, as far as it was seen.
  bool is_top_seen = false;  ///< It was seen to end there.
  double std_m = 0.0;        ///< Of its place.
  std::vector<std::uint32_t> captures;
};

/// The enriched scene: vector map, models and occupancy. A snapshot: never modified, shared freely between
/// threads.
struct Scene {
  std::uint64_t revision = 0;
  Eigen::Vector3d map_origin_m = Eigen::Vector3d::Zero();  ///< In the coordinates that people are told.
  std::vector<SceneObject> objects;
  std::vector<Solid> solids;
  std::vector<Obstacle> obstacles;
  std::vector<Obstacle>
      clutter;  ///< What a picture from above alone shows beside the buildings: of unknown height.
  std::shared_ptr<const octomap::OcTree> octree;  ///< Never null. Unknown is where there is no node.
};

struct SceneOptions {
  double voxel_m = 0.05;
  double margin_m = 3.0;
  double max_voxels = 1.6e7;
  int neighbours = 4;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("voxel_m", self.voxel_m, OptionInfo{0.01, 2.0, "m", "Edge of an OctoMap voxel"});
    field("margin_m", self.margin_m,
          OptionInfo{0.5, 100.0, "m", "How far around the models space is mapped"});
    field("max_voxels", self.max_voxels,
          OptionInfo{1e3, 1e9, "", "Voxels are doubled until there are no more than this"});
    field("neighbours", self.neighbours, OptionInfo{0, 16, "", "Neighbours that are listed for an object"});
  }
};

/// Builds the next snapshot. A voxel is occupied when a solid touches it; free when a picture with a trusted
/// pose saw through all of it, to a part of the model, to ground or to sky (space carving: K. Kutulakos, S.
/// Seitz, 2000); occupied too when two pictures from different directions show something there that the model
/// does not have and that is near: then it belongs to an obstacle. All others are unknown, but for those that
/// free ones enclose: nothing hovers.
///
/// What the pictures show of the ground has to agree between them; see GroundCheck. The extent is that of
/// the matched objects' solids and `margin_m` around them; without any, nothing is mapped. Pure.
Scene BuildScene(std::uint64_t revision, std::vector<SceneObject> objects, std::vector<Solid> solids,
                 const std::vector<Sight>& sights, const SceneOptions& options);

/// Ids of the nearest objects, nearest first.
std::vector<std::uint32_t> FindNeighbours(const Footprint& object, const std::vector<Footprint>& map,
                                          int count);

}  // namespace soffit
