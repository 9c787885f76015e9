#include "service/mission/progress.h"

#include <algorithm>

namespace soffit {
namespace {

/// Begin of each step within the mission; the end is the begin of the next one.
double BeginOf(MissionStep step) {
  switch (step) {
    case MissionStep::kNone:
    case MissionStep::kWaitForVehicle:
      return 0.0;
    case MissionStep::kTakeOff:
      return 0.02;
    case MissionStep::kOverview:
      return 0.08;
    case MissionStep::kRecognize:
      return 0.18;
    case MissionStep::kTop:
      return 0.20;
    case MissionStep::kWalls:
      return 0.30;
    case MissionStep::kDecide:
      return 0.62;
    case MissionStep::kLookAgain:
      return 0.65;
    case MissionStep::kEnter:
      return 0.75;
    case MissionStep::kReturn:
      return 0.86;
    case MissionStep::kLand:
      return 0.95;
    case MissionStep::kDone:
      break;
  }
  return 1.0;
}

MissionStep Next(MissionStep step) { return static_cast<MissionStep>(static_cast<int>(step) + 1); }

}  // namespace

void TellProgress(Mission& mission) {
  MissionStatus& status = mission.status;
  double ratio = 0.0;
  if (mission.errand && mission.vehicle && !mission.errand->command.path_in_map_m.empty() &&
      mission.errand->start_distance_m > 0.1) {
    const double left_m =
        (mission.errand->command.path_in_map_m.back() - mission.vehicle->position_in_map_m).norm();
    ratio = std::clamp(1.0 - left_m / mission.errand->start_distance_m, 0.0, 1.0);
  }
  if (mission.views_planned > 0) {
    const auto done = static_cast<double>(mission.views_planned - mission.views.size());
    ratio = std::min(1.0, (done + ratio) / static_cast<double>(mission.views_planned));
  }
  status.step_progress_ratio = std::max(status.step_progress_ratio, ratio);
  if (status.step == MissionStep::kDone) status.step_progress_ratio = 1.0;
  const double begin = BeginOf(status.step);
  const double end = status.step == MissionStep::kDone ? 1.0 : BeginOf(Next(status.step));
  status.progress_ratio = std::max(status.progress_ratio, begin + (end - begin) * status.step_progress_ratio);
}

}  // namespace soffit
