#include "test/sim/autopilot/telemetry.h"

#include <cmath>

#include "vehicle_agent/mavlink/constants.h"

namespace soffit::sim {
namespace {

using namespace mavlink;

std::uint32_t BootMs(const Report& report) { return static_cast<std::uint32_t>(report.boot_s * 1e3); }
std::uint64_t BootUs(const Report& report) { return static_cast<std::uint64_t>(report.boot_s * 1e6); }
std::int32_t DegE7(double angle_deg) { return static_cast<std::int32_t>(std::lround(angle_deg * 1e7)); }
std::int32_t Millimetres(double length_m) { return static_cast<std::int32_t>(std::lround(length_m * 1e3)); }
float F(double number) { return static_cast<float>(number); }
double Degrees(double angle_rad) { return angle_rad * 180.0 / M_PI; }

template <class Integer>
Integer Rounded(double number) {
  return static_cast<Integer>(std::lround(number));
}

std::uint16_t HeadingCentidegrees(double heading_rad) {
  return Rounded<std::uint16_t>(std::fmod(Degrees(heading_rad) + 360.0, 360.0) * 100.0);
}

// One builder for each message; none: there is nothing to tell yet.
template <class Message>
std::optional<Message> Build(const Report& report);

template <>
std::optional<Heartbeat> Build(const Report& report) {
  Heartbeat m;
  m.type = kTypeQuadrotor;
  m.autopilot = report.autopilot;
  m.base_mode = report.base_mode;
  m.custom_mode = report.custom_mode;
  m.system_status = report.system_status;
  m.mavlink_version = 3;
  return m;
}

template <>
std::optional<SysStatus> Build(const Report& report) {
  SysStatus m;
  m.onboard_control_sensors_present = kSensorGps | kSensorBattery | kSensorPrearmCheck;
  m.onboard_control_sensors_enabled = m.onboard_control_sensors_present;
  m.onboard_control_sensors_health = (report.has_gps ? kSensorGps : 0U) | kSensorBattery |
                                     (report.is_ready_to_arm ? kSensorPrearmCheck : 0U);
  m.load = 200;
  m.voltage_battery = Rounded<std::uint16_t>(10500.0 + 2100.0 * report.battery_ratio);
  m.current_battery = -1;
  m.battery_remaining = Rounded<std::int8_t>(100.0 * report.battery_ratio);
  return m;
}

template <>
std::optional<SystemTime> Build(const Report& report) {
  return SystemTime{report.has_gps ? static_cast<std::uint64_t>(report.utc_ns / 1000) : 0, BootMs(report)};
}

template <>
std::optional<GpsRawInt> Build(const Report& report) {
  GpsRawInt m;
  m.time_usec = BootUs(report);
  m.fix_type = report.has_gps ? kGpsRtkFixed : kGpsNoFix;
  m.satellites_visible = report.has_gps ? 14 : 0;
  m.eph = report.has_gps ? 80 : 9999;
  m.epv = report.has_gps ? 100 : 9999;
  if (report.has_gps && report.frame != nullptr) {
    const auto geodetic = report.frame->GeodeticOf(report.estimate.position_m);
    m.lat = DegE7(geodetic.latitude_deg);
    m.lon = DegE7(geodetic.longitude_deg);
    m.alt = Millimetres(geodetic.altitude_amsl_m);
  }
  m.vel = Rounded<std::uint16_t>(100.0 * report.estimate.velocity_mps.head<2>().norm());
  return m;
}

template <>
std::optional<Attitude> Build(const Report& report) {
  const EulerAngles angles = EulerOf(NedFrame::SwapAttitude(report.estimate.map_from_body));
  const Eigen::Vector3d& rate = report.estimate.rate_in_body_radps;
  return Attitude{BootMs(report), F(angles.roll_rad), F(angles.pitch_rad), F(angles.yaw_rad),
                  F(rate.x()),    F(-rate.y()),       F(-rate.z())};
}

template <>
std::optional<AttitudeQuaternion> Build(const Report& report) {
  const Eigen::Quaterniond q = NedFrame::SwapAttitude(report.estimate.map_from_body);
  const Eigen::Vector3d& rate = report.estimate.rate_in_body_radps;
  return AttitudeQuaternion{BootMs(report), F(q.w()),     F(q.x()),     F(q.y()), F(q.z()),
                            F(rate.x()),    F(-rate.y()), F(-rate.z()), {}};
}

template <>
std::optional<LocalPositionNed> Build(const Report& report) {
  if (!report.has_position || report.frame == nullptr) return std::nullopt;
  const Eigen::Vector3d position = report.frame->FromMap(report.estimate.position_m);
  const Eigen::Vector3d velocity = NedFrame::SwapVector(report.estimate.velocity_mps);
  return LocalPositionNed{BootMs(report),  F(position.x()), F(position.y()), F(position.z()),
                          F(velocity.x()), F(velocity.y()), F(velocity.z())};
}

template <>
std::optional<GlobalPositionInt> Build(const Report& report) {
  if (!report.has_position || report.frame == nullptr || !report.home_in_map_m) return std::nullopt;
  const auto geodetic = report.frame->GeodeticOf(report.estimate.position_m);
  const Eigen::Vector3d velocity = 100.0 * NedFrame::SwapVector(report.estimate.velocity_mps);
  GlobalPositionInt m;
  m.time_boot_ms = BootMs(report);
  m.lat = DegE7(geodetic.latitude_deg);
  m.lon = DegE7(geodetic.longitude_deg);
  m.alt = Millimetres(geodetic.altitude_amsl_m);
  m.relative_alt = Millimetres(report.estimate.position_m.z() - report.home_in_map_m->z());
  m.vx = Rounded<std::int16_t>(velocity.x());
  m.vy = Rounded<std::int16_t>(velocity.y());
  m.vz = Rounded<std::int16_t>(velocity.z());
  m.hdg = HeadingCentidegrees(EulerOf(NedFrame::SwapAttitude(report.estimate.map_from_body)).yaw_rad);
  return m;
}

template <>
std::optional<GpsGlobalOrigin> Build(const Report& report) {
  if (report.frame == nullptr) return std::nullopt;
  const auto geodetic = report.frame->GeodeticOf(report.frame->ToMap(Eigen::Vector3d::Zero()));
  return GpsGlobalOrigin{DegE7(geodetic.latitude_deg), DegE7(geodetic.longitude_deg),
                         Millimetres(geodetic.altitude_amsl_m), BootUs(report)};
}

template <>
std::optional<HomePosition> Build(const Report& report) {
  if (!report.home_in_map_m || report.frame == nullptr) return std::nullopt;
  const auto geodetic = report.frame->GeodeticOf(*report.home_in_map_m);
  HomePosition m;
  m.latitude = DegE7(geodetic.latitude_deg);
  m.longitude = DegE7(geodetic.longitude_deg);
  m.altitude = Millimetres(geodetic.altitude_amsl_m);
  if (report.autopilot == kAutopilotPx4) {  // ArduPilot leaves the local position zero, wherever home is.
    const Eigen::Vector3d position = report.frame->FromMap(*report.home_in_map_m);
    m.x = F(position.x());
    m.y = F(position.y());
    m.z = F(position.z());
  }
  m.q = {1.0F, 0.0F, 0.0F, 0.0F};
  m.time_usec = BootUs(report);
  return m;
}

template <>
std::optional<RcChannels> Build(const Report& report) {
  RcChannels m;
  m.time_boot_ms = BootMs(report);
  if (!report.has_radio) return m;
  m.chancount = 16;
  m.rssi = 254;
  m.chan1_raw = m.chan2_raw = m.chan4_raw = 1500;
  m.chan3_raw = Rounded<std::uint16_t>(1000.0 + 1000.0 * report.throttle_ratio);
  return m;
}

template <>
std::optional<PositionTargetLocalNed> Build(const Report& report) {
  if (!report.target_in_map_m || report.frame == nullptr) return std::nullopt;
  const Eigen::Vector3d target = report.frame->FromMap(*report.target_in_map_m);
  PositionTargetLocalNed m;
  m.time_boot_ms = BootMs(report);
  m.coordinate_frame = kFrameLocalNed;
  m.type_mask = kIgnoreVelocity | kIgnoreAcceleration | kIgnoreYaw | kIgnoreYawRate;
  m.x = F(target.x());
  m.y = F(target.y());
  m.z = F(target.z());
  return m;
}

template <>
std::optional<BatteryStatus> Build(const Report& report) {
  BatteryStatus m;
  m.voltages.fill(UINT16_MAX);
  for (std::size_t cell = 0; cell < 3; ++cell) {
    m.voltages[cell] = Rounded<std::uint16_t>(3500.0 + 700.0 * report.battery_ratio);
  }
  m.temperature = INT16_MAX;
  m.current_battery = -1;
  m.current_consumed = -1;
  m.energy_consumed = -1;
  m.battery_remaining = Rounded<std::int8_t>(100.0 * report.battery_ratio);
  m.charge_state = report.battery_charge_state;
  return m;
}

template <>
std::optional<AutopilotVersion> Build(const Report&) {
  AutopilotVersion m;
  m.flight_sw_version = 4U << 24 | 5U << 16 | 6U << 8 | 255U;  // 4.5.6, official.
  return m;
}

template <>
std::optional<EkfStatusReport> Build(const Report& report) {
  if (report.autopilot != kAutopilotArduPilot) return std::nullopt;
  EkfStatusReport m;
  m.flags = report.estimator_flags;
  m.velocity_variance = m.pos_horiz_variance = m.pos_vert_variance = report.has_position ? 0.05F : 0.0F;
  return m;
}

template <>
std::optional<EstimatorStatus> Build(const Report& report) {
  if (report.autopilot != kAutopilotPx4) return std::nullopt;
  EstimatorStatus m;
  m.time_usec = BootUs(report);
  m.flags = report.estimator_flags;
  m.pos_horiz_accuracy = report.has_gps ? 0.1F : 10.0F;
  m.pos_vert_accuracy = report.has_gps ? 0.1F : 10.0F;
  return m;
}

template <>
std::optional<ExtendedSysState> Build(const Report& report) {
  return ExtendedSysState{0, report.landed_state};
}

template <>
std::optional<MountOrientation> Build(const Report& report) {
  return MountOrientation{BootMs(report), 0.0F, F(Degrees(report.gimbal_pitch_rad)),
                          F(Degrees(report.gimbal_yaw_from_nose_rad)),
                          F(Degrees(report.gimbal_yaw_from_north_rad))};
}

template <>
std::optional<GimbalDeviceAttitudeStatus> Build(const Report& report) {
  const bool is_north = report.is_gimbal_yaw_against_north;
  const double yaw_rad = is_north ? report.gimbal_yaw_from_north_rad : report.gimbal_yaw_from_nose_rad;
  const Eigen::Quaterniond q = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(report.gimbal_pitch_rad, Eigen::Vector3d::UnitY());
  GimbalDeviceAttitudeStatus m;
  m.time_boot_ms = BootMs(report);
  m.flags = static_cast<std::uint16_t>(kGimbalRollLock | kGimbalPitchLock | (is_north ? kGimbalYawLock : 0U));
  m.q = {F(q.w()), F(q.x()), F(q.y()), F(q.z())};
  m.gimbal_device_id = 1;
  return m;
}

template <class Message>
bool SendBuilt(Telemetry& telemetry, const Report& report) {
  const auto message = Build<Message>(report);
  if (message) telemetry.Send(*message);
  return message.has_value();
}

using Sender = bool (*)(Telemetry&, const Report&);

template <class... Messages>
std::map<std::uint32_t, Sender> MakeSenders() {
  return {{Messages::kId, &SendBuilt<Messages>}...};
}

const std::map<std::uint32_t, Sender> kSenders =
    MakeSenders<Heartbeat, SysStatus, SystemTime, GpsRawInt, Attitude, AttitudeQuaternion, LocalPositionNed,
                GlobalPositionInt, GpsGlobalOrigin, HomePosition, RcChannels, PositionTargetLocalNed,
                BatteryStatus, AutopilotVersion, EkfStatusReport, EstimatorStatus, ExtendedSysState,
                MountOrientation, GimbalDeviceAttitudeStatus>();

}  // namespace

bool Telemetry::SetInterval(std::uint32_t message_id, double interval_s) {
  if (kSenders.count(message_id) == 0) return false;
  if (interval_s > 0.0) {
    streams_[message_id] = {interval_s, 0.0};
  } else {
    streams_.erase(message_id);
  }
  return true;
}

std::optional<double> Telemetry::Interval(std::uint32_t message_id) const {
  if (kSenders.count(message_id) == 0) return std::nullopt;
  const auto found = streams_.find(message_id);
  return found == streams_.end() ? 0.0 : found->second.interval_s;
}

void Telemetry::Step(const Report& report) {
  for (auto& [id, stream] : streams_) {
    if (report.boot_s < stream.next_s) continue;
    SendNow(id, report);
    const double late_s = report.boot_s - stream.next_s;
    stream.next_s = (late_s < stream.interval_s ? stream.next_s : report.boot_s) + stream.interval_s;
  }
}

bool Telemetry::SendNow(std::uint32_t message_id, const Report& report) {
  const auto found = kSenders.find(message_id);
  return found != kSenders.end() && found->second(*this, report);
}

void Telemetry::SendText(std::uint8_t severity, std::string_view text) {
  Statustext m;
  m.severity = severity;
  m.text = ToTextField<50>(text);
  Send(m);
}

}  // namespace soffit::sim
