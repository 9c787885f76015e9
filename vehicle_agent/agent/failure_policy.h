#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "shared/options/options.h"

namespace soffit {

/// What can go wrong in the air, as the agent sees it. That the service died, hangs or cannot be reached
/// looks the same from there.
enum class Failure {
  kServiceSilent,
  kServiceGone,
  kCameraLost,
  kBatteryLow,
  kOutOfBounds,       ///< Outside the geofence, or faster than allowed.
  kPositionDoubtful,  ///< The autopilot tells a position, but its GPS or estimator is not well.
  kPositionLost,
  kAutopilotSilent,
};

/// What the vehicle is doing at that moment.
enum class Situation { kInTransit, kLooking, kInCorridor, kAtRest };

/// From the mildest to the gravest.
enum class Reaction {
  kGoOn,
  kWait,     ///< Pauses, and goes on when the failure is over.
  kHold,     ///< Stops; the command fails.
  kBackOut,  ///< The same, and leaves a corridor the way it came.
  kReturn,   ///< Stops, leaves a corridor the way it came, climbs, flies home, lands.
  kLand,     ///< Lands where it is.
  kRelease,  ///< Commands nothing: what happens next is the autopilot's failsafe.
};

/// Reactions to one failure, by situation, in words: go_on, wait, hold, back_out, return, land, release.
struct FailureRow {
  std::string in_transit;
  std::string looking;
  std::string in_corridor;
  std::string at_rest;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    const std::string words = "go_on, wait, hold, back_out, return, land or release";
    field("in_transit", self.in_transit, OptionInfo{0, 0, "", words});
    field("looking", self.looking, OptionInfo{0, 0, "", "The same, from settling to the picture's arrival"});
    field("in_corridor", self.in_corridor, OptionInfo{0, 0, "", "The same, between entry and exit"});
    field("at_rest", self.at_rest,
          OptionInfo{0, 0, "", "The same, without a command; also inside a corridor"});
  }
};

/// The table of vehicle_agent/README.md.
struct FailurePolicy {
  FailureRow service_silent{"wait", "go_on", "go_on", "go_on"};
  FailureRow service_gone{"return", "return", "go_on", "return"};
  FailureRow camera_lost{"go_on", "hold", "go_on", "go_on"};
  FailureRow battery_low{"return", "return", "go_on", "return"};
  FailureRow out_of_bounds{"hold", "hold", "hold", "go_on"};
  FailureRow position_doubtful{"hold", "hold", "hold", "go_on"};
  FailureRow position_lost{"hold", "hold", "hold", "hold"};
  FailureRow autopilot_silent{"hold", "hold", "hold", "hold"};

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("service_silent", self.service_silent);
    field("service_gone", self.service_gone);
    field("camera_lost", self.camera_lost);
    field("battery_low", self.battery_low);
    field("out_of_bounds", self.out_of_bounds);
    field("position_doubtful", self.position_doubtful);
    field("position_lost", self.position_lost);
    field("autopilot_silent", self.autopilot_silent);
  }
};

/// The first cell that does not hold a reaction, or one that cannot be carried out then, in words; empty when
/// all is well. Without a position, or unheard by the autopilot, a vehicle can only hold, land or be
/// released.
std::string FindPolicyProblem(const FailurePolicy& policy);

/// The failures that show, each with words for people.
using FailureSigns = std::map<Failure, std::string>;

struct Trouble {
  Failure failure = Failure::kAutopilotSilent;
  Reaction reaction = Reaction::kGoOn;
  std::string words;  ///< What is wrong, and what is done about it.
};

/// The policy, read once. A cell that is not a reaction counts as hold.
class ReactionTable {
 public:
  explicit ReactionTable(const FailurePolicy& policy);

  /// Of all failures that show, the one with the gravest reaction; none when all let the vehicle go on.
  std::optional<Trouble> FindGravest(const FailureSigns& signs, Situation situation) const;

 private:
  std::array<std::array<Reaction, 4>, 8> reactions_{};  ///< By failure and situation.
};

}  // namespace soffit
