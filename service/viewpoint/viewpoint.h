#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/footprint/footprint.h"
#include "shared/capture/capture.h"
#include "shared/flight/flight.h"
#include "shared/options/options.h"

namespace soffit {

/// From where, and in which direction, a picture is wanted.
struct Viewpoint {
  Purpose purpose = Purpose::kUnknown;
  Eigen::Vector3d position_in_map_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;    ///< Heading of the vehicle and the camera.
  double pitch_rad = 0.0;  ///< 0 horizontal, -pi/2 straight down.
  std::uint32_t object_id = 0;
  int side = -1;       ///< kWall: index of the footprint's side; else -1.
  std::string reason;  ///< For people: "front wall, the longest side".
};

struct ViewpointOptions {
  double overview_altitude_m = 9.0;
  double top_altitude_m = 4.0;
  double framing = 0.80;
  double wall_altitude_m = 1.2;
  double min_distance_m = 1.0;
  double max_altitude_m = 120.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("overview_altitude_m", self.overview_altitude_m,
          OptionInfo{1, 500, "m", "Of the overview (paper: 9)"});
    field("top_altitude_m", self.top_altitude_m,
          OptionInfo{1, 500, "m", "Of the picture from above, if it fits (paper: 4)"});
    field("framing", self.framing, OptionInfo{0.1, 1.0, "", "Share of the picture that the object may fill"});
    field("wall_altitude_m", self.wall_altitude_m,
          OptionInfo{0.3, 50, "m", "Least height of the horizontal views"});
    field("min_distance_m", self.min_distance_m,
          OptionInfo{0.0, 100, "m", "From any wall, beside the vehicle's radius and margin"});
    field("max_altitude_m", self.max_altitude_m, OptionInfo{1, 500, "m", "No viewpoint is higher"});
  }
};

/// Straight down over `center_in_map_m`, at the overview's altitude or as much higher as a disc of `radius_m`
/// on the ground needs to fit.
Viewpoint PlanOverview(const Eigen::Vector2d& center_in_map_m, double radius_m, const Intrinsics& camera,
                       const ViewpointOptions& options);

/// Straight down over the object, the long side of the picture along the long side of the object. At the top
/// altitude, or as much higher as the roof at its height needs to fit and the vehicle needs to stay off it.
/// An object of unknown height is not approached: the overview's altitude is the least then.
Viewpoint PlanTop(const Footprint& object, const Intrinsics& camera, const VehicleEnvelope& vehicle,
                  const ViewpointOptions& options);

/// A horizontal view in which the wall over side `side` of the object's outer ring is whole, from its base to
/// its top and from end to end, together with the neighbouring sides of a curve that it belongs to;
/// unoccluded by any footprint (own notches included), frontal if possible and at most 40 degrees off. It
/// lies free of every footprint by the vehicle's radius and margin and the least distance. None when there is
/// no such place. The camera is level, so that one that is fixed to the vehicle serves as well. An unknown
/// height is taken to be the larger of 3 m and half of the longest side.
std::optional<Viewpoint> PlanWall(const Footprint& object, int side, const std::vector<Footprint>& map,
                                  const Intrinsics& camera, const VehicleEnvelope& vehicle,
                                  const ViewpointOptions& options);

/// Views of the walls: the front (the longest side), the right one, the opposite of the front, then the
/// others by length, until every side that is wide enough for the vehicle and at least half of the sides of
/// the convex hull (Bielecki & Smigielski 2021, section 2.5) are seen. Sides that an earlier view shows well
/// get no view of their own, sides that cannot be seen are left out.
std::vector<Viewpoint> PlanWalls(const Footprint& object, const std::vector<Footprint>& map,
                                 const Intrinsics& camera, const VehicleEnvelope& vehicle,
                                 const ViewpointOptions& options);

/// A level look along a corridor from before its entry: so far back that the space which the vehicle needs at
/// the entry is in the picture, or as far as other footprints in `map` allow.
Viewpoint PlanCorridorLook(const Eigen::Vector3d& entry_in_map_m, const Eigen::Vector3d& exit_in_map_m,
                           const std::vector<Footprint>& map, const Intrinsics& camera,
                           const VehicleEnvelope& vehicle, const ViewpointOptions& options);

}  // namespace soffit
