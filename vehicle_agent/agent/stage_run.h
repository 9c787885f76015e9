#pragma once

#include <optional>
#include <string>

#include "vehicle_agent/agent/agent_options.h"
#include "vehicle_agent/agent/path_run.h"
#include "vehicle_agent/agent/plan.h"
#include "vehicle_agent/vehicle/vehicle.h"

namespace soffit {

struct StageEnd {
  std::string problem;  ///< Empty: it did what it should.
};

/// One stage of a plan while it is flown: turns telemetry and time into an intent until the stage is at its
/// end. Pure.
class StageRun {
 public:
  /// @param corridor  The one that the vehicle is in, or enters; kPass and kBackOut need it.
  /// @param intent    The present one, from which it goes on without a jump.
  StageRun(const Stage& stage, const std::optional<CorridorLine>& corridor, const VehicleEnvelope& envelope,
           const AgentOptions& options, const Telemetry& telemetry, Intent& intent);

  const Stage& stage() const { return stage_; }

  /// Goes on by `dt_s`; its end when it is reached, or has failed. A kExpose ends only by its time.
  std::optional<StageEnd> Go(const Telemetry& telemetry, double dt_s, Intent& intent);

  /// A pause: the vehicle stays where it is being led to.
  void Halt() { path_.Halt(); }

 private:
  double AllowedTime_s(const Telemetry& telemetry) const;
  bool IsCalm(const Telemetry& telemetry, const Intent& intent, double tolerance_m) const;
  std::optional<StageEnd> GoOn(const Telemetry& telemetry, double dt_s, Intent& intent);
  std::optional<StageEnd> Climb(const Telemetry& telemetry, Intent& intent) const;
  std::optional<StageEnd> FollowPath(const Telemetry& telemetry, double dt_s, Intent& intent);
  std::optional<StageEnd> Settle(const Telemetry& telemetry, double dt_s, const Intent& intent);
  std::string MeasureDeviation(const Telemetry& telemetry, double dt_s);

  Stage stage_;
  std::optional<CorridorLine> corridor_;
  VehicleEnvelope envelope_;
  AgentOptions options_;
  PathRun path_;
  double allowed_s_ = 0.0;
  double active_s_ = 0.0;   ///< Time in which it was allowed to go on.
  double calm_s_ = 0.0;     ///< How long it has been at rest.
  double lateral_m_ = 0.0;  ///< Smoothed deviation from the corridor's line.
  double vertical_m_ = 0.0;
};

/// Leads the vehicle to a point, with the heading that it has unless it was told another one before.
void HoldAt(const Eigen::Vector3d& position_in_map_m, double present_yaw_rad, Intent& intent);

/// Where the vehicle comes to rest when it brakes now; inside a corridor on its line: never above it.
Eigen::Vector3d FindStoppingPoint(const Telemetry& telemetry, const std::optional<CorridorLine>& corridor);

}  // namespace soffit
