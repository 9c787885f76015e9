#include "vehicle_agent/agent/stage_run.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr double kStopDeceleration_mps2 = 2.0;
constexpr double kStopTimeout_s = 15.0;
constexpr double kPatience = 3.0;      // A path may take so many times as long as planned, and
constexpr double kPathGrace_s = 30.0;  // this much more.
constexpr double kCornerGrace_s = 5.0;
constexpr double kClimbTolerance_m = 0.4;
constexpr double kClimbEndSpeed_mps = 0.4;
constexpr double kSlowDescent_mps = 0.25;  // Landing is given up when it takes longer than so.
constexpr double kDescentGrace_s = 60.0;
constexpr double kCrossTrackFilter_s = 0.4;
constexpr double kGimbalTolerance_rad = 0.05;
constexpr double kNearIntent_m = 1.0;
constexpr double kShortestLead_m = 0.5;

double AngleBetween(double a_rad, double b_rad) {
  return std::abs(std::remainder(a_rad - b_rad, 2.0 * std::numbers::pi));
}

/// Where a path begins: where the vehicle is already led to, if that is near it.
Eigen::Vector3d FindPathStart(const Telemetry& telemetry, const Intent& intent) {
  const bool is_led = intent.kind == Intent::Kind::kFlyTo &&
                      (intent.position_in_map_m - telemetry.position_in_map_m).norm() < kNearIntent_m;
  return is_led ? intent.position_in_map_m : telemetry.position_in_map_m;
}

}  // namespace

void HoldAt(const Eigen::Vector3d& position_in_map_m, double present_yaw_rad, Intent& intent) {
  if (intent.kind != Intent::Kind::kFlyTo) intent.yaw_rad = present_yaw_rad;
  intent.kind = Intent::Kind::kFlyTo;
  intent.position_in_map_m = position_in_map_m;
}

Eigen::Vector3d FindStoppingPoint(const Telemetry& telemetry, const std::optional<CorridorLine>& corridor) {
  const Eigen::Vector3d& velocity = telemetry.velocity_in_map_mps;
  const Eigen::Vector3d stop =
      telemetry.position_in_map_m + velocity * (0.5 * velocity.norm() / kStopDeceleration_mps2);
  return corridor ? corridor->Nearest(stop) : stop;
}

StageRun::StageRun(const Stage& stage, const std::optional<CorridorLine>& corridor,
                   const VehicleEnvelope& envelope, const AgentOptions& options, const Telemetry& telemetry,
                   Intent& intent)
    : stage_(stage), corridor_(corridor), envelope_(envelope), options_(options) {
  if (stage_.kind == Stage::Kind::kBackOut) {
    path_ = PathRun(corridor_->Nearest(telemetry.position_in_map_m), stage_.path);
  } else if (IsPathStage(stage_.kind)) {
    path_ = PathRun(FindPathStart(telemetry, intent), stage_.path);
  } else if (stage_.kind == Stage::Kind::kStop) {
    HoldAt(FindStoppingPoint(telemetry, corridor_), telemetry.yaw_rad, intent);
  }
  allowed_s_ = AllowedTime_s(telemetry);
}

double StageRun::AllowedTime_s(const Telemetry& telemetry) const {
  switch (stage_.kind) {
    case Stage::Kind::kFly:
    case Stage::Kind::kAlign:
    case Stage::Kind::kBackOut:
    case Stage::Kind::kPass: {
      const double corners_s = kCornerGrace_s * static_cast<double>(stage_.path.size());
      return kPatience * (path_.RemainingLength_m() / stage_.speed_mps + corners_s) + kPathGrace_s;
    }
    case Stage::Kind::kClimb:
      return options_.takeoff_timeout_s;
    case Stage::Kind::kSettle:
      return options_.settle_timeout_s;
    case Stage::Kind::kExpose:
      return options_.picture_timeout_s * static_cast<double>(options_.picture_tries);
    case Stage::Kind::kDescend:
      return std::max(telemetry.position_in_map_m.z(), 0.0) / kSlowDescent_mps + kDescentGrace_s;
    case Stage::Kind::kStop:
      return kStopTimeout_s;
  }
  return 0.0;
}

std::optional<StageEnd> StageRun::Go(const Telemetry& telemetry, double dt_s, Intent& intent) {
  active_s_ += dt_s;
  if (auto end = GoOn(telemetry, dt_s, intent)) return end;
  if (active_s_ <= allowed_s_) return std::nullopt;
  if (!IsPathStage(stage_.kind)) return StageEnd{Say("gave up after ", active_s_, " s")};
  return StageEnd{Say("gave up after ", active_s_, " s: did not arrive, ",
                      (telemetry.position_in_map_m - path_.End()).norm(), " m missing")};
}

std::optional<StageEnd> StageRun::GoOn(const Telemetry& telemetry, double dt_s, Intent& intent) {
  switch (stage_.kind) {
    case Stage::Kind::kClimb:
      return Climb(telemetry, intent);
    case Stage::Kind::kFly:
    case Stage::Kind::kAlign:
    case Stage::Kind::kPass:
    case Stage::Kind::kBackOut:
      return FollowPath(telemetry, dt_s, intent);
    case Stage::Kind::kSettle:
      return Settle(telemetry, dt_s, intent);
    case Stage::Kind::kExpose:
      return std::nullopt;
    case Stage::Kind::kStop:
      if (telemetry.velocity_in_map_mps.norm() < options_.settle_speed_mps) return StageEnd{};
      return std::nullopt;
    case Stage::Kind::kDescend:
      intent.kind = Intent::Kind::kLand;
      if (!telemetry.is_armed) return StageEnd{};
      if (!telemetry.intent_problem.empty()) return StageEnd{telemetry.intent_problem};
      return std::nullopt;
  }
  return std::nullopt;
}

