#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "shared/result/result.h"

namespace soffit {

/// Decodes a whole JPEG to BGR; `size` is that of its header. CMYK is taken for inverted, as all programs
/// write it. Damage is an error that says what is wrong: pixels are never made up for what is missing. Pure;
/// O(pixels).
Result<cv::Mat3b> DecodeJpeg(const std::vector<std::uint8_t>& bytes, const cv::Size& size);

}  // namespace soffit
