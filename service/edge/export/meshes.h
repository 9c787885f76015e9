#pragma once

#include <string>
#include <vector>

#include "service/solid/solid.h"
#include "shared/result/result.h"

namespace soffit {

/// The models in the map's metres, one after another. Empty lists give files without triangles, but for
/// ToGlb(), of which glTF wants at least one: an error.
std::string ToObj(const std::vector<Solid>& solids);
std::string ToPly(const std::vector<Solid>& solids);  ///< Binary, little endian.
Result<std::string> ToGlb(
    const std::vector<Solid>& solids);  ///< glTF 2.0, y up, vertices relative to each model.

}  // namespace soffit
