#pragma once

#include <vector>

#include "service/footprint/massing.h"

namespace soffit {

/// Ways to draw one of the rings with fewer corners: without a corner; without a side, whose neighbours go on
/// until they meet or are one line. The five that move the ring least, and by less than `most_change_m`, the
/// least first. Sides that are left stand back as before.
std::vector<Massing> WithFewerCorners(const Massing& massing, double most_change_m);

/// A side that is free at a level stands back as at the level below instead.
Massing WithoutInset(const Massing& massing, std::size_t level, std::size_t side);

/// What is free at the level is so at the next one instead. There are at least two levels.
Massing WithoutLevel(const Massing& massing, std::size_t level);

}  // namespace soffit
