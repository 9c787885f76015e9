#pragma once

#include "shared/frames/frames.h"
#include "shared/options/options.h"

namespace soffit {

/// How a camera sits on the vehicle. Body: x forward, y left, z up, from the point whose position the
/// autopilot tells. All zero: at that point, looking forward, upright.
struct CameraMount {
  double forward_m = 0.0;
  double left_m = 0.0;
  double up_m = 0.0;
  double yaw_deg = 0.0;
  double pitch_deg = 0.0;
  double roll_deg = 0.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("forward_m", self.forward_m,
          OptionInfo{-5.0, 5.0, "m", "Optical centre, from the autopilot's position"});
    field("left_m", self.left_m, OptionInfo{-5.0, 5.0, "m", ""});
    field("up_m", self.up_m, OptionInfo{-5.0, 5.0, "m", ""});
    field("yaw_deg", self.yaw_deg, OptionInfo{-180.0, 180.0, "deg", "To the left of forward"});
    field("pitch_deg", self.pitch_deg, OptionInfo{-90.0, 90.0, "deg", "0: horizontal, -90: straight down"});
    field("roll_deg", self.roll_deg,
          OptionInfo{-180.0, 180.0, "deg", "Picture turned, clockwise seen along the view"});
  }
};

Pose<Body, Camera> BodyFromCamera(const CameraMount& mount);

}  // namespace soffit
