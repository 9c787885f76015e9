#include "service/footprint/simpler.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "service/footprint/cross.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

using Eigen::Vector2d;

constexpr double kLeastSine = 0.15;  // Sides that bend less go on as one line.

/// One ring with fewer corners.
struct Removal {
  std::size_t ring = 0;
  Ring without;
  std::vector<std::size_t> sides;  ///< Those that are left.
  double change_m = 0.0;
};

template <typename T>
std::vector<T> Drop(std::vector<T> from, std::size_t index) {
  from.erase(from.begin() + static_cast<std::ptrdiff_t>(index));
  return from;
}

template <typename T>
std::vector<T> Pick(const std::vector<T>& from, const std::vector<std::size_t>& places) {
  std::vector<T> picked;
  for (const std::size_t place : places) picked.push_back(from[place]);
  return picked;
}

void AddRemovals(const Ring& ring, std::size_t r, std::vector<Removal>& removals) {
  const std::size_t n = ring.size();
  const auto at = [&](std::size_t k) { return ring[k % n]; };
  std::vector<std::size_t> sides(n);
  std::iota(sides.begin(), sides.end(), 0U);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    removals.push_back({r, Drop(ring, i), Drop(sides, i), DistanceToSegment(at(i), at(i + n - 1), at(j))});
    const Vector2d before = at(i) - at(i + n - 1), after = at(j + 1) - at(j);
    const double sine = Cross(before.normalized(), after.normalized());
    if (std::abs(sine) > kLeastSine) {
      const Vector2d meeting =
          at(i) + before.normalized() * (Cross(at(j) - at(i), after.normalized()) / sine);
      Ring without = ring;
      without[i] = meeting;
      std::vector<std::size_t> left = sides;
      left[i] = j;
      removals.push_back({r, Drop(std::move(without), j), Drop(std::move(left), j),
                          DistanceToSegment(meeting, at(i), at(j))});
    } else if (n > 4 && before.dot(after) > 0.0) {
      const auto drop_both = [&](const auto& from) {
        return Drop(Drop(from, std::max(i, j)), std::min(i, j));
      };
      removals.push_back({r, drop_both(ring), drop_both(sides), (at(j) - at(i)).norm()});
    }
  }
}

Massing WithoutCorners(Massing massing, Removal removal) {
  massing.rings[removal.ring] = std::move(removal.without);
  if (removal.ring > 0) return massing;
  for (Level& level : massing.levels) level.inset_m = Pick(level.inset_m, removal.sides);
  for (std::vector<bool>& is_free : massing.is_free) is_free = Pick(is_free, removal.sides);
  return massing;
}

}  // namespace

std::vector<Massing> WithFewerCorners(const Massing& massing, double most_change_m) {
  constexpr std::size_t kMost = 5;
  std::vector<Removal> removals;
  for (std::size_t r = 0; r < massing.rings.size(); ++r) {
    if (massing.rings[r].size() > 3) AddRemovals(massing.rings[r], r, removals);
  }
  std::erase_if(removals, [&](const Removal& removal) { return !(removal.change_m < most_change_m); });
  std::sort(removals.begin(), removals.end(),
            [](const Removal& a, const Removal& b) { return a.change_m < b.change_m; });
  if (removals.size() > kMost) removals.resize(kMost);
  std::vector<Massing> simpler;
  for (Removal& removal : removals) simpler.push_back(WithoutCorners(massing, std::move(removal)));
  return simpler;
}

Massing WithoutInset(const Massing& massing, std::size_t level, std::size_t side) {
  Massing simpler = massing;
  simpler.is_free[level][side] = false;
  return simpler;
}

Massing WithoutLevel(const Massing& massing, std::size_t level) {
  SOFFIT_EXPECT(massing.levels.size() > 1 && level < massing.levels.size());
  Massing simpler = massing;
  simpler.levels = Drop(simpler.levels, level);
  if (simpler.is_free.empty()) return simpler;
  simpler.is_free = Drop(simpler.is_free, level);
  if (level == simpler.levels.size()) return simpler;
  for (std::size_t side = 0; side < massing.is_free[level].size(); ++side) {
    if (massing.is_free[level][side]) simpler.is_free[level][side] = true;
  }
  return simpler;
}

}  // namespace soffit
