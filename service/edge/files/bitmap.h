#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "shared/result/result.h"

namespace soffit {

/// Reads a PNG, a JPEG or the first picture of a GIF as greyscale. Errors name the file. Size and
/// completeness are checked before it is decoded.
Result<cv::Mat1b> ReadBitmapFile(const std::filesystem::path& file);

}  // namespace soffit
