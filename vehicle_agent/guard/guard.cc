#include "vehicle_agent/guard/guard.h"

#include <algorithm>
#include <cmath>

#include "shared/geometry/polygon.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr double kSameDimension_m = 1e-3;
constexpr double kFenceStep_m = 0.25;
constexpr double kMinTakeoff_m = 0.5;
constexpr double kMaxCorridorBend_m = 0.02;

bool IsKnown(CommandKind kind) {
  switch (kind) {
    case CommandKind::kHold:
    case CommandKind::kTakeOff:
    case CommandKind::kLook:
    case CommandKind::kFlyCorridor:
    case CommandKind::kGoTo:
    case CommandKind::kLand:
    case CommandKind::kAbort:
      return true;
  }
  return false;
}

bool IsMoving(CommandKind kind) {
  return kind == CommandKind::kLook || kind == CommandKind::kGoTo || kind == CommandKind::kFlyCorridor;
}

std::string FindNumberProblem(const FlightCommand& command) {
  bool is_finite = std::isfinite(command.yaw_rad) && std::isfinite(command.speed_mps) &&
                   std::isfinite(command.camera_pitch_rad);
  for (const Eigen::Vector3d& point : command.path_in_map_m) is_finite = is_finite && point.allFinite();
  if (!is_finite) return "the command holds a number that is not finite";
  return {};
}

/// How a point is outside the geofence by more than `slack_m`, over whatever floor.
std::string FindFenceProblem(const Eigen::Vector3d& point, const GuardOptions& options, double slack_m) {
  if (!(point.z() <= options.ceiling_m + slack_m)) {
    return Say("height ", point.z(), " m is above the geofence's ceiling of ", options.ceiling_m, " m");
  }
  const double distance_m = point.head<2>().norm();
  if (!(distance_m <= options.max_distance_m + slack_m)) {
    return Say("too far: ", distance_m, " m from home, allowed are ", options.max_distance_m, " m");
  }
  if (!options.fence.empty()) {
    Ring ring;
    for (const FenceCorner& corner : options.fence) ring.emplace_back(corner.east_m, corner.north_m);
    if (!Contains(ring, point.head<2>()) && !(DistanceToRing(point.head<2>(), ring) < slack_m)) {
      return Say("(", point.x(), ", ", point.y(), ") is outside the geofence");
    }
  }
  return {};
}

std::string FindPlaceProblem(const Eigen::Vector3d& point, const GuardOptions& options) {
  if (!(point.z() >= options.floor_m)) {
    return Say("height ", point.z(), " m is below the geofence's floor of ", options.floor_m, " m");
  }
  return FindFenceProblem(point, options, 0.0);
}

/// A path as it will be flown: from where the vehicle is. The way from outside the fence back into it is
/// allowed.
std::string FindPathProblem(const FlightCommand& command, const GuardContext& context,
                            const GuardOptions& options) {
  double length_m = 0.0;
  Eigen::Vector3d from = context.position_in_map_m;
  bool was_inside = FindPlaceProblem(from, options).empty();
  for (const Eigen::Vector3d& to : command.path_in_map_m) {
    const double leg_m = (to - from).norm();
    length_m += leg_m;
    if (!(length_m <= options.max_path_m)) {
      return Say("too far: the path is longer than ", options.max_path_m, " m");
    }
    const int steps = 1 + static_cast<int>(leg_m / kFenceStep_m);
    for (int i = 1; i <= steps; ++i) {
      std::string problem = FindPlaceProblem(from + (to - from) * i / steps, options);
      if (!problem.empty() && (was_inside || i == steps)) return problem;
      was_inside = problem.empty();
    }
    from = to;
  }
  return {};
}

std::string FindSpeedProblem(const FlightCommand& command, const GuardOptions& options) {
  const double limit_mps =
      command.kind == CommandKind::kFlyCorridor ? options.max_corridor_speed_mps : options.max_speed_mps;
  if (!(command.speed_mps > 0.0)) return Say("speed ", command.speed_mps, " m/s must be positive");
  if (!(command.speed_mps <= limit_mps)) {
    return Say("too fast: ", command.speed_mps, " m/s, allowed are ", limit_mps, " m/s");
  }
  return {};
}

double DistanceToLine(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d side = b - a;
  const double t = std::clamp((point - a).dot(side) / side.squaredNorm(), 0.0, 1.0);
  return (point - a - t * side).norm();
}

