#pragma once

#include "shared/options/options.h"
#include "vehicle_agent/agent/failure_policy.h"

namespace soffit {

struct AgentOptions {
  double acceleration_mps2 = 1.0;
  double lead_s = 1.5;
  double corner_tolerance_m = 0.4;
  double arrival_tolerance_m = 0.35;
  double settle_speed_mps = 0.25;
  double settle_rate_radps = 0.25;
  double settle_yaw_rad = 0.12;
  double settle_s = 0.6;
  double settle_timeout_s = 30.0;
  int picture_tries = 3;
  double picture_timeout_s = 60.0;
  double takeoff_timeout_s = 90.0;
  double corridor_align_m = 0.2;
  double corridor_margin_ratio = 0.5;
  double hold_after_silence_s = 3.0;
  double return_after_silence_s = 60.0;
  double lost_position_s = 3.0;
  double return_height_m = 6.0;
  double return_speed_mps = 1.5;
  double rival_listen_s = 2.0;
  FailurePolicy on_failure;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("acceleration_mps2", self.acceleration_mps2,
          OptionInfo{0.1, 10.0, "m/s2", "Of the point that is followed"});
    field("lead_s", self.lead_s,
          OptionInfo{0.2, 5.0, "s", "Times the speed: how far that point may run ahead"});
    field("corner_tolerance_m", self.corner_tolerance_m,
          OptionInfo{0.05, 5.0, "m", "How close corners are flown to"});
    field("arrival_tolerance_m", self.arrival_tolerance_m,
          OptionInfo{0.05, 5.0, "m", "How close the end is flown to"});
    field("settle_speed_mps", self.settle_speed_mps,
          OptionInfo{0.01, 2.0, "m/s", "Slower counts as at rest"});
    field("settle_rate_radps", self.settle_rate_radps,
          OptionInfo{0.01, 2.0, "rad/s", "Slower turning counts as rest"});
    field("settle_yaw_rad", self.settle_yaw_rad,
          OptionInfo{0.01, 1.0, "rad", "Greatest heading error at rest"});
    field("settle_s", self.settle_s, OptionInfo{0.0, 10.0, "s", "Rest before a picture is taken"});
    field("settle_timeout_s", self.settle_timeout_s,
          OptionInfo{1.0, 300.0, "s", "No rest until then: the look fails"});
    field("picture_tries", self.picture_tries, OptionInfo{1, 20, "", "How often a picture is tried"});
    field("picture_timeout_s", self.picture_timeout_s,
          OptionInfo{1.0, 300.0, "s", "For taking and handing over one picture"});
    field("takeoff_timeout_s", self.takeoff_timeout_s,
          OptionInfo{5.0, 600.0, "s", "From the command to the height"});
    field("corridor_align_m", self.corridor_align_m,
          OptionInfo{0.02, 1.0, "m", "How well it lines up before it enters"});
    field("corridor_margin_ratio", self.corridor_margin_ratio,
          OptionInfo{0.0, 1.0, "", "Share of the safety margin that may be used up before it backs out"});
    field("hold_after_silence_s", self.hold_after_silence_s,
          OptionInfo{0.5, 60.0, "s", "Service not heard for so long: it is silent"});
    field("return_after_silence_s", self.return_after_silence_s,
          OptionInfo{1.0, 3600.0, "s", "Service not heard for so long: it is gone"});
    field("lost_position_s", self.lost_position_s,
          OptionInfo{0.5, 30.0, "s", "Position not heard for so long: it is lost"});
    field("return_height_m", self.return_height_m,
          OptionInfo{1.0, 1000.0, "m",
                     "The way home is at least so high, and as high as this flight ever was"});
    field("return_speed_mps", self.return_speed_mps, OptionInfo{0.1, 20.0, "m/s", "On the way home"});
    field("rival_listen_s", self.rival_listen_s,
          OptionInfo{0.0, 60.0, "s",
                     "Listens so long for another agent of the same vehicle before it commands"});
    field("on_failure", self.on_failure);
  }
};

}  // namespace soffit
