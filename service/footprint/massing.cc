#include "service/footprint/massing.h"

#include <algorithm>

namespace soffit {
namespace {

using Eigen::Index;
using Eigen::Vector2d;

constexpr double kLeastStorey_m = 0.01;

}  // namespace

Massing Upright(const Polygon& polygon, double height_m) {
  Massing massing{{polygon.outer}, {{height_m, std::vector<double>(polygon.outer.size(), 0.0)}}, {}};
  massing.rings.insert(massing.rings.end(), polygon.holes.begin(), polygon.holes.end());
  return massing;
}

Layout::Layout(const Massing& massing) {
  for (const Ring& ring : massing.rings) size += static_cast<Index>(2 * ring.size());
  for (std::size_t l = 0; l < massing.levels.size(); ++l) {
    const bool is_ledge = l > 0 && massing.levels[l].height_m == massing.levels[l - 1].height_m;
    height.push_back(is_ledge ? height.back() : size++);
  }
  roof_height = height.back();
  for (std::size_t l = 0; l < massing.levels.size(); ++l) {
    inset.push_back(l > 0 ? inset.back() : std::vector<Index>(massing.rings.front().size(), -1));
    if (massing.is_free.empty()) continue;
    for (std::size_t i = 0; i < inset[l].size(); ++i) {
      if (massing.is_free[l][i]) inset[l][i] = size++;
    }
  }
}

Massing Changed(const Massing& massing, const Eigen::VectorXd& change) {
  const Layout layout(massing);
  Massing changed = massing;
  Index at = 0;
  for (Ring& ring : changed.rings) {
    for (Vector2d& corner : ring) {
      corner += change.segment<2>(at);
      at += 2;
    }
  }
  const Ring& outer = changed.rings.front();
  std::vector<double> below_m(outer.size(), 0.0);
  double ground_m = 0.0;
  for (std::size_t l = 0; l < changed.levels.size(); ++l) {
    Level& level = changed.levels[l];
    const bool is_ledge = l > 0 && layout.height[l] == layout.height[l - 1];
    level.height_m =
        is_ledge ? ground_m : std::max(level.height_m + change(layout.height[l]), ground_m + kLeastStorey_m);
    for (std::size_t i = 0; i < outer.size(); ++i) {
      const bool is_free = !massing.is_free.empty() && massing.is_free[l][i];
      level.inset_m[i] =
          is_free ? std::max(below_m[i], level.inset_m[i] + change(layout.inset[l][i])) : below_m[i];
    }
    const double share = LargestShare(outer, below_m, level.inset_m);
    for (std::size_t i = 0; i < outer.size() && share < 1.0; ++i)
      level.inset_m[i] = below_m[i] + share * (level.inset_m[i] - below_m[i]);
    below_m = level.inset_m;
    ground_m = level.height_m;
  }
  return changed;
}

}  // namespace soffit
