#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>
#include <vector>

#include "shared/flight/flight.h"

namespace soffit {

/// The corridor that a vehicle is, or may be, inside of, and how far from its line the vehicle may get.
struct CorridorLine {
  Eigen::Vector3d entry_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d exit_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  double speed_mps = 0.0;
  double lateral_limit_m = 0.0;
  double vertical_limit_m = 0.0;

  /// The nearest point between entry and exit: at the line's own height, never above it.
  Eigen::Vector3d Nearest(const Eigen::Vector3d& position_m) const;
};

/// The line of a kFlyCorridor command with its permit. The limits leave (1 - `margin_ratio`) of the safety
/// margin to the walls of the free cross-section.
CorridorLine MakeCorridorLine(const FlightCommand& command, const VehicleEnvelope& envelope,
                              double margin_ratio);

/// One thing to do after another, as commands are carried out.
struct Stage {
  enum class Kind {
    kClimb,    ///< Take off to `height_m`.
    kFly,      ///< Along `path`, to rest at its end.
    kAlign,    ///< To the nearest point of the corridor's line, better than usual.
    kPass,     ///< Along the corridor to its end.
    kBackOut,  ///< Along the corridor to its entry.
    kSettle,   ///< Until the vehicle and its camera are at rest.
    kExpose,   ///< Until the picture is taken and handed over.
    kStop,     ///< Come to rest as soon as possible.
    kDescend,  ///< Land here.
  };
  Kind kind = Kind::kStop;
  std::vector<Eigen::Vector3d> path{};
  double height_m = 0.0;
  double speed_mps = 0.0;
  std::optional<double> yaw_rad{};           ///< None: as it is.
  std::optional<double> camera_pitch_rad{};  ///< For the gimbal.
};
bool IsPathStage(Stage::Kind kind);  ///< kFly, kAlign, kPass, kBackOut.

using Plan = std::deque<Stage>;

/// What a command that was accepted takes, from this position. Stopping inside a corridor stays on its line;
/// an abort there leaves it the way the vehicle came.
Plan MakePlan(const FlightCommand& command, const Eigen::Vector3d& position_m,
              const std::optional<CorridorLine>& corridor);

/// Stop, and out of the corridor to its entry if there is one.
Plan MakeBackOutPlan(const std::optional<CorridorLine>& corridor);

/// The same, then up to `height_m`, home and down.
Plan MakeReturnPlan(const Eigen::Vector3d& position_m, const std::optional<CorridorLine>& corridor,
                    double height_m, double speed_mps);

}  // namespace soffit
