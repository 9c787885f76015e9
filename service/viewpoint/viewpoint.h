#pragma once

#include <string>
#include <vector>

#include "service/footprint/footprint.h"
#include "shared/capture/capture.h"
#include "shared/options/options.h"

namespace soffit {

/// From where, and in which direction, a picture is wanted.
struct Viewpoint {
  Purpose purpose = Purpose::kUnknown;
  Eigen::Vector3d position_in_map_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;    ///< Heading of the vehicle and the camera.
  double pitch_rad = 0.0;  ///< 0 horizontal, -pi/2 straight down.
  std::uint32_t object_id = 0;
  int side = -1;           ///< kWall: index of the footprint's side; else -1.
  std::string reason;      ///< For people: "front wall, the longest side".
};

struct ViewpointOptions {
  double overview_altitude_m = 9.0;
  double top_altitude_m = 4.0;
  double framing = 0.80;           ///< Share of the picture that the object may fill.
  double wall_altitude_m = 1.2;
  double min_distance_m = 2.0;     ///< From any wall to a viewpoint, beside the vehicle's envelope.
  double max_altitude_m = 120.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("overview_altitude_m", self.overview_altitude_m, OptionInfo{1, 120, "m", "Of the overview (paper: 9)"});
    field("top_altitude_m", self.top_altitude_m, OptionInfo{1, 120, "m", "Of the picture from above, if it fits (paper: 4)"});
    field("framing", self.framing, OptionInfo{0.1, 1.0, "", "Share of the picture that the object may fill"});
    field("wall_altitude_m", self.wall_altitude_m, OptionInfo{0.3, 50, "m", "Least height of the horizontal views"});
    field("min_distance_m", self.min_distance_m, OptionInfo{0.1, 100, "m", "Least distance of a viewpoint from any wall"});
    field("max_altitude_m", self.max_altitude_m, OptionInfo{1, 500, "m", "No viewpoint is higher"});
  }
};

/// Straight down over `center_in_map_m`.
Viewpoint PlanOverview(const Eigen::Vector2d& center_in_map_m, const Intrinsics& camera, const ViewpointOptions& options);

/// Straight down over the object, as low as it still fits into the picture with its height (or an upper bound of it).
Viewpoint PlanTop(const Footprint& object, const Intrinsics& camera, const ViewpointOptions& options);

/// Horizontal views facing the walls: the front (the longest side) first, then the right one, then others until at
/// least half of the sides of the footprint's convex hull are seen (paper, section 2.5), and the opposite of the front.
/// Each is free of every footprint in `map` and sees its wall unoccluded, or is left out.
std::vector<Viewpoint> PlanWalls(const Footprint& object, const std::vector<Footprint>& map, const Intrinsics& camera,
                                 const ViewpointOptions& options);

}  // namespace soffit
