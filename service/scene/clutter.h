#pragma once

#include <vector>

#include "service/facade/facade.h"
#include "service/scene/prediction.h"
#include "service/scene/scene.h"

namespace soffit {

/// What stands, or may stand, where a picture from above shows neither ground nor a part of the model: a
/// vehicle that goes down there may hit it. Its height is not known (0). Thinner things than `kThinnest_m`
/// (more where the pose is uncertain) are not told from marks, joints and edges of shadows, nor is what
/// touches a building told from it. None in pictures that do not look down.
///
/// @param sight  With ground as GroundCheck leaves it.
std::vector<Obstacle> FindClutter(const Sight& sight, const Prediction& prediction);

constexpr double kThinnest_m = 0.08;

}  // namespace soffit
