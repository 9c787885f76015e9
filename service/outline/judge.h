#pragma once

#include <string>
#include <vector>

#include "service/image/image.h"
#include "service/outline/outline.h"

namespace soffit {

/// An outline that is not a building's, and why, for people.
struct RefusedOutline {
  Outline outline;
  std::string reason;
};

struct JudgedOutlines {
  std::vector<Outline> buildings;  ///< What may be one; in the order that they were given.
  std::vector<RefusedOutline> refused;
};

/// Tells outlines of buildings from those of lawns, shadows and shrubs that have a building's colour. Refused
/// are those that are ragged, and those across which the picture changes little more than along them, inside
/// or outside. At the edge of what the lens saw nothing counts. Pure; O(boundaries).
JudgedOutlines JudgeOutlines(std::vector<Outline> outlines, const Image& image);

}  // namespace soffit
