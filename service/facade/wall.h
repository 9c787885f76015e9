#pragma once

#include <Eigen/Core>
#include <optional>

#include "service/footprint/footprint.h"
#include "shared/capture/capture.h"
#include "shared/geometry/polygon.h"

namespace soffit {

/// The plane on one side of a footprint, plumb or leaning inward. Wall coordinates: u [m] to the right as
/// seen from outside, from the side's first corner; v [m] up from the ground.
struct Wall {
  Eigen::Vector2d first_corner_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();     ///< Unit.
  Eigen::Vector2d outward = -Eigen::Vector2d::UnitY();  ///< Unit.
  double width_m = 0.0;
  double lean = 0.0;  ///< Inward, for each metre up.

  Eigen::Vector2d InPlan(double u_m) const { return first_corner_m + u_m * along; }
  Eigen::Vector3d InMap(const Eigen::Vector2d& uv_m) const {
    const Eigen::Vector2d plan = InPlan(uv_m.x()) - lean * uv_m.y() * outward;
    return {plan.x(), plan.y(), uv_m.y()};
  }
  double U(const Eigen::Vector2d& plan_m) const { return (plan_m - first_corner_m).dot(along); }
  /// Distance in front of the wall; negative behind it.
  double Front(const Eigen::Vector2d& plan_m) const { return (plan_m - first_corner_m).dot(outward); }
};

/// The wall on side `side` (corner `side` to the next) of a counter-clockwise ring.
Wall WallOf(const Ring& outer, int side);
/// The same as the building's levels let it lean, up to where it first breaks.
Wall WallOf(const Footprint& building, int side);

/// From where to where a wall goes at a height: its neighbours may lean on it, or it may stand back from
/// there on and end. None above its end.
std::optional<Eigen::Vector2d> SpanAt(const Footprint& building, int side, double height_m);

/// Where a horizontal line that goes into a building at `u_m` of wall `side` comes out again.
struct WayOut {
  int side = -1;
  double u_m = 0.0;       ///< On the wall where it comes out.
  double length_m = 0.0;  ///< Inside the building.
};

/// None when the line leaves through a courtyard, or through a wall that is not roughly (20 degrees)
/// opposite.
///
/// @param drift  Of u for each metre into the building; 0: at right angles to the wall.
std::optional<WayOut> FindWayOut(const Polygon& footprint, int side, double u_m, double drift = 0.0);

}  // namespace soffit
