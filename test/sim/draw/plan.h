#pragma once

#include <vector>

#include "test/sim/draw/wanted.h"

namespace soffit::sim {

/// What the light does to the pictures.
enum class Light { kFair, kLowSun, kHaze, kGlare, kDusk };

/// What a world is to be; the rest is drawn.
struct Plan {
  const char* kind = "";
  Order order = {};
  Light light = Light::kFair;
  bool is_meadow = false;  ///< The ground has the colour of bushes.
};

/// Of an ordinary world: half of them have a passage that is large enough.
Plan DrawPlan(Dice& dice);

/// Kinds of worlds in which it is easy to be wrong.
const std::vector<Plan>& NastyPlans();

}  // namespace soffit::sim
