#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "service/scene/scene.h"
#include "shared/flight/flight.h"
#include "shared/options/options.h"

namespace soffit {

/// A way under or through a building, level, flown by the vehicle's centre in straight legs.
struct Corridor {
  std::uint32_t object_id = 0;
  int entry_wall = -1;
  int exit_wall = -1;
  Eigen::Vector3d entry_in_map_m = Eigen::Vector3d::Zero();  ///< Outside the footprint, with stand-off.
  Eigen::Vector3d exit_in_map_m = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> bends_in_map_m;  ///< Between them, where it turns; as a rule none.
  double free_width_m =
      0.0;  ///< Of the free rectangle along the whole corridor that is best relative to the need.
  double free_height_m = 0.0;
  double left_m = 0.0;       ///< From the path to the rectangle's left side, as the vehicle flies.
  double floor_m = 0.0;      ///< Lower side of that rectangle, above the ground.
  double std_m = 0.0;        ///< Of its sides.
  double place_std_m = 0.0;  ///< Of the building's place in the map, per axis.
  std::string limited_by;    ///< What stands in the passage and bounds that rectangle; empty: nothing does.

  std::vector<Eigen::Vector3d> Path() const;  ///< Entry, bends, exit.
  /// The free rectangle at each point of the path, across it; mitred at the bends.
  std::vector<Section> Sections() const;
  /// The edges of these rectangles, and between them, as pairs of points.
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> Edges() const;
};

struct CorridorOptions {
  double approach_m = 1.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("approach_m", self.approach_m,
          OptionInfo{0.0, 50.0, "m", "From the walls to entry and exit; at least radius and margin"});
  }
};

/// The best corridor for each passage of the object's solid, best relative to the vehicle's need first,
/// whether or not it is wide enough; straight where the vehicle fits through in one line, in whatever
/// direction is widest, else along a passage's bends; flown in the middle of its free rectangle, or where
/// more of the space that the vehicle needs was seen to be free. What stands in a passage takes its room
/// away. Empty when nothing leads through. Pure.
std::vector<Corridor> PlanCorridors(const Scene& scene, std::uint32_t object_id,
                                    const VehicleEnvelope& vehicle, const CorridorOptions& options);

}  // namespace soffit
