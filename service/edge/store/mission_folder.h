#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "service/edge/dds/messages.h"
#include "service/edge/files/survey.h"
#include "service/pipeline/pipeline.h"

namespace soffit {

/// When a picture arrived, and when what it allowed was known; seconds since the mission's start, negative:
/// not yet.
struct PictureTimes {
  std::uint32_t capture_id = 0;
  std::string file;
  Purpose purpose = Purpose::kUnknown;
  double arrived_s = -1.0;
  double observed_s = -1.0;
  double decided_s = -1.0;
  std::string problem;
};

struct StepTime {
  MissionStep step = MissionStep::kNone;
  double began_s = 0.0;
};

struct TrackPoint {
  double time_s = 0.0;
  Eigen::Vector3d position_in_map_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
};

/// What `mission.json` tells of a mission besides its results.
struct MissionLog {
  MissionReport report;
  std::vector<StepTime> steps;
  std::vector<PictureTimes> pictures;
  std::vector<TrackPoint> track;
};

/// `pictures/0007_wall.jpg`; the ending by the first bytes. Nothing of it comes from the wire as text.
std::string NamePicture(const Capture& capture);

/// Outcome, problems, steps and pictures with their times.
nlohmann::json DescribeMission(const MissionLog& log);

/// Writes `mission.json` and `track.csv`, each as a whole.
Status WriteMissionLog(const std::filesystem::path& folder, const MissionLog& log);

}  // namespace soffit
