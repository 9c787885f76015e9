#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "service/facade/facade.h"
#include "service/scene/prediction.h"

namespace soffit {

/// Compares what the pictures show of the ground by laying each over every other along the ground plane (the
/// plane sweep of R. Collins, 1996, for one plane). What lies on the ground looks alike in all of them,
/// shadows and marks included; what stands on it or hangs above it does not. Exposures are matched by the
/// median over all that two pictures share.
///
/// A pixel that is coloured like ground becomes kUnexplained when more pictures show something else at its
/// place of the ground than agree with it from another direction. An unexplained pixel becomes kGround when
/// at least two pictures from other directions agree with it and none shows something else. What no other
/// picture shows stays as it is.
///
/// @param predictions  Of the same sights, in the same order.
/// @return For each sight, 1 where a picture from another direction agrees with it.
std::vector<cv::Mat1b> CheckGround(const std::vector<Prediction>& predictions, std::vector<Sight>& sights);

}  // namespace soffit
