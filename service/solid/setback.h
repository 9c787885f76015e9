#pragma once

#include <optional>

#include "service/footprint/footprint.h"
#include "service/solid/boolean.h"

namespace soffit {

/// What to take out of a prism, as high as the building, where one of its sides stands back on its way up:
/// all that is outside of the side's profile. None where the wall is plumb up to the roof.
std::optional<Prism> CutAbove(const Footprint& footprint, int side);

}  // namespace soffit