std::optional<StageEnd> StageRun::Climb(const Telemetry& telemetry, Intent& intent) const {
  if (intent.kind != Intent::Kind::kTakeOff) {
    intent.kind = Intent::Kind::kTakeOff;
    intent.position_in_map_m = telemetry.position_in_map_m;
    intent.position_in_map_m.z() = stage_.height_m;
    intent.yaw_rad = telemetry.yaw_rad;
  }
  if (!telemetry.intent_problem.empty()) return StageEnd{telemetry.intent_problem};
  const bool is_there = telemetry.is_armed && telemetry.is_in_air && telemetry.has_position &&
                        std::abs(telemetry.position_in_map_m.z() - stage_.height_m) < kClimbTolerance_m &&
                        std::abs(telemetry.velocity_in_map_mps.z()) < kClimbEndSpeed_mps;
  if (!is_there) return std::nullopt;
  HoldAt(intent.position_in_map_m, telemetry.yaw_rad, intent);
  return StageEnd{};
}

bool StageRun::IsCalm(const Telemetry& telemetry, const Intent& intent, double tolerance_m) const {
  return telemetry.velocity_in_map_mps.norm() < options_.settle_speed_mps &&
         AngleBetween(telemetry.yaw_rad, intent.yaw_rad) < options_.settle_yaw_rad &&
         (telemetry.position_in_map_m - intent.position_in_map_m).norm() < tolerance_m;
}

std::optional<StageEnd> StageRun::FollowPath(const Telemetry& telemetry, double dt_s, Intent& intent) {
  const bool is_inside = stage_.kind == Stage::Kind::kPass || stage_.kind == Stage::Kind::kBackOut;
  const std::string deviation = is_inside ? MeasureDeviation(telemetry, dt_s) : "";
  if (!deviation.empty() && stage_.kind == Stage::Kind::kPass) return StageEnd{deviation};
  if (deviation.empty()) {
    const PathPace pace{stage_.speed_mps, options_.acceleration_mps2,
                        options_.lead_s * stage_.speed_mps + kShortestLead_m, options_.corner_tolerance_m};
    path_.Advance(telemetry.position_in_map_m, dt_s, pace);
  } else {
    path_.Halt();  // On the way out, back to the line first.
  }
  HoldAt(path_.Carrot(), telemetry.yaw_rad, intent);
  if (stage_.yaw_rad) intent.yaw_rad = *stage_.yaw_rad;
  intent.camera_pitch_rad = stage_.camera_pitch_rad;
  if (!path_.IsAtEnd()) return std::nullopt;
  const bool is_aligning = stage_.kind == Stage::Kind::kAlign;
  const bool is_there =
      IsCalm(telemetry, intent, is_aligning ? options_.corridor_align_m : options_.arrival_tolerance_m);
  calm_s_ = is_there ? calm_s_ + dt_s : 0.0;
  if (is_aligning ? calm_s_ >= options_.settle_s : is_there) return StageEnd{};
  return std::nullopt;
}

std::string StageRun::MeasureDeviation(const Telemetry& telemetry, double dt_s) {
  const PathRun line(corridor_->entry_m, {corridor_->exit_m});
  const CrossTrack off = line.MeasureCrossTrack(telemetry.position_in_map_m);
  const double share = dt_s / (dt_s + kCrossTrackFilter_s);
  lateral_m_ += share * (off.lateral_m - lateral_m_);
  vertical_m_ += share * (off.vertical_m - vertical_m_);
  const double gross_m = 0.5 * options_.corridor_margin_ratio * envelope_.safety_margin_m;
  const auto is_beyond = [&](double smoothed_m, double now_m, double limit_m) {
    return std::abs(smoothed_m) > limit_m || std::abs(now_m) > limit_m + gross_m;
  };
  if (is_beyond(lateral_m_, off.lateral_m, corridor_->lateral_limit_m)) {
    return Say(std::abs(off.lateral_m), " m beside the corridor's line, allowed are ",
               corridor_->lateral_limit_m, " m");
  }
  if (is_beyond(vertical_m_, off.vertical_m, corridor_->vertical_limit_m)) {
    return Say(std::abs(off.vertical_m), " m above or below the corridor's line, allowed are ",
               corridor_->vertical_limit_m, " m");
  }
  return {};
}

std::optional<StageEnd> StageRun::Settle(const Telemetry& telemetry, double dt_s, const Intent& intent) {
  const bool is_aimed =
      !intent.camera_pitch_rad || !telemetry.gimbal_pitch_rad ||
      std::abs(*intent.camera_pitch_rad - *telemetry.gimbal_pitch_rad) < kGimbalTolerance_rad;
  const bool is_calm = is_aimed && telemetry.rotation_rate_radps < options_.settle_rate_radps &&
                       IsCalm(telemetry, intent, options_.arrival_tolerance_m);
  calm_s_ = is_calm ? calm_s_ + dt_s : 0.0;
  if (calm_s_ < options_.settle_s) return std::nullopt;
  return StageEnd{};
}

}  // namespace soffit
