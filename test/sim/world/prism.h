#pragma once

#include <Eigen/Core>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// Where a point of a prism lies in the structure's frame; the point is given in the section, and along the
/// direction in which the section is moved.
inline Eigen::Vector3d Place(const Prism& prism, const Eigen::Vector2d& in_section, double along_m) {
  if (!prism.is_lying) return {in_section.x(), in_section.y(), along_m};
  const Eigen::Vector2d right(prism.axis.y(), -prism.axis.x());
  const Eigen::Vector2d xy = prism.at + in_section.x() * right + along_m * prism.axis;
  return {xy.x(), xy.y(), in_section.y()};
}

/// The way back: (in the section, in the section, along).
inline Eigen::Vector3d Unplace(const Prism& prism, const Eigen::Vector3d& point) {
  if (!prism.is_lying) return point;
  const Eigen::Vector2d right(prism.axis.y(), -prism.axis.x());
  const Eigen::Vector2d xy = point.head<2>() - prism.at;
  return {right.dot(xy), point.z(), prism.axis.dot(xy)};
}

}  // namespace soffit::sim
