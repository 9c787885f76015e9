#include "service/edge/store/mission_folder.h"

#include <iomanip>
#include <sstream>

#include "service/edge/files/file.h"

namespace soffit {

nlohmann::json DescribeMission(const MissionLog& log) {
  const MissionReport& report = log.report;
  nlohmann::json json = {{"mission_id", report.mission_id},
                         {"vehicle_id", report.vehicle_id},
                         {"started_utc_ns", report.started_utc_ns},
                         {"state", ToString(report.status.state)},
                         {"step", ToString(report.status.step)},
                         {"outcome", ToString(report.status.outcome)},
                         {"message", report.status.message},
                         {"problems", report.status.problems},
                         {"object_id", report.status.object_id},
                         {"picture_to_decision_s", report.picture_to_decision_s},
                         {"picture_to_decision_max_s", report.picture_to_decision_max_s},
                         {"steps", nlohmann::json::array()},
                         {"pictures", nlohmann::json::array()}};
  for (const StepTime& step : log.steps)
    json["steps"].push_back({{"step", ToString(step.step)}, {"began_s", step.began_s}});
  for (const PictureTimes& picture : log.pictures) {
    nlohmann::json entry = {{"capture_id", picture.capture_id},
                            {"file", picture.file},
                            {"purpose", ToString(picture.purpose)},
                            {"arrived_s", picture.arrived_s}};
    if (picture.observed_s >= 0.0) entry["observed_s"] = picture.observed_s;
    if (picture.decided_s >= 0.0) entry["decided_s"] = picture.decided_s;
    if (picture.decided_s >= 0.0) entry["to_decision_s"] = picture.decided_s - picture.arrived_s;
    if (!picture.problem.empty()) entry["problem"] = picture.problem;
    json["pictures"].push_back(std::move(entry));
  }
  return json;
}

namespace {

std::string TrackCsv(const std::vector<TrackPoint>& track) {
  std::ostringstream csv;
  csv << "time_s,x_m,y_m,z_m,yaw_rad\n" << std::fixed << std::setprecision(3);
  for (const TrackPoint& point : track) {
    const Eigen::Vector3d& p = point.position_in_map_m;
    csv << point.time_s << ',' << p.x() << ',' << p.y() << ',' << p.z() << ',' << point.yaw_rad << '\n';
  }
  return csv.str();
}

}  // namespace

std::string NamePicture(const Capture& capture) {
  const bool is_png = capture.bytes.size() > 1 && capture.bytes[0] == 0x89 && capture.bytes[1] == 'P';
  std::ostringstream name;
  name << "pictures/" << std::setw(4) << std::setfill('0') << capture.capture_id << '_'
       << ToString(capture.purpose) << (is_png ? ".png" : ".jpg");
  return name.str();
}

Status WriteMissionLog(const std::filesystem::path& folder, const MissionLog& log) {
  Status status = WriteFile(folder / "mission.json", DescribeMission(log).dump(1) + "\n");
  if (!status.ok()) return status;
  return WriteFile(folder / "track.csv", TrackCsv(log.track));
}

}  // namespace soffit
