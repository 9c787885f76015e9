#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "service/facade/facade.h"
#include "service/solid/solid.h"

namespace soffit {

/// What a camera would see of solids on a flat ground, pixel by pixel.
struct Prediction {
  cv::Mat1b label;    ///< Seen::kStructure, kGround or kSky.
  cv::Mat1f depth_m;  ///< Along the optical axis; infinite for sky.
};

Prediction Predict(const View& view, const std::vector<const Mesh*>& meshes);

/// An upright prism without openings: what is known of a building that was only seen from above.
Mesh RaiseBlock(const Ring& outer, double height_m);

}  // namespace soffit
