#pragma once

#include <opencv2/core.hpp>

#include "service/image/image.h"

namespace soffit {

/// How to take the light out of a picture's pixels that haze, or light scattered in the lens, adds to all of
/// them, so that colours are about as saturated as they would be without: the level, from 0 to 255, that each
/// level becomes. The veil is the light of the darkest pixels, in the channel where each is darkest, as next
/// to nothing sends no light in any channel (dark-object subtraction, P. Chavez, 1988; the dark channel of
/// K. He, 2009), but no more than a third of the usual light. All levels stay as they are when there is no
/// noticeable veil, and in pictures that look down or whose pose is not trusted: ground may have no dark
/// pixel, and little haze lies between. Pure; O(pixels).
cv::Mat1b UnveilTable(const Image& image);

}  // namespace soffit
