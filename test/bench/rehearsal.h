#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "service/mission/mission.h"
#include "service/pipeline/pipeline.h"
#include "test/sim/truth/truth.h"
#include "test/sim/world/world.h"

namespace soffit::bench {

/// How a rehearsal ended, and what the world's ground truth says of it.
struct RehearsalResult {
  sim::Outcome expected = sim::Outcome::kNotFlown;
  MissionOutcome outcome = MissionOutcome::kNone;
  std::string message;  ///< Why the mission ended so.
  int pictures = 0;
  int contacts = 0;
  std::string first_contact;  ///< With what, and where; empty: none.
  bool was_passage_flown = false;
  bool was_flown_wrongly = false;  ///< Under what is not truly passable.
  double least_distance_m = -1.0;  ///< Of the bare vehicle to anything but the ground; negative: did not fly.
  std::string nearest;

  bool IsRight() const;
};

/// A rehearsal is a whole mission with the service's real mission logic and real stages on rendered pictures,
/// but without its processes, links and waiting: the vehicle is where it was sent at once. It believes in
/// poses that are wrong by the world's noise and flies by them. Takes seconds instead of minutes. Same world
/// and seed: same result.
///
/// @param folder  Keeps `world.yaml`, the pictures with their poses (soffit-survey/1) and `reference.png`, as
///                `soffit analyze` reads them; empty: nothing is kept.
RehearsalResult Rehearse(const sim::World& world, std::uint64_t seed, const PipelineOptions& pipeline,
                         const MissionOptions& mission, const std::filesystem::path& folder);

}  // namespace soffit::bench
