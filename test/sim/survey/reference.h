#pragma once

#include <opencv2/core.hpp>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// The wanted buildings from above, black on white, turned and scaled as the mission says, with a white
/// border. A pixel is black when its centre lies inside a building.
cv::Mat1b DrawReference(const World& world);

}  // namespace soffit::sim
