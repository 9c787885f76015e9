#pragma once

#include <opencv2/core.hpp>

#include "service/facade/facade.h"

namespace soffit {

/// Sets of pixels, as masks of 0 and 255. Reaches are in pixels, 0 or more, and square.

/// Where the labels, `Seen` values, are the wanted one.
cv::Mat1b Only(const cv::Mat1b& labels, Seen wanted);

cv::Mat1b Both(const cv::Mat1b& a, const cv::Mat1b& b);
cv::Mat1b Either(const cv::Mat1b& a, const cv::Mat1b& b);

/// All that is no farther than `reach` from the mask.
cv::Mat1b Grow(const cv::Mat1b& mask, int reach);
cv::Mat1b Shrink(const cv::Mat1b& mask, int reach);

/// What lies no farther than `reach` from the mask's boundary, on either side.
cv::Mat1b Border(const cv::Mat1b& mask, int reach);

}  // namespace soffit
