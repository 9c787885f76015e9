#include "test/sim/autopilot/autopilot.h"

#include <algorithm>
#include <cmath>

namespace soffit::sim {
namespace {

using namespace mavlink;

constexpr double kTimesyncPeriod_s = 10.0;

double Radians(double angle_deg) { return angle_deg * M_PI / 180.0; }

/// A whole number that came as a float; one that no message has when it is none.
std::uint32_t ToWhole(double number) {
  return number >= 0.0 && number < 16777216.0 ? static_cast<std::uint32_t>(number) : UINT32_MAX;
}

CommandRequest ToRequest(const CommandLong& m) {
  return {m.command, m.param1, m.param2, m.param3, m.param4, m.param5, m.param6, m.param7};
}

CommandRequest ToRequest(const CommandInt& m) {
  return {m.command,
          m.param1,
          m.param2,
          m.param3,
          m.param4,
          static_cast<double>(m.x),
          static_cast<double>(m.y),
          static_cast<double>(m.z),
          m.frame};
}

}  // namespace

Autopilot::Autopilot(const AutopilotOptions& options, std::map<std::string, double> parameters,
                     std::vector<FlightMode> modes)
    : options_(options),
      parameters_(std::move(parameters)),
      modes_(std::move(modes)),
      links_(options.link_count, Telemetry(options.system_id, kComponentAutopilot)) {}

void Autopilot::SetGps(bool is_there) {
  if (has_gps_ != is_there) gps_changed_s_ = boot_s_;
  has_gps_ = is_there;
}

void Autopilot::SetRadio(bool is_there) {
  if (has_radio_ && !is_there) radio_lost_s_ = boot_s_;
  has_radio_ = is_there;
}

void Autopilot::Reboot() {
  boot_s_ = 0.0;
  gps_changed_s_ = 0.0;
  next_timesync_s_ = 1.0;
  last_heartbeat_of_gcs_s_ = -1.0;
  is_armed_ = false;
  is_failsafe_ = false;
  goal_ = {};
  frame_.reset();
  home_in_map_m_.reset();
  for (Telemetry& link : links_) link.Stop();
  Boot();
}

void Autopilot::Crash() {
  if (is_armed_) Announce(kSeverityEmergency, "Crash: Disarming");
  is_armed_ = false;
}

void Autopilot::SetOrigin(const Eigen::Vector3d& in_map_m) {
  frame_.emplace(options_.map_origin, in_map_m);
  for (Telemetry& link : links_) link.SendNow(GpsGlobalOrigin::kId, MakeReport());
}

void Autopilot::SetHome(const Eigen::Vector3d& in_map_m) {
  home_in_map_m_ = in_map_m;
  for (Telemetry& link : links_) link.SendNow(HomePosition::kId, MakeReport());
}

void Autopilot::Announce(std::uint8_t severity, std::string_view text) {
  for (Telemetry& link : links_) link.SendText(severity, text);
}

void Autopilot::SetIntervalOnAllLinks(std::uint32_t message_id, double interval_s) {
  for (Telemetry& link : links_) link.SetInterval(message_id, interval_s);
}

void Autopilot::PassOn(const Frame& frame) {
  for (std::size_t link = 0; link < links_.size(); ++link) {
    if (link != asking_link_) links_[link].PassOn(frame);
  }
}

bool Autopilot::PilotSelects(const std::string& mode) {
  const auto found =
      std::find_if(modes_.begin(), modes_.end(), [&](const FlightMode& m) { return m.name == mode; });
  if (found == modes_.end()) return false;
  SetRadio(true);
  Enter(found->number);
  return true;
}

const FlightMode* Autopilot::FindMode(double number) const {
  const auto found = std::find_if(modes_.begin(), modes_.end(), [&](const FlightMode& mode) {
    return static_cast<double>(mode.number) == number;
  });
  return found == modes_.end() ? nullptr : &*found;
}

void Autopilot::Enter(std::uint32_t mode) {
  mode_ = mode;
  target_m_ = StoppingPoint();
  yaw_rad_ = YawOf(senses_.estimate.map_from_body);
  OnEnter();
}

void Autopilot::FlyTo(const Eigen::Vector3d& position_m) {
  goal_ = {FlightGoal::Kind::kPosition, position_m, Eigen::Vector3d::Zero(), yaw_rad_};
}

void Autopilot::FlyAt(const Eigen::Vector3d& velocity_mps) {
  goal_ = {FlightGoal::Kind::kVelocity, Eigen::Vector3d::Zero(), velocity_mps, yaw_rad_};
}

void Autopilot::Sink(double speed_mps) {
  FlyTo({target_m_.x(), target_m_.y(), control_.path_position_m().z()});
  goal_.velocity_mps.z() = -speed_mps;
}

std::optional<Setpoint> Autopilot::ToMap(const SetPositionTargetLocalNed& m) const {
  const bool is_body = m.coordinate_frame == kFrameBodyNed || m.coordinate_frame == kFrameBodyOffsetNed;
  const bool is_offset = is_body || m.coordinate_frame == kFrameLocalOffsetNed;
  const bool has_position = (m.type_mask & kIgnorePosition) == 0;
  const bool has_velocity = (m.type_mask & kIgnoreVelocity) == 0;
  const bool has_yaw = (m.type_mask & kIgnoreYaw) == 0;
  if (!frame_ || (!is_offset && m.coordinate_frame != kFrameLocalNed) || (!has_position && !has_velocity) ||
      (has_position && !std::isfinite(m.x + m.y + m.z)) ||
      (has_velocity && !std::isfinite(m.vx + m.vy + m.vz))) {
    return std::nullopt;
  }
  const Eigen::AngleAxisd from_nose(is_body ? YawOf(senses_.estimate.map_from_body) - 0.5 * M_PI : 0.0,
                                    Eigen::Vector3d::UnitZ());
  Setpoint setpoint;
  if (has_position) {
    const Eigen::Vector3d sent(m.x, m.y, m.z);
    setpoint.position_m =
        is_offset ? Eigen::Vector3d(senses_.estimate.position_m + from_nose * NedFrame::SwapVector(sent))
                  : frame_->ToMap(sent);
  }
  if (has_velocity) {
    setpoint.velocity_mps = from_nose * NedFrame::SwapVector(Eigen::Vector3d(m.vx, m.vy, m.vz));
  }
  if (has_yaw) setpoint.heading_rad = static_cast<double>(m.yaw);
  return setpoint;
}

Eigen::Vector3d Autopilot::StoppingPoint() const {
  const Eigen::Vector3d& velocity_mps = senses_.estimate.velocity_mps;
  return senses_.estimate.position_m +
         velocity_mps * (velocity_mps.norm() / (2.0 * limits_.acceleration_mps2));
}

bool Autopilot::IsForUs(std::uint8_t system, std::uint8_t component) const {
  return (system == 0 || system == options_.system_id) &&
         (component == 0 || component == kComponentAutopilot);
}

void Autopilot::Receive(const Frame& frame, std::size_t link) {
  if (frame.system_id == options_.system_id && frame.component_id == kComponentAutopilot)
    return;  // Our own echo.
  asking_link_ = link;
  if (Decode<Heartbeat>(frame)) {
    PassOn(frame);
    return TakeHeartbeat(frame);
  }
  if (const auto m = Decode<Timesync>(frame)) return AnswerTimesync(frame, *m);
  if (const auto m = Decode<CommandLong>(frame); m && IsForUs(m->target_system, m->target_component)) {
    return AnswerCommand(frame, ToRequest(*m));
  }
  if (const auto m = Decode<CommandInt>(frame); m && IsForUs(m->target_system, m->target_component)) {
    return AnswerCommand(frame, ToRequest(*m));
  }
  if (const auto m = Decode<SetPositionTargetLocalNed>(frame);
      m && IsForUs(m->target_system, m->target_component)) {
    return TakeSetpoint(*m);
  }
  if (const auto m = Decode<RequestDataStream>(frame); m && IsForUs(m->target_system, m->target_component)) {
    return SetDataStream(*m);
  }
  if (const auto m = Decode<ParamRequestRead>(frame); m && IsForUs(m->target_system, m->target_component)) {
    if (const auto answer = parameters_.Read(*m)) asking_link().Send(*answer);
    return;
  }
  if (const auto m = Decode<ParamSet>(frame); m && IsForUs(m->target_system, m->target_component)) {
    if (const auto answer = parameters_.Write(*m)) asking_link().Send(*answer);
    return;
  }
  if (const auto m = Decode<SetGpsGlobalOrigin>(frame);
      m && m->target_system == options_.system_id && !frame_) {
    const GeodeticOrigin origin{m->latitude * 1e-7, m->longitude * 1e-7, m->altitude * 1e-3};
    return SetOrigin(NedFrame(options_.map_origin, Eigen::Vector3d::Zero()).MapOf(origin));
  }
  if (const auto m = Decode<GimbalManagerSetPitchyaw>(frame);
      m && IsForUs(m->target_system, m->target_component)) {
    gimbal_.Point(static_cast<double>(m->pitch), static_cast<double>(m->yaw),
                  (m->flags & kGimbalYawLock) != 0);
  }
}

void Autopilot::AnswerCommand(const Frame& frame, const CommandRequest& request) {
  mavlink::CommandAck ack;
  ack.command = request.command;
  ack.result = Execute(request);
  ack.target_system = frame.system_id;
  ack.target_component = frame.component_id;
  asking_link().Send(ack);
}

void Autopilot::AnswerTimesync(const Frame& frame, const Timesync& request) {
  if (request.tc1 != 0) return;  // The answer to ours.
  asking_link().Send(Timesync{BootNs(), request.ts1, frame.system_id, frame.component_id});
}

CommandResult Autopilot::ExecuteCommon(const CommandRequest& request) {
  const std::uint32_t message_id = ToWhole(request.param1);
  switch (request.command) {
    case kCmdComponentArmDisarm:
      return ArmOrDisarm(request);
    case kCmdDoSetHome:
      if (!frame_ || request.param1 != 1.0) return Refusal();
      SetHome(senses_.estimate.position_m);
      return kResultAccepted;
    case kCmdSetMessageInterval: {
      const double interval_us = request.param2;
      return asking_link().SetInterval(message_id,
                                       interval_us > 0.0 ? std::max(interval_us * 1e-6, 0.005) : 0.0)
                 ? kResultAccepted
                 : kResultDenied;
    }
    case kCmdRequestMessage:
      return asking_link().SendNow(message_id, MakeReport()) ? kResultAccepted : kResultFailed;
    case kCmdRequestAutopilotCapabilities:
      asking_link().SendNow(AutopilotVersion::kId, MakeReport());
      return kResultAccepted;
    case kCmdGetHomePosition:
      return asking_link().SendNow(HomePosition::kId, MakeReport()) ? kResultAccepted : kResultFailed;
    case kCmdDoGimbalManagerConfigure:
      return kResultAccepted;
    case kCmdDoGimbalManagerPitchyaw:
      gimbal_.Point(Radians(request.param1), Radians(request.param2),
                    (ToWhole(request.x) & kGimbalYawLock) != 0);
      return kResultAccepted;
    case kCmdDoMountControl:  // Pitch, roll, yaw in degrees; mode 2 is "as told by MAVLink".
      if (request.z != 2.0) return kResultUnsupported;
      gimbal_.Point(Radians(request.param1), Radians(request.param3), false);
      return kResultAccepted;
    case kCmdPreflightRebootShutdown:
      if (is_armed_) return kResultFailed;
      if (request.param1 != 1.0) return kResultUnsupported;
      Reboot();
      return kResultAccepted;
    default:
      return kResultUnsupported;
  }
}

CommandResult Autopilot::ArmOrDisarm(const CommandRequest& request) {
  const bool is_forced = request.param2 == static_cast<double>(kForceArmDisarm);
  if (request.param1 == 0.0) {
    if (!is_landed_ && !is_forced) return RefuseToDisarm();
    Disarm();
    return kResultAccepted;
  }
  if (request.param1 != 1.0) return kResultUnsupported;
  if (is_armed_) return kResultAccepted;
  if (const std::string reason = is_forced ? "" : ReasonNotToArm(); !reason.empty()) {
    Announce(kSeverityCritical, reason);
    return Refusal();
  }
  is_armed_ = true;
  is_failsafe_ = false;
  armed_s_ = idle_since_s_ = boot_s_;
  if (frame_) SetHome(senses_.estimate.position_m);
  Enter(mode_);
  return kResultAccepted;
}

void Autopilot::Update() {
  if (!frame_ && has_gps_) Locate();
  limits_ = Limits();
  if (!is_armed_) {
    is_landed_ = senses_.is_on_ground;
    return;
  }
  CheckFailsafes();
  Fly();
  CheckLanded();
}

Report Autopilot::MakeReport() const {
  Report report;
  report.boot_s = boot_s_;
  report.utc_ns = senses_.utc_ns;
  report.estimate = senses_.estimate;
  report.frame = frame_ ? &*frame_ : nullptr;
  report.home_in_map_m = home_in_map_m_;
  report.has_gps = has_gps_;
  report.has_radio = has_radio_;
  report.battery_ratio = senses_.battery_ratio;
  report.gimbal_pitch_rad = gimbal_.pitch_rad();
  report.gimbal_yaw_from_nose_rad = gimbal_.yaw_from_nose_rad();
  report.gimbal_yaw_from_north_rad = gimbal_.yaw_from_north_rad();
  report.is_gimbal_yaw_against_north = gimbal_.is_yaw_against_north();
  Describe(report);
  return report;
}

MotorCommand Autopilot::Step(const Senses& senses, double dt_s) {
  senses_ = senses;
  boot_s_ += dt_s;
  Update();
  if (!is_armed_) goal_.kind = FlightGoal::Kind::kMotorsOff;
  MotorCommand command = control_.Step(goal_, limits_, senses_.estimate, dt_s);
  gimbal_.Step(senses_.estimate.map_from_body, dt_s);
  const bool is_timesync_due = boot_s_ >= next_timesync_s_;
  if (is_timesync_due) next_timesync_s_ += kTimesyncPeriod_s;
  const Report report = MakeReport();
  for (Telemetry& link : links_) {
    link.Step(report);
    if (is_timesync_due) link.Send(Timesync{0, BootNs(), 0, 0});
  }
  return command;
}

}  // namespace soffit::sim
