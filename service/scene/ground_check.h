#pragma once

#include <vector>

#include "service/facade/facade.h"
#include "service/scene/prediction.h"

namespace soffit {

/// Where two pictures show one place of the ground in different brightness, at least one of them shows something else
/// that is coloured like ground: such pixels become kUnexplained in both. Shadows lie on the ground and agree. The
/// exposures of two pictures are matched by the median over all places that both show.
///
/// @param predictions  Of the same sights, in the same order.
/// @param low_m, high_m  The rectangle of ground that is looked at; `cell_m` > 0 is the distance of places.
void RejectDisputedGround(const std::vector<Prediction>& predictions, const Eigen::Vector2d& low_m,
                          const Eigen::Vector2d& high_m, double cell_m, std::vector<Sight>& sights);

}  // namespace soffit
