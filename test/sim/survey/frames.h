#pragma once

#include <string>
#include <vector>

#include "shared/capture/capture.h"
#include "test/sim/draw/dice.h"
#include "test/sim/truth/truth.h"

namespace soffit::sim {

struct SurveyFrame {
  std::string file;
  Purpose purpose = Purpose::kUnknown;
  std::string object;                 ///< "" for the overview.
  double wall_yaw_rad = 0.0;          ///< kWall: outward direction of the wall.
  Pose<Map, Camera> map_from_camera;  ///< True.
  Pose<Map, Camera> reported;         ///< With the pose noise.
};

/// From where a careful operator would take the pictures: see WriteSurvey.
std::vector<SurveyFrame> PlanFrames(const World& world, const Truth& truth, Dice& dice);

}  // namespace soffit::sim
