#pragma once

#include <cstdint>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// A random world, always the same for a seed: a wanted building with a passage that is clearly large enough,
/// or clearly not, or with an obstacle in it, or through which nothing leads, or which is absent; among
/// others that look alike (mirrored, of other proportions); alone or as a group; with any colours, ground,
/// light, wind and pose noise. What is wanted lies in a picture from 9 m above home. Whether it is passable
/// is for FindTruth to say; worlds in which the best way is within 8 cm of the limit (more when the pose is
/// noisy) are drawn again. Takes about a second.
World DrawWorld(std::uint64_t seed);

/// A random world in which it is easy to be wrong: what hinders is thin, of the colour of what is behind it,
/// or lacks by a few centimetres; what leads nowhere looks as if it did; or the light is bad. Kinds take
/// turns from seed to seed; the title is the kind, up to the first comma. Else as DrawWorld gives them, but
/// for worlds that are within 1.5 cm of the limit.
World DrawNastyWorld(std::uint64_t seed);

}  // namespace soffit::sim
