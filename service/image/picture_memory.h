#pragma once

#include <opencv2/core.hpp>

namespace soffit {

/// A picture whose pixels are not set yet, in large pages where the system has them: to enter the small ones
/// of 12 megapixels takes half as long as decoding them.
cv::Mat NewPicture(cv::Size size, int type);

}  // namespace soffit