std::string FindCorridorPathProblem(const FlightCommand& command, const GuardContext& context,
                                    const GuardOptions& options) {
  const std::vector<Eigen::Vector3d>& path = command.path_in_map_m;
  if (path.size() < 2) return "the corridor's path has no entry and exit";
  const Eigen::Vector3d& entry = path.front();
  const Eigen::Vector3d& exit = path.back();
  if (!((exit - entry).head<2>().norm() > 2.0 * context.envelope.radius_m)) {
    return "the corridor's entry and exit are closer together than the vehicle is wide";
  }
  double along_m = 0.0;
  for (const Eigen::Vector3d& point : path) {
    if (!(DistanceToLine(point, entry, exit) <= kMaxCorridorBend_m))
      return "the corridor's path is not straight";
    const double next_m = (point - entry).dot((exit - entry).normalized());
    if (next_m < along_m) return "the corridor's path turns back";
    along_m = next_m;
    if (!(point.z() <= entry.z() + options.corridor_climb_m)) {
      return Say("the corridor climbs by ", point.z() - entry.z(), " m; allowed under a soffit are ",
                 options.corridor_climb_m, " m");
    }
  }
  const double distance_m = context.is_in_corridor ? DistanceToLine(context.position_in_map_m, entry, exit)
                                                   : (context.position_in_map_m - entry).norm();
  if (!(distance_m <= options.corridor_join_m)) {
    return Say("the vehicle is ", distance_m, " m away from the corridor's ",
               context.is_in_corridor ? "path" : "entry", ", allowed are ", options.corridor_join_m, " m");
  }
  return {};
}

std::string FindReadinessProblem(const FlightCommand& command, const GuardContext& context,
                                 const GuardOptions& options) {
  if (context.phase == VehiclePhase::kPilotInControl) return "the pilot is in control";
  if (!context.not_ready.empty()) return context.not_ready;
  if (context.battery_ratio < options.min_battery_ratio && context.battery_ratio >= 0.0 &&
      command.kind != CommandKind::kLand) {
    return Say("battery is at ", 100.0 * context.battery_ratio, " %, needed are ",
               100.0 * options.min_battery_ratio, " %");
  }
  if (command.kind == CommandKind::kTakeOff && context.is_in_air) return "the vehicle is in the air already";
  if (command.kind != CommandKind::kTakeOff && !context.is_in_air) return "the vehicle is on the ground";
  if (context.phase == VehiclePhase::kLanding) return "the vehicle is landing";
  if (context.is_busy && command.kind != CommandKind::kLand) return "another command is being carried out";
  if (context.is_in_corridor && command.kind != CommandKind::kFlyCorridor) {
    return "the vehicle is inside a corridor: abort, to back out, or fly it to its end";
  }
  return {};
}

std::string FindKindProblem(const FlightCommand& command, const GuardContext& context,
                            const GuardOptions& options, std::int64_t now_utc_ns) {
  if (command.kind == CommandKind::kTakeOff) {
    if (command.path_in_map_m.size() != 1) return "a takeoff needs one point, with the height";
    const double height_m = command.path_in_map_m.front().z();
    if (!(height_m >= kMinTakeoff_m))
      return Say("takeoff height ", height_m, " m is less than ", kMinTakeoff_m, " m");
    return FindPlaceProblem({context.position_in_map_m.x(), context.position_in_map_m.y(), height_m},
                            options);
  }
  if (IsMoving(command.kind) && command.path_in_map_m.empty()) return "the path is empty";
  if (!command.path_in_map_m.empty()) {
    std::string problem = FindSpeedProblem(command, options);
    if (problem.empty()) problem = FindPathProblem(command, context, options);
    if (!problem.empty()) return problem;
  }
  if (command.kind == CommandKind::kLook) {
    if (command.capture_id == 0) return "the picture has no id";
    if (command.purpose == Purpose::kUnknown ||
        PurposeFromString(ToString(command.purpose)) != command.purpose) {
      return "the picture has no purpose";
    }
    if (!(std::abs(command.camera_pitch_rad) <= 1.6)) {
      return Say("camera pitch ", command.camera_pitch_rad, " rad is out of range");
    }
    if (!context.has_camera) {
      std::string text = "no camera for this look";
      for (const std::string& problem : context.missing_cameras) text += "; " + problem;
      return text;
    }
  }
  if (command.kind == CommandKind::kFlyCorridor) {
    if (!command.permit) return "no permit to enter a corridor";
    const std::string problem =
        FindPermitProblem(*command.permit, context.envelope, context.newest_scene_revision, now_utc_ns);
    return problem.empty() ? FindCorridorPathProblem(command, context, options) : problem;
  }
  return {};
}

}  // namespace

