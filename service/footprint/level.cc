#include "service/footprint/level.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "shared/result/result.h"

namespace soffit {
namespace {

using Eigen::Vector2d;

constexpr double kFlatSine = 0.02;  // Sides that bend less meet anywhere: their corner moves across them.

Vector2d Inward(const Vector2d& from, const Vector2d& to) {
  const Vector2d along = (to - from).normalized();
  return {-along.y(), along.x()};
}

}  // namespace

Ring InsetRing(const Ring& outer, const std::vector<double>& inset_m) {
  const std::size_t n = outer.size();
  SOFFIT_EXPECT(inset_m.size() == n);
  Ring inset = outer;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = (i + n - 1) % n;
    if (inset_m[before] == 0.0 && inset_m[i] == 0.0) continue;
    const Vector2d of_before = Inward(outer[before], outer[i]);
    const Vector2d of_next = Inward(outer[i], outer[(i + 1) % n]);
    Eigen::Matrix2d normals;
    normals << of_before.transpose(), of_next.transpose();
    if (std::abs(normals.determinant()) < kFlatSine) {
      inset[i] += 0.5 * (inset_m[before] + inset_m[i]) * (of_before + of_next).normalized();
    } else {
      inset[i] += normals.inverse() * Vector2d(inset_m[before], inset_m[i]);
    }
  }
  return inset;
}

double LargestShare(const Ring& outer, const std::vector<double>& from_m, const std::vector<double>& to_m) {
  const Ring from = InsetRing(outer, from_m), to = InsetRing(outer, to_m);
  double share = 1.0;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const std::size_t j = (i + 1) % outer.size();
    const Vector2d along = (outer[j] - outer[i]).normalized();
    const double before = along.dot(from[j] - from[i]), after = along.dot(to[j] - to[i]);
    if (after < 0.0) share = std::min(share, std::max(0.0, before) / (std::max(0.0, before) - after));
  }
  return share;
}

double InsetAt(const std::vector<Level>& levels, std::size_t side, double height_m) {
  double below_m = 0.0, inset_m = 0.0;
  for (const Level& level : levels) {
    if (height_m < level.height_m) {
      const double share = (height_m - below_m) / (level.height_m - below_m);
      return inset_m + share * (level.inset_m[side] - inset_m);
    }
    below_m = level.height_m;
    inset_m = level.inset_m[side];
  }
  return inset_m;
}

}  // namespace soffit
