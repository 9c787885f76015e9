#include "vehicle_agent/agent/plan.h"

#include <algorithm>

namespace soffit {
namespace {

Stage Like(Stage stage, Stage::Kind kind) {
  stage.kind = kind;
  return stage;
}

}  // namespace

Eigen::Vector3d CorridorLine::Nearest(const Eigen::Vector3d& position_m) const {
  const Eigen::Vector3d way = exit_m - entry_m;
  return entry_m + way * std::clamp((position_m - entry_m).dot(way) / way.squaredNorm(), 0.0, 1.0);
}

CorridorLine MakeCorridorLine(const FlightCommand& command, const VehicleEnvelope& envelope,
                              double margin_ratio) {
  const double kept_m = (1.0 - margin_ratio) * envelope.safety_margin_m;
  CorridorLine line;
  line.entry_m = command.path_in_map_m.front();
  line.exit_m = command.path_in_map_m.back();
  line.yaw_rad = command.yaw_rad;
  line.speed_mps = command.speed_mps;
  line.lateral_limit_m = 0.5 * command.permit->free_width_m - envelope.radius_m - kept_m;
  line.vertical_limit_m = 0.5 * (command.permit->free_height_m - envelope.height_m) - kept_m;
  return line;
}

bool IsPathStage(Stage::Kind kind) {
  return kind == Stage::Kind::kFly || kind == Stage::Kind::kAlign || kind == Stage::Kind::kPass ||
         kind == Stage::Kind::kBackOut;
}

Plan MakePlan(const FlightCommand& command, const Eigen::Vector3d& position_m,
              const std::optional<CorridorLine>& corridor) {
  Stage fly{Stage::Kind::kFly, command.path_in_map_m};
  fly.speed_mps = command.speed_mps;
  fly.yaw_rad = command.yaw_rad;
  switch (command.kind) {
    case CommandKind::kTakeOff: {
      Stage climb{Stage::Kind::kClimb};
      climb.height_m = command.path_in_map_m.front().z();
      return {climb};
    }
    case CommandKind::kGoTo:
      return {fly};
    case CommandKind::kLook:
      fly.camera_pitch_rad = command.camera_pitch_rad;
      return {fly, Like(fly, Stage::Kind::kSettle), Like(fly, Stage::Kind::kExpose)};
    case CommandKind::kFlyCorridor: {
      const CorridorLine line{command.path_in_map_m.front(), command.path_in_map_m.back()};
      Stage align = Like(fly, Stage::Kind::kAlign);
      align.path = {line.Nearest(position_m)};
      Stage pass = Like(fly, Stage::Kind::kPass);
      pass.path = {line.exit_m};
      return {align, pass};
    }
    case CommandKind::kLand:
      if (command.path_in_map_m.empty()) return {Stage{Stage::Kind::kDescend}};
      return {fly, Stage{Stage::Kind::kDescend}};
    case CommandKind::kAbort:
      return MakeBackOutPlan(corridor);
    case CommandKind::kHold:
      break;
  }
  return {Stage{Stage::Kind::kStop}};
}

Plan MakeBackOutPlan(const std::optional<CorridorLine>& corridor) {
  Plan plan{Stage{Stage::Kind::kStop}};
  if (!corridor) return plan;
  Stage back{Stage::Kind::kBackOut, {corridor->entry_m}};
  back.speed_mps = corridor->speed_mps;
  back.yaw_rad = corridor->yaw_rad;
  plan.push_back(back);
  return plan;
}

Plan MakeReturnPlan(const Eigen::Vector3d& position_m, const std::optional<CorridorLine>& corridor,
                    double height_m, double speed_mps) {
  Plan plan = MakeBackOutPlan(corridor);
  Eigen::Vector3d above = corridor ? corridor->entry_m : position_m;
  above.z() = height_m;
  Stage fly{Stage::Kind::kFly, {above, Eigen::Vector3d(0.0, 0.0, height_m)}};
  fly.speed_mps = speed_mps;
  plan.push_back(fly);
  plan.push_back(Stage{Stage::Kind::kDescend});
  return plan;
}

}  // namespace soffit