bool IsStopping(CommandKind kind) { return kind == CommandKind::kHold || kind == CommandKind::kAbort; }

std::string FindAddressProblem(const FlightCommand& command, const GuardContext& context) {
  if (command.vehicle_id != context.vehicle_id) {
    return Say("is for vehicle ", command.vehicle_id, ", this is ", context.vehicle_id);
  }
  if (command.mission_id == 0 || command.sequence == 0) return "has no mission or no number";
  const auto& old = context.old_missions;
  if (std::find(old.begin(), old.end(), command.mission_id) != old.end()) {
    return Say("mission ", command.mission_id, " is over; this is mission ", context.mission_id);
  }
  if (command.mission_id != context.mission_id) {
    if (context.is_busy && !IsStopping(command.kind)) return Say("busy with mission ", context.mission_id);
    return {};
  }
  if (context.last_sequence == 0 || command.sequence == context.last_sequence + 1) return {};
  if (command.sequence > context.last_sequence && IsStopping(command.kind)) return {};
  return Say("out of order: number ", command.sequence, ", expected ", context.last_sequence + 1);
}

std::string FindReasonToRefuse(const FlightCommand& command, const GuardContext& context,
                               const GuardOptions& options, std::int64_t now_utc_ns) {
  if (!IsKnown(command.kind)) return Say("unknown kind of command: ", static_cast<int>(command.kind));
  if (IsStopping(command.kind)) {
    if (context.phase == VehiclePhase::kPilotInControl) return "the pilot is in control";
    return context.phase == VehiclePhase::kLanding ? "the vehicle is landing" : "";
  }
  if (!(command.valid_until_utc_ns >= now_utc_ns)) {
    return Say("stale: it was valid until ",
               1e-9 * static_cast<double>(now_utc_ns - command.valid_until_utc_ns), " s ago");
  }
  std::string problem = FindNumberProblem(command);
  if (problem.empty()) problem = FindReadinessProblem(command, context, options);
  if (problem.empty()) problem = FindKindProblem(command, context, options, now_utc_ns);
  return problem;
}

std::string FindPermitProblem(const CorridorPermit& permit, const VehicleEnvelope& own,
                              std::uint64_t newest_scene_revision, std::int64_t now_utc_ns) {
  const VehicleEnvelope& its = permit.envelope;
  if (permit.decision_id == 0 || permit.object_id == 0) return "the corridor's permit names no decision";
  if (!(permit.valid_until_utc_ns >= now_utc_ns)) {
    return Say("the corridor's permit expired ",
               1e-9 * static_cast<double>(now_utc_ns - permit.valid_until_utc_ns), " s ago");
  }
  const bool is_ours = std::abs(its.radius_m - own.radius_m) <= kSameDimension_m &&
                       std::abs(its.height_m - own.height_m) <= kSameDimension_m &&
                       std::abs(its.safety_margin_m - own.safety_margin_m) <= kSameDimension_m;
  if (!is_ours) {
    return Say("the corridor's permit is for another vehicle: radius ", its.radius_m, " m, height ",
               its.height_m, " m, margin ", its.safety_margin_m, " m; this one: ", own.radius_m, " m, ",
               own.height_m, " m, ", own.safety_margin_m, " m");
  }
  if (!(permit.free_width_m >= own.NeededWidth_m())) {
    return Say("the corridor is ", permit.free_width_m, " m wide, needed are ", own.NeededWidth_m(), " m");
  }
  if (!(permit.free_height_m >= own.NeededHeight_m())) {
    return Say("the corridor is ", permit.free_height_m, " m high, needed are ", own.NeededHeight_m(), " m");
  }
  if (permit.scene_revision < newest_scene_revision) {
    return Say("the corridor's permit is for scene revision ", permit.scene_revision, ", the newest is ",
               newest_scene_revision);
  }
  return {};
}

std::string FindBoundsProblem(const Telemetry& telemetry, bool is_in_corridor, const GuardOptions& options) {
  if (!telemetry.has_position) return {};
  const double speed_mps = telemetry.velocity_in_map_mps.norm();
  const double limit_mps = is_in_corridor ? options.max_corridor_speed_mps : options.max_speed_mps;
  if (!(speed_mps <= options.overspeed_ratio * limit_mps)) {
    return Say("too fast: ", speed_mps, " m/s, allowed are ", limit_mps, " m/s");
  }
  return FindFenceProblem(telemetry.position_in_map_m, options, options.bounds_slack_m);
}

}  // namespace soffit
