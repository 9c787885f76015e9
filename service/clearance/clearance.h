#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "service/clearance/distances.h"
#include "service/corridor/corridor.h"
#include "service/scene/scene.h"
#include "service/viewpoint/viewpoint.h"
#include "shared/options/options.h"

namespace soffit {

/// Zero is the safe one.
enum class Verdict { kInsufficientData, kBlocked, kClear };
const char* ToString(Verdict verdict);  ///< "CLEAR", "BLOCKED", "INSUFFICIENT_DATA".

/// What bounds the room of a vehicle in a corridor, as it flies.
enum class Bound { kNone, kRoof, kLeft, kRight, kGround };
const char* ToString(Bound bound);  ///< "roof", "left", "right", "ground", "".

/// Whether one vehicle may fly under or through one object, from one side, and from what that is known.
struct ClearanceDecision {
  std::uint64_t decision_id = 0;  ///< Set where decisions are published; 0 before.
  std::uint32_t vehicle_id = 0;
  std::uint32_t object_id = 0;
  int side = -1;  ///< The wall that is entered; -1: the object as a whole.
  Verdict verdict = Verdict::kInsufficientData;
  std::string reason;                ///< Specific, with numbers: "too low by 0.05 m".
  std::optional<Corridor> corridor;  ///< Always there when CLEAR.
  VehicleEnvelope vehicle;
  double margin_left_m = 0.0;  ///< Beyond the safety margin and k sigma; negative: too tight.
  double margin_right_m = 0.0;
  double margin_up_m = 0.0;
  double margin_down_m = 0.0;
  Bound binding = Bound::kNone;  ///< Where the margin is least; with a corridor only.
  Distances distances;           ///< Of the vehicle on the corridor; at most kDistanceReach_m.
  double seen_ratio = 0.0;  ///< Share of the swept volume that was seen to be free; 0 where it does not fit.
  std::vector<std::uint32_t> evidence;  ///< Capture ids.
  std::optional<Viewpoint> wanted;      ///< INSUFFICIENT_DATA: the picture that would settle it.
  std::uint64_t scene_revision = 0;
};

constexpr double kDistanceReach_m = 1.0;

struct ClearanceOptions {
  double sigmas = 3.0;
  double min_seen_ratio = 1.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("sigmas", self.sigmas, OptionInfo{0.0, 10.0, "", "Standard deviations added to every margin"});
    field("min_seen_ratio", self.min_seen_ratio,
          OptionInfo{0.9, 1.0, "", "Share of the corridor that must have been seen free"});
  }
};

/// One decision for each side of the object that a corridor enters, or one with side -1 when nothing leads
/// through. CLEAR only when two independent checks agree: the exact geometry of the solids (CGAL), and a
/// sweep of the OctoMap in which unknown counts as occupied. Unknown is not free: what was not seen is
/// INSUFFICIENT_DATA; so is a corridor that bends, for no straight look goes through it. Pure.
std::vector<ClearanceDecision> JudgeClearance(const Scene& scene, std::uint32_t object_id,
                                              const std::vector<Corridor>& corridors,
                                              const std::vector<Sight>& sights,
                                              const VehicleEnvelope& vehicle,
                                              const ClearanceOptions& options);

}  // namespace soffit
