#pragma once

#include <Eigen/Core>
#include <vector>

#include "service/footprint/level.h"

namespace soffit {

/// A building that is being fitted: outline, courtyards (plumb), levels, and what of these may change.
struct Massing {
  std::vector<Ring> rings;    ///< The first is the outer one; holes are clockwise.
  std::vector<Level> levels;  ///< At least one; the last is the roof. Two at one height make a ledge.
  std::vector<std::vector<bool>> is_free;  ///< For each level and side; others stand back as the level below.

  double height_m() const { return levels.back().height_m; }
};

/// A prism.
Massing Upright(const Polygon& polygon, double height_m);

/// Where the parameters of a massing are in a vector: x and y of each corner of all rings, then each distinct
/// height, the roof's last, then the insets that are free.
struct Layout {
  explicit Layout(const Massing& massing);
  std::vector<Eigen::Index> height;              ///< For each level.
  std::vector<std::vector<Eigen::Index>> inset;  ///< For each level and side; -1: it is 0.
  Eigen::Index roof_height = 0;
  Eigen::Index size = 0;
};

/// The massing with its parameters changed by so much, as far as it remains one: walls never lean outward,
/// sides do not turn round, levels rise.
Massing Changed(const Massing& massing, const Eigen::VectorXd& change);

}  // namespace soffit
