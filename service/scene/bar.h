#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "service/facade/facade.h"
#include "service/scene/prediction.h"

namespace soffit {

/// A bar (pole, beam) before background: in the picture a straight strip, about upright or level, that stands
/// out on both sides from what is beside it. It is told from marks on the ground and from edges of what lies
/// behind by what it covers, whatever colour it has: a part of the model, where the model is seen beside it
/// (so it is nearer than that), or sky, and it goes down from there to the ground (so it stands there).
struct Bar {
  std::vector<cv::Rect> runs_px;  ///< One pixel thick each, side by side along the bar.
  float near_m = 0.0F;            ///< Its depth in the picture; 0 when its foot is not seen,
  float far_m = 0.0F;             ///< and this is the most that it may be.
};

/// Bars are wider than 2 pixels. Pure.
std::vector<Bar> FindBars(const Sight& sight, const Prediction& prediction);

}  // namespace soffit
