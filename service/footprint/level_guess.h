#pragma once

#include <vector>

#include "service/footprint/profile.h"

namespace soffit {

/// Levels as profiles show them.
struct LevelGuess {
  std::vector<Level> levels;
  std::vector<std::vector<bool>> is_free;  ///< For each level and side: whether it stands farther back there.
  double misfit_m = 0.0;                   ///< Sum over all sides and heights.
};

/// How a building's sides stand back on their way up: as straight lines between the heights at which the
/// profiles have corners. The best guesses with no, one and two such heights, each as long as it is much
/// better than the one before.
std::vector<LevelGuess> GuessLevels(const Ring& outer, const std::vector<Profile>& profiles, double height_m);

}  // namespace soffit
