#include "shared/wire/topics.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "shared/wire/basic.h"

namespace soffit {
namespace {

constexpr std::size_t kMaxPictureBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxPathPoints = 256;
constexpr int kPoseSize = 6;

template <class To, class From>
To EnumAs(From value) {
  return static_cast<To>(static_cast<int>(value));
}

wire::Intrinsics IntrinsicsToWire(const Intrinsics& k) {
  wire::Intrinsics out;
  out.width_px(static_cast<std::uint32_t>(std::max(k.width_px, 0)));
  out.height_px(static_cast<std::uint32_t>(std::max(k.height_px, 0)));
  out.fx_px(k.fx_px);
  out.fy_px(k.fy_px);
  out.cx_px(k.cx_px);
  out.cy_px(k.cy_px);
  out.plumb_bob(k.distortion);
  return out;
}

Intrinsics IntrinsicsFromWire(const wire::Intrinsics& k) {
  return {static_cast<int>(k.width_px()),
          static_cast<int>(k.height_px()),
          k.fx_px(),
          k.fy_px(),
          k.cx_px(),
          k.cy_px(),
          k.plumb_bob()};
}

void CheckIntrinsics(const wire::Intrinsics& k, Check& check) {
  constexpr std::uint32_t kMaxSide_px = 1 << 16;
  check.Require(k.width_px() <= kMaxSide_px && k.height_px() <= kMaxSide_px,
                "the picture's size is out of range");
}

/// Row-major 6 x 6, the same standard deviation on every axis.
std::array<double, 36> SpreadToCovariance(double position_std_m, double orientation_std_rad) {
  std::array<double, 36> covariance{};
  for (int i = 0; i < kPoseSize; ++i) {
    const double std = i < 3 ? position_std_m : orientation_std_rad;
    covariance[static_cast<std::size_t>(i * kPoseSize + i)] = std * std;
  }
  return covariance;
}

/// Standard deviation along the worst direction of one 3 x 3 block; NaN when the block is no covariance.
double GreatestStd(const std::array<double, 36>& covariance, int first) {
  using Matrix6 = Eigen::Matrix<double, kPoseSize, kPoseSize, Eigen::RowMajor>;
  const Eigen::Matrix3d block = Eigen::Map<const Matrix6>(covariance.data()).block<3, 3>(first, first);
  if (!block.allFinite()) return std::numeric_limits<double>::quiet_NaN();
  const auto variances =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(block, Eigen::EigenvaluesOnly).eigenvalues();
  const double tolerance = 1e-9 * std::max(1.0, block.norm());
  if (!block.isApprox(block.transpose(), 1e-6) || !(variances.minCoeff() >= -tolerance)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return std::sqrt(std::max(variances.maxCoeff(), 0.0));
}

wire::CorridorPermit PermitToWire(const CorridorPermit& permit) {
  wire::CorridorPermit out;
  out.decision_id(permit.decision_id);
  out.object_id(permit.object_id);
  out.scene_revision(permit.scene_revision);
  out.valid_until_utc_ns(permit.valid_until_utc_ns);
  out.envelope(ToWire(permit.envelope));
  out.free_width_m(permit.free_width_m);
  out.free_height_m(permit.free_height_m);
  return out;
}

CorridorPermit PermitFromWire(const wire::CorridorPermit& permit) {
  return {permit.decision_id(),        permit.object_id(),          permit.scene_revision(),
          permit.valid_until_utc_ns(), FromWire(permit.envelope()), permit.free_width_m(),
          permit.free_height_m()};
}

void CheckPermit(const wire::CorridorPermit& permit, Check& check) {
  check.Require(permit.decision_id() == 0 || IsValid(FromWire(permit.envelope())),
                "the permit's envelope is not valid");
  check.AtLeast(0.0, permit.free_width_m(), "permit.free_width_m");
  check.AtLeast(0.0, permit.free_height_m(), "permit.free_height_m");
}

}  // namespace

wire::VehicleState VehicleStateTopic::ToWire(const VehicleState& value) {
  wire::VehicleState out;
  out.vehicle_id(value.vehicle_id);
  out.agent_epoch(value.agent_epoch);
  out.name(value.name);
  out.stamp_utc_ns(value.stamp_utc_ns);
  out.phase(EnumAs<wire::VehiclePhase>(value.phase));
  out.message(value.message);
  out.autopilot(value.autopilot);
  out.autopilot_mode(value.autopilot_mode);
  out.is_armed(value.armed);
  out.position_in_map_m(soffit::ToWire(value.position_in_map_m));
  out.velocity_in_map_mps(soffit::ToWire(value.velocity_in_map_mps));
  out.yaw_rad(value.yaw_rad);
  out.position_std_m(value.position_std_m);
  out.orientation_std_rad(value.orientation_std_rad);
  out.battery_ratio(value.battery_ratio);
  out.has_origin(value.origin.has_value());
  const GeodeticOrigin origin = value.origin.value_or(GeodeticOrigin{});
  out.origin_latitude_deg(origin.latitude_deg);
  out.origin_longitude_deg(origin.longitude_deg);
  out.origin_altitude_amsl_m(origin.altitude_amsl_m);
  out.envelope(soffit::ToWire(value.envelope));
  out.camera(IntrinsicsToWire(value.camera));
  out.max_speed_mps(value.max_speed_mps);
  return out;
}

Result<VehicleState> VehicleStateTopic::FromWire(const wire::VehicleState& message) {
  Check check;
  check.Known(message.phase(), wire::PHASE_PILOT_IN_CONTROL, "phase");
  check.Finite(message.position_in_map_m(), "position_in_map_m");
  check.Finite(message.velocity_in_map_mps(), "velocity_in_map_mps");
  check.Finite(message.yaw_rad(), "yaw_rad");
  check.AtLeast(0.0, message.position_std_m(), "position_std_m");
  check.AtLeast(0.0, message.orientation_std_rad(), "orientation_std_rad");
  check.Require(message.battery_ratio() <= 1.0, "battery_ratio is above 1");
  check.AtLeast(0.0, message.max_speed_mps(), "max_speed_mps");
  check.Require(!message.has_origin() || (std::abs(message.origin_latitude_deg()) <= 90.0 &&
                                          std::abs(message.origin_longitude_deg()) <= 180.0 &&
                                          std::isfinite(message.origin_altitude_amsl_m())),
                "the origin is no place on the earth");
  CheckIntrinsics(message.camera(), check);
  if (!check.problem().empty()) return InvalidInput(check.problem());

  VehicleState value;
  value.vehicle_id = message.vehicle_id();
  value.agent_epoch = message.agent_epoch();
  value.name = message.name().to_string();
  value.stamp_utc_ns = message.stamp_utc_ns();
  value.phase = EnumAs<VehiclePhase>(message.phase());
  value.message = message.message().to_string();
  value.autopilot = message.autopilot().to_string();
  value.autopilot_mode = message.autopilot_mode().to_string();
  value.armed = message.is_armed();
  value.position_in_map_m = soffit::FromWire(message.position_in_map_m());
  value.velocity_in_map_mps = soffit::FromWire(message.velocity_in_map_mps());
  value.yaw_rad = message.yaw_rad();
  value.position_std_m = message.position_std_m();
  value.orientation_std_rad = message.orientation_std_rad();
  value.battery_ratio = message.battery_ratio();
  if (message.has_origin()) {
    value.origin = GeodeticOrigin{message.origin_latitude_deg(), message.origin_longitude_deg(),
                                  message.origin_altitude_amsl_m()};
  }
  value.envelope = soffit::FromWire(message.envelope());
  value.camera = IntrinsicsFromWire(message.camera());
  value.max_speed_mps = message.max_speed_mps();
  return value;
}

wire::Capture CaptureTopic::ToWire(const Capture& value) {
  wire::Capture out;
  out.vehicle_id(value.vehicle_id);
  out.mission_id(value.mission_id);
  out.capture_id(value.capture_id);
  out.name(value.name);
  out.purpose(soffit::ToWire(value.purpose));
  out.exposure_utc_ns(value.exposure_utc_ns);
  out.intrinsics(IntrinsicsToWire(value.intrinsics));
  out.map_from_camera().position_m(soffit::ToWire(value.map_from_camera.translation_m));
  out.map_from_camera().orientation(soffit::ToWire(value.map_from_camera.rotation));
  out.has_trusted_pose(value.has_trusted_pose);
  out.pose_covariance(SpreadToCovariance(value.position_std_m, value.orientation_std_rad));
  out.bytes(value.bytes);
  return out;
}

Result<Capture> CaptureTopic::FromWire(const wire::Capture& message) {
  const double position_std_m = GreatestStd(message.pose_covariance(), 0);
  const double orientation_std_rad = GreatestStd(message.pose_covariance(), 3);
  const wire::Quaternion& q = message.map_from_camera().orientation();
  const Eigen::Quaterniond rotation(q.w(), q.x(), q.y(), q.z());
  Check check;
  check.Known(message.purpose(), wire::PURPOSE_CORRIDOR, "purpose");
  check.Finite(message.map_from_camera().position_m(), "map_from_camera.position_m");
  check.Require(std::abs(rotation.norm() - 1.0) <= 1e-3, "map_from_camera.orientation is no unit quaternion");
  check.Finite(position_std_m, "pose_covariance (position)");
  check.Finite(orientation_std_rad, "pose_covariance (orientation)");
  check.Require(!message.bytes().empty(), "the picture is empty");
  check.Require(message.bytes().size() <= kMaxPictureBytes, "the picture has more than 64 MiB");
  CheckIntrinsics(message.intrinsics(), check);
  check.Require(IsValid(IntrinsicsFromWire(message.intrinsics())), "the intrinsics are not valid");
  if (!check.problem().empty()) {
    return InvalidInput("picture " + std::to_string(message.capture_id()) + " of vehicle " +
                        std::to_string(message.vehicle_id()) + ": " + check.problem());
  }

  Capture value;
  value.vehicle_id = message.vehicle_id();
  value.mission_id = message.mission_id();
  value.capture_id = message.capture_id();
  value.name = message.name().to_string();
  value.purpose = EnumAs<Purpose>(message.purpose());
  value.exposure_utc_ns = message.exposure_utc_ns();
  value.intrinsics = IntrinsicsFromWire(message.intrinsics());
  value.map_from_camera = {rotation.normalized(), soffit::FromWire(message.map_from_camera().position_m())};
  value.has_trusted_pose = message.has_trusted_pose();
  value.position_std_m = position_std_m;
  value.orientation_std_rad = orientation_std_rad;
  value.bytes = message.bytes();
  return value;
}

wire::FlightCommand FlightCommandTopic::ToWire(const FlightCommand& value) {
  wire::FlightCommand out;
  out.vehicle_id(value.vehicle_id);
  out.mission_id(value.mission_id);
  out.sequence_number(value.sequence);
  out.issued_utc_ns(value.issued_utc_ns);
  out.valid_until_utc_ns(value.valid_until_utc_ns);
  out.kind(EnumAs<wire::CommandKind>(value.kind));
  out.path_in_map_m(soffit::ToWire(value.path_in_map_m));
  out.yaw_rad(value.yaw_rad);
  out.speed_mps(value.speed_mps);
  out.camera_pitch_rad(value.camera_pitch_rad);
  out.purpose(soffit::ToWire(value.purpose));
  out.capture_id(value.capture_id);
  if (value.permit) out.permit(PermitToWire(*value.permit));
  return out;
}

Result<FlightCommand> FlightCommandTopic::FromWire(const wire::FlightCommand& message) {
  Check check;
  check.Known(message.kind(), wire::COMMAND_ABORT, "kind");
  check.Known(message.purpose(), wire::PURPOSE_CORRIDOR, "purpose");
  check.Require(message.path_in_map_m().size() <= kMaxPathPoints, "the path has more than 256 points");
  for (const wire::Vector3& point : message.path_in_map_m()) check.Finite(point, "path_in_map_m");
  check.Finite(message.yaw_rad(), "yaw_rad");
  check.AtLeast(0.0, message.speed_mps(), "speed_mps");
  check.Finite(message.camera_pitch_rad(), "camera_pitch_rad");
  CheckPermit(message.permit(), check);
  if (!check.problem().empty()) {
    return InvalidInput("command " + std::to_string(message.sequence_number()) + " to vehicle " +
                        std::to_string(message.vehicle_id()) + ": " + check.problem());
  }

  FlightCommand value;
  value.vehicle_id = message.vehicle_id();
  value.mission_id = message.mission_id();
  value.sequence = message.sequence_number();
  value.issued_utc_ns = message.issued_utc_ns();
  value.valid_until_utc_ns = message.valid_until_utc_ns();
  value.kind = EnumAs<CommandKind>(message.kind());
  value.path_in_map_m = soffit::FromWire(message.path_in_map_m());
  value.yaw_rad = message.yaw_rad();
  value.speed_mps = message.speed_mps();
  value.camera_pitch_rad = message.camera_pitch_rad();
  value.purpose = EnumAs<Purpose>(message.purpose());
  value.capture_id = message.capture_id();
  if (message.permit().decision_id() != 0) value.permit = PermitFromWire(message.permit());
  return value;
}

wire::CommandAck CommandAckTopic::ToWire(const CommandAck& value) {
  wire::CommandAck out;
  out.vehicle_id(value.vehicle_id);
  out.mission_id(value.mission_id);
  out.sequence_number(value.sequence);
  out.agent_epoch(value.agent_epoch);
  out.stamp_utc_ns(value.stamp_utc_ns);
  out.status(EnumAs<wire::AckStatus>(value.status));
  out.reason(value.reason);
  return out;
}

Result<CommandAck> CommandAckTopic::FromWire(const wire::CommandAck& message) {
  Check check;
  check.Known(message.status(), wire::ACK_FAILED, "status");
  if (!check.problem().empty()) return InvalidInput(check.problem());
  return CommandAck{message.vehicle_id(),        message.mission_id(),   message.sequence_number(),
                    message.agent_epoch(),       message.stamp_utc_ns(), EnumAs<AckStatus>(message.status()),
                    message.reason().to_string()};
}

wire::MissionHeartbeat MissionHeartbeatTopic::ToWire(const MissionHeartbeat& value) {
  wire::MissionHeartbeat out;
  out.vehicle_id(value.vehicle_id);
  out.mission_id(value.mission_id);
  out.service_epoch(value.service_epoch);
  out.stamp_utc_ns(value.stamp_utc_ns);
  out.is_paused(value.is_paused);
  return out;
}

Result<MissionHeartbeat> MissionHeartbeatTopic::FromWire(const wire::MissionHeartbeat& message) {
  return MissionHeartbeat{message.vehicle_id(), message.mission_id(), message.service_epoch(),
                          message.stamp_utc_ns(), message.is_paused()};
}

}  // namespace soffit
