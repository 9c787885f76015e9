#include "service/clearance/describe.h"

#include "shared/result/say.h"

namespace soffit {
namespace {

std::string SayDistance(double distance_m) {
  return Say(distance_m < kDistanceReach_m ? "" : "over ", distance_m, " m");
}

}  // namespace

std::string Describe(const ClearanceDecision& decision) {
  return Say("Building ", decision.object_id, decision.side >= 0 ? Say(", side ", decision.side) : "", ": ",
             ToString(decision.verdict), ": ", decision.reason);
}

std::string DescribeRoom(const ClearanceDecision& decision) {
  if (!decision.corridor) return "";
  const Corridor& corridor = *decision.corridor;
  std::string text = Say("free ", corridor.free_width_m, " x ", corridor.free_height_m, " m; margins left ",
                         decision.margin_left_m, ", right ", decision.margin_right_m, ", up ",
                         decision.margin_up_m, ", down ", decision.margin_down_m, " m");
  if (decision.binding != Bound::kNone) text += Say(", least at the ", ToString(decision.binding));
  text += Say("; to occupied ", SayDistance(decision.distances.to_occupied_m), ", to unknown ",
              SayDistance(decision.distances.to_unknown_m), ", to the model ",
              SayDistance(decision.distances.to_surface_m));
  if (const std::size_t bends = corridor.bends_in_map_m.size(); bends > 0)
    text += Say("; ", bends, bends == 1 ? " bend" : " bends");
  return text;
}

}  // namespace soffit
