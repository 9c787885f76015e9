#include "service/edge/ros/path_message.h"

namespace soffit::ros {

Path_ MakePath(std::int64_t stamp_utc_ns, const std::vector<Eigen::Vector3d>& points_in_map_m) {
  Path_ path;
  path.header_(MakeHeader(stamp_utc_ns, kMapFrame));
  Eigen::Quaterniond heading = Eigen::Quaterniond::Identity();
  for (std::size_t i = 0; i < points_in_map_m.size(); ++i) {
    if (i + 1 < points_in_map_m.size()) {
      const Eigen::Vector3d way_m = points_in_map_m[i + 1] - points_in_map_m[i];
      heading = Heading(std::atan2(way_m.y(), way_m.x()));
    }
    PoseStamped_ pose;
    pose.header_(path.header_());
    pose.pose_(MakePose(points_in_map_m[i], heading));
    path.poses_().push_back(pose);
  }
  return path;
}

Path_ MakeCorridorPath(std::int64_t stamp_utc_ns, const std::vector<ClearanceDecision>& decisions) {
  for (const ClearanceDecision& decision : decisions) {
    if (decision.verdict != Verdict::kClear || !decision.corridor) continue;
    return MakePath(stamp_utc_ns, decision.corridor->Path());
  }
  return MakePath(stamp_utc_ns, {});
}

}  // namespace soffit::ros
