#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "service/facade/facade.h"
#include "service/scene/prediction.h"

namespace soffit {

/// A bar (pole, beam) that crosses an opening: in the picture a straight strip, about upright or level, that
/// stands out on both sides from what is beside it, and goes on at an end over the model where the model is
/// seen beside it. So it is nearer than the model there, whatever colour it has.
struct Bar {
  std::vector<cv::Rect> runs_px;  ///< One pixel thick each, side by side along the bar.
  float far_m = 0.0F;             ///< It is no deeper in the picture than this.
};

/// Bars are wider than 2 pixels. Pure.
std::vector<Bar> FindBars(const Sight& sight, const Prediction& prediction);

}  // namespace soffit
