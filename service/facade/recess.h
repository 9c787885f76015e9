#pragma once

#include <optional>

#include "service/facade/facade.h"
#include "service/facade/wall.h"

namespace soffit {

/// The recess behind a mouth, from the edges of its back wall: the mouth's outline is swept inward, and lies
/// where its base, sides and head fall on edges of the picture at once. None when the picture does not tell.
///
/// @param mouth      In wall coordinates.
/// @param deepest_m  > 0; no recess is deeper.
std::optional<Recess> FindRecess(const Sight& sight, const Wall& wall, const Ring& mouth, double deepest_m);

}  // namespace soffit
