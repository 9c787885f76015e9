#pragma once

#include <Eigen/Core>
#include <vector>

namespace soffit {

/// How a point is led along a path ahead of the vehicle.
struct PathPace {
  double speed_mps = 1.0;
  double acceleration_mps2 = 1.0;
  double lead_m = 2.0;  ///< The point waits when it is farther ahead than this.
  double corner_tolerance_m =
      0.4;  ///< The vehicle has to come so close to a corner before the next leg begins.
};

/// Deviation of a position from the leg that is flown.
struct CrossTrack {
  double lateral_m = 0.0;   ///< Positive to the left of the way.
  double vertical_m = 0.0;  ///< Positive upward.
};

/// A polygonal path that is being flown, leg by leg: the vehicle follows a point that runs along the leg with
/// bounded speed and acceleration, comes to rest at each corner, and waits there for the vehicle. Straight
/// legs stay straight whatever the autopilot's own speed limits are.
class PathRun {
 public:
  PathRun() = default;

  /// @param from  Where it begins, as a rule the vehicle's position. Points without distance to their
  /// predecessor are
  ///              left out; an empty path is at its end at once.
  PathRun(const Eigen::Vector3d& from, const std::vector<Eigen::Vector3d>& path);

  /// Moves the point on by `dt_s`; a vehicle that lags makes it wait.
  void Advance(const Eigen::Vector3d& position_m, double dt_s, const PathPace& pace);

  /// Takes all speed from the point, as if it began anew where it is.
  void Halt() { speed_mps_ = 0.0; }

  Eigen::Vector3d Carrot() const;
  const Eigen::Vector3d& End() const { return points_.back(); }
  bool IsAtEnd() const;              ///< Of the point, not of the vehicle.
  double RemainingLength_m() const;  ///< From the point to the end.
  CrossTrack MeasureCrossTrack(const Eigen::Vector3d& position_m) const;

 private:
  bool IsLastLeg() const { return leg_ + 2 >= points_.size(); }
  double LegLength_m() const;

  std::vector<Eigen::Vector3d> points_{Eigen::Vector3d::Zero()};
  std::size_t leg_ = 0;
  double along_m_ = 0.0;
  double speed_mps_ = 0.0;
};

}  // namespace soffit
