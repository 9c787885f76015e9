#include "shared/wire/topics.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "shared/result/say.h"
#include "shared/wire/fields.h"

namespace soffit {
namespace {

constexpr std::size_t kMaxPictureBytes = std::size_t{64} << 20;
constexpr std::size_t kMaxPathPoints = 256;
constexpr double kMaxSide_px = 65536.0;
constexpr int kPoseSize = 6;
using PoseCovariance = std::array<double, 36>;

/// Row-major 6 x 6, the same standard deviation on every axis.
PoseCovariance SpreadToCovariance(double position_std_m, double orientation_std_rad) {
  PoseCovariance covariance{};
  for (std::size_t i = 0; i < kPoseSize; ++i) {
    const double std = i < 3 ? position_std_m : orientation_std_rad;
    covariance[i * kPoseSize + i] = std * std;
  }
  return covariance;
}

/// Standard deviation along the worst direction of one 3 x 3 block; NaN when the block is no covariance.
double GreatestStd(const PoseCovariance& covariance, int first) {
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

}  // namespace

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Intrinsics>& m, ValueOf<Io, Intrinsics>& v) {
  io("width_px", m.width_px(), v.width_px, AtMost{kMaxSide_px});
  io("height_px", m.height_px(), v.height_px, AtMost{kMaxSide_px});
  io("fx_px", m.fx_px(), v.fx_px);
  io("fy_px", m.fy_px(), v.fy_px);
  io("cx_px", m.cx_px(), v.cx_px);
  io("cy_px", m.cy_px(), v.cy_px);
  io("plumb_bob", m.plumb_bob(), v.distortion);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::VehicleState>& m, ValueOf<Io, VehicleState>& v) {
  io("vehicle_id", m.vehicle_id(), v.vehicle_id);
  io("agent_epoch", m.agent_epoch(), v.agent_epoch);
  io("name", m.name(), v.name);
  io("stamp_utc_ns", m.stamp_utc_ns(), v.stamp_utc_ns);
  io("phase", m.phase(), v.phase, Last{wire::PHASE_PILOT_IN_CONTROL});
  io("message", m.message(), v.message);
  io("autopilot", m.autopilot(), v.autopilot);
  io("autopilot_mode", m.autopilot_mode(), v.autopilot_mode);
  io("is_armed", m.is_armed(), v.armed);
  io("position_in_map_m", m.position_in_map_m(), v.position_in_map_m);
  io("velocity_in_map_mps", m.velocity_in_map_mps(), v.velocity_in_map_mps);
  io("yaw_rad", m.yaw_rad(), v.yaw_rad);
  io("position_std_m", m.position_std_m(), v.position_std_m, AtLeast{0.0});
  io("orientation_std_rad", m.orientation_std_rad(), v.orientation_std_rad, AtLeast{0.0});
  io("battery_ratio", m.battery_ratio(), v.battery_ratio, AtMost{1.0});
  io("envelope", m.envelope(), v.envelope);
  io("camera", m.camera(), v.camera);
  io("max_speed_mps", m.max_speed_mps(), v.max_speed_mps, AtLeast{0.0});

  bool has_origin = v.origin.has_value();
  GeodeticOrigin origin = v.origin.value_or(GeodeticOrigin{});
  io("has_origin", m.has_origin(), has_origin);
  io("origin_latitude_deg", m.origin_latitude_deg(), origin.latitude_deg, AtLeast{-90.0}, AtMost{90.0});
  io("origin_longitude_deg", m.origin_longitude_deg(), origin.longitude_deg, AtLeast{-180.0}, AtMost{180.0});
  io("origin_altitude_amsl_m", m.origin_altitude_amsl_m(), origin.altitude_amsl_m);
  if constexpr (Io::kReads) {
    if (has_origin) v.origin = origin;
  }
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Capture>& m, ValueOf<Io, Capture>& v) {
  io("vehicle_id", m.vehicle_id(), v.vehicle_id);
  io("mission_id", m.mission_id(), v.mission_id);
  io("capture_id", m.capture_id(), v.capture_id);
  io("name", m.name(), v.name);
  io("purpose", m.purpose(), v.purpose, Last{wire::PURPOSE_CORRIDOR});
  io("exposure_utc_ns", m.exposure_utc_ns(), v.exposure_utc_ns);
  io("intrinsics", m.intrinsics(), v.intrinsics);
  io.Require(IsValid(v.intrinsics), "the intrinsics are not valid");
  io("map_from_camera.position_m", m.map_from_camera().position_m(), v.map_from_camera.translation_m);
  io("map_from_camera.orientation", m.map_from_camera().orientation(), v.map_from_camera.rotation);
  io("has_trusted_pose", m.has_trusted_pose(), v.has_trusted_pose);
  io.Require(!m.bytes().empty(), "the picture is empty");
  io.Require(m.bytes().size() <= kMaxPictureBytes, "the picture has more than 64 MiB");
  io("bytes", m.bytes(), v.bytes);

  PoseCovariance covariance = SpreadToCovariance(v.position_std_m, v.orientation_std_rad);
  io("pose_covariance", m.pose_covariance(), covariance);
  if constexpr (Io::kReads) {
    v.position_std_m = GreatestStd(covariance, 0);
    v.orientation_std_rad = GreatestStd(covariance, 3);
    io.Require(std::isfinite(v.position_std_m + v.orientation_std_rad), "pose_covariance is no covariance");
  }
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::CorridorPermit>& m, ValueOf<Io, CorridorPermit>& v) {
  io("decision_id", m.decision_id(), v.decision_id);
  io("object_id", m.object_id(), v.object_id);
  io("scene_revision", m.scene_revision(), v.scene_revision);
  io("valid_until_utc_ns", m.valid_until_utc_ns(), v.valid_until_utc_ns);
  io("envelope", m.envelope(), v.envelope);
  io.Require(v.decision_id == 0 || IsValid(v.envelope), "has an envelope that is not valid");
  io("free_width_m", m.free_width_m(), v.free_width_m, AtLeast{0.0});
  io("free_height_m", m.free_height_m(), v.free_height_m, AtLeast{0.0});
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::FlightCommand>& m, ValueOf<Io, FlightCommand>& v) {
  io("vehicle_id", m.vehicle_id(), v.vehicle_id);
  io("mission_id", m.mission_id(), v.mission_id);
  io("sequence_number", m.sequence_number(), v.sequence);
  io("issued_utc_ns", m.issued_utc_ns(), v.issued_utc_ns);
  io("valid_until_utc_ns", m.valid_until_utc_ns(), v.valid_until_utc_ns);
  io("kind", m.kind(), v.kind, Last{wire::COMMAND_ABORT});
  io.Require(m.path_in_map_m().size() <= kMaxPathPoints, "the path has more than 256 points");
  io("path_in_map_m", m.path_in_map_m(), v.path_in_map_m);
  io("yaw_rad", m.yaw_rad(), v.yaw_rad);
  io("speed_mps", m.speed_mps(), v.speed_mps, AtLeast{0.0});
  io("camera_pitch_rad", m.camera_pitch_rad(), v.camera_pitch_rad);
  io("purpose", m.purpose(), v.purpose, Last{wire::PURPOSE_CORRIDOR});
  io("capture_id", m.capture_id(), v.capture_id);

  CorridorPermit permit = v.permit.value_or(CorridorPermit{});
  io("permit", m.permit(), permit);
  if constexpr (Io::kReads) {
    if (permit.decision_id != 0) v.permit = permit;
  }
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::CommandAck>& m, ValueOf<Io, CommandAck>& v) {
  io("vehicle_id", m.vehicle_id(), v.vehicle_id);
  io("mission_id", m.mission_id(), v.mission_id);
  io("sequence_number", m.sequence_number(), v.sequence);
  io("agent_epoch", m.agent_epoch(), v.agent_epoch);
  io("stamp_utc_ns", m.stamp_utc_ns(), v.stamp_utc_ns);
  io("status", m.status(), v.status, Last{wire::ACK_FAILED});
  io("reason", m.reason(), v.reason);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::MissionHeartbeat>& m, ValueOf<Io, MissionHeartbeat>& v) {
  io("vehicle_id", m.vehicle_id(), v.vehicle_id);
  io("mission_id", m.mission_id(), v.mission_id);
  io("service_epoch", m.service_epoch(), v.service_epoch);
  io("stamp_utc_ns", m.stamp_utc_ns(), v.stamp_utc_ns);
  io("is_paused", m.is_paused(), v.is_paused);
}

wire::VehicleState VehicleStateTopic::ToWire(const VehicleState& value) {
  return WriteMessage<wire::VehicleState>(value);
}
Result<VehicleState> VehicleStateTopic::FromWire(const wire::VehicleState& message) {
  return ReadMessage<VehicleState>(message);
}

wire::Capture CaptureTopic::ToWire(const Capture& value) { return WriteMessage<wire::Capture>(value); }
Result<Capture> CaptureTopic::FromWire(const wire::Capture& message) {
  return ReadMessage<Capture>(
      message, Say("picture ", message.capture_id(), " of vehicle ", message.vehicle_id(), ": "));
}

wire::FlightCommand FlightCommandTopic::ToWire(const FlightCommand& value) {
  return WriteMessage<wire::FlightCommand>(value);
}
Result<FlightCommand> FlightCommandTopic::FromWire(const wire::FlightCommand& message) {
  return ReadMessage<FlightCommand>(
      message, Say("command ", message.sequence_number(), " to vehicle ", message.vehicle_id(), ": "));
}

wire::CommandAck CommandAckTopic::ToWire(const CommandAck& value) {
  return WriteMessage<wire::CommandAck>(value);
}
Result<CommandAck> CommandAckTopic::FromWire(const wire::CommandAck& message) {
  return ReadMessage<CommandAck>(message);
}

wire::MissionHeartbeat MissionHeartbeatTopic::ToWire(const MissionHeartbeat& value) {
  return WriteMessage<wire::MissionHeartbeat>(value);
}
Result<MissionHeartbeat> MissionHeartbeatTopic::FromWire(const wire::MissionHeartbeat& message) {
  return ReadMessage<MissionHeartbeat>(message);
}

}  // namespace soffit
