#include "vehicle_agent/agent/path_run.h"

#include <algorithm>
#include <cmath>

namespace soffit {
namespace {

constexpr double kShortestLeg_m = 1e-3;

}  // namespace

PathRun::PathRun(const Eigen::Vector3d& from, const std::vector<Eigen::Vector3d>& path) : points_{from} {
  for (const Eigen::Vector3d& point : path) {
    if ((point - points_.back()).norm() > kShortestLeg_m) points_.push_back(point);
  }
}

double PathRun::LegLength_m() const {
  return points_.size() < 2 ? 0.0 : (points_[leg_ + 1] - points_[leg_]).norm();
}

Eigen::Vector3d PathRun::Carrot() const {
  if (points_.size() < 2) return points_.back();
  return points_[leg_] + (points_[leg_ + 1] - points_[leg_]) * (along_m_ / LegLength_m());
}

bool PathRun::IsAtEnd() const { return IsLastLeg() && along_m_ >= LegLength_m(); }

double PathRun::RemainingLength_m() const {
  double length_m = LegLength_m() - along_m_;
  for (std::size_t i = leg_ + 2; i < points_.size(); ++i) length_m += (points_[i] - points_[i - 1]).norm();
  return length_m;
}

CrossTrack PathRun::MeasureCrossTrack(const Eigen::Vector3d& position_m) const {
  if (points_.size() < 2) return {};
  const Eigen::Vector3d leg = points_[leg_ + 1] - points_[leg_];
  const Eigen::Vector3d off = position_m - points_[leg_];
  const Eigen::Vector3d across = off - leg * (off.dot(leg) / leg.squaredNorm());
  const Eigen::Vector2d ahead = leg.head<2>();
  if (!(ahead.norm() > kShortestLeg_m)) return {across.head<2>().norm(), 0.0};
  return {(ahead.x() * across.y() - ahead.y() * across.x()) / ahead.norm(), across.z()};
}

void PathRun::Advance(const Eigen::Vector3d& position_m, double dt_s, const PathPace& pace) {
  if (points_.size() < 2) return;
  if (along_m_ >= LegLength_m()) {
    if (IsLastLeg() || (position_m - points_[leg_ + 1]).norm() > pace.corner_tolerance_m) return;
    ++leg_;
    along_m_ = 0.0;
    speed_mps_ = 0.0;
  }
  const Eigen::Vector3d direction = (points_[leg_ + 1] - points_[leg_]) / LegLength_m();
  const double lead_m = (Carrot() - position_m).dot(direction);
  const double rest_m = LegLength_m() - along_m_;
  const double wanted_mps =
      lead_m > pace.lead_m ? 0.0 : std::min(pace.speed_mps, std::sqrt(2.0 * pace.acceleration_mps2 * rest_m));
  const double step_mps = pace.acceleration_mps2 * dt_s;
  speed_mps_ = std::clamp(wanted_mps, speed_mps_ - 2.0 * step_mps, speed_mps_ + step_mps);
  // The last millimetres of the square-root approach would take for ever.
  along_m_ = rest_m < 0.01 ? LegLength_m() : std::min(along_m_ + speed_mps_ * dt_s, LegLength_m());
}

}  // namespace soffit
