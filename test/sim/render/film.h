#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// What lens and sensor make of the light: vignetting, blur, automatic exposure (between bounds about
/// `nominal_gain`, the gain that shows a white sunlit surface just below white), soft shoulder, sRGB gamma,
/// noise.
/// @param light  Linear BGR radiance.
cv::Mat3b Develop(const cv::Mat3f& light, const CameraModel& camera, double nominal_gain, std::uint64_t seed);

}  // namespace soffit::sim
