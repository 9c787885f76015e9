#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "test/sim/world/world.h"

namespace soffit::bench {

/// What was decided from the pictures of one world, beside what is true there.
struct Judgement {
  std::uint64_t seed = 0;
  std::string kind;               ///< What the world's title says before the first comma.
  bool is_passable = false;       ///< Truly: some way under or through the wanted building.
  double spare_m = 0.0;           ///< Of its best way; negative: short by.
  std::string decision = "none";  ///< The best one on the wanted building; "none": it was not recognized.
  std::string reason;
  int pictures = 0;
  bool has_false_clear = false;  ///< CLEAR for a building that has no passable way, or for none at all.
  bool is_unsafe = false;        ///< CLEAR, but the vehicle does not keep its margin all along the corridor.
  double true_margin_m = -1.0;   ///< That it keeps truly, of all corridors that are CLEAR the least.
  double claimed_margin_m = -1.0;  ///< Safety margin and what is beyond it by the decision, of the same one.
  double seconds = 0.0;            ///< Of one core.
};

/// Renders a survey of a world from fixed places and runs the service's stages on it, in memory and on the
/// calling thread alone. When the decision is INSUFFICIENT_DATA and names the picture that would settle it,
/// that is taken too, as a mission would, up to `looks` times. Same world and seed: same judgement, but for
/// its time.
///
/// @param folder  Keeps there `world.yaml`, the survey with its truth and, in `analysis`, what was made of
///                all pictures; empty: nothing is kept.
Judgement JudgeWorld(const sim::World& world, std::uint64_t seed, int looks,
                     const std::filesystem::path& folder);

}  // namespace soffit::bench
