#pragma once

#include <optional>
#include <vector>

#include "service/solid/solid.h"

namespace soffit {

/// A straight level way through sections, and what of them lies behind each other along it.
struct Lane {
  Eigen::Vector2d way = Eigen::Vector2d::UnitY();  ///< Unit.
  double from_m = 0.0;                             ///< Along it: where the first section begins
  double to_m = 0.0;                               ///< and the last one ends.
  double left_m = 0.0;                             ///< Between these all sections overlap in plan.
  double right_m = 0.0;
  Ring section;  ///< The common part of all sections, (U, height), x-monotone; empty: there is none.

  Eigen::Vector2d Right() const { return {way.y(), -way.x()}; }
  double Along(const Eigen::Vector2d& plan_m) const { return way.dot(plan_m); }
  double U(const Eigen::Vector2d& plan_m) const { return Right().dot(plan_m); }
  Eigen::Vector2d InPlan(double u_m, double along_m) const { return u_m * Right() + along_m * way; }
};

/// The way along which the sections overlap most in width. That width is the least of the distances between
/// the right end of one section and the left end of another, seen along the way, each of which is a sine of
/// its direction: the greatest least one is at the peak of a sine or where two meet. None when no straight
/// line leads through all sections.
std::optional<Lane> FindWidestLane(const std::vector<Section>& sections);

}  // namespace soffit
