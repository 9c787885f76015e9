#include "vehicle_agent/autopilot/autopilot_client.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <utility>

#include "vehicle_agent/autopilot/status_text.h"
#include "vehicle_agent/mavlink/constants.h"

namespace soffit {
namespace {

using namespace mavlink;

constexpr double kAskModeEvery_s = 1.0;
constexpr double kModeLag_s = 2.0;  // Heartbeats come once a second.
constexpr double kAskArmEvery_s = 2.0;
constexpr double kAskTakeoffEvery_s = 5.0;
constexpr double kAskStreamEvery_s = 2.0;
constexpr double kHeartbeatEvery_s = 1.0;
constexpr double kTimesyncEvery_s = 1.0;
constexpr double kGimbalEvery_s = 1.0;
constexpr double kAskGimbalEvery_s = 5.0;
constexpr double kHomePatience_s = 5.0;
constexpr double kOffboardWarmup_s = 1.0;  // PX4 takes OFFBOARD only when setpoints have been coming.
constexpr double kComplaintLife_s = 40.0;  // ArduPilot repeats its PreArm texts every 30 s.
constexpr std::int64_t kLostGimbal_ns = 2'000'000'000;
constexpr std::uint32_t kRebootStep_ms = 1000;
constexpr std::uint16_t kNeededEstimate = kEstimatorAttitude | kEstimatorVelocityHorizontal |
                                          kEstimatorVelocityVertical | kEstimatorPositionHorizontalAbsolute |
                                          kEstimatorPositionVerticalAbsolute;
constexpr std::uint16_t kBadEstimate = kEstimatorConstantPosition | kEstimatorUninitialized;

bool IsDue(const Instant& last, double every_s, const Instant& now) {
  return last.steady_ns == 0 || SecondsBetween(last, now) >= every_s;
}

bool IsFresh(const Instant& last, double life_s, const Instant& now) {
  return last.steady_ns != 0 && SecondsBetween(last, now) < life_s;
}

Eigen::Quaterniond MakeQuaternion(double w, double x, double y, double z) {
  const Eigen::Quaterniond q(w, x, y, z);
  const double norm = q.norm();
  return norm > 0.5 && norm < 1.5 ? q.normalized() : Eigen::Quaterniond(0.0, 0.0, 0.0, 0.0);
}

bool IsRotation(const Eigen::Quaterniond& q) { return q.norm() > 0.5; }

/// By how much a standard deviation grows when the sensors contradict the estimator: a ratio of 1 is the gate
/// where they are rejected, usually 5 standard deviations; 2 are normal.
double Inflation(double innovation_ratio) {
  constexpr double kNormalRatio = 0.4;
  return std::max(1.0, innovation_ratio / kNormalRatio);
}

std::string DescribeResult(std::uint8_t result) {
  switch (result) {
    case kResultTemporarilyRejected:
      return "temporarily rejected";
    case kResultDenied:
      return "denied";
    case kResultUnsupported:
      return "unsupported";
    case kResultFailed:
      return "failed";
    default:
      return "result " + std::to_string(result);
  }
}

std::string Hex(std::uint16_t flags) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%x", static_cast<unsigned>(flags));
  return text;
}

/// The gimbal protocol before GIMBAL_MANAGER: degrees, and the mode "aimed over MAVLink".
CommandLong MakeMountControl(double pitch_rad, std::uint8_t target_system) {
  constexpr float kAimedOverMavlink = 2.0F;
  CommandLong command;
  command.command = kCmdDoMountControl;
  command.param1 = static_cast<float>(pitch_rad * 180.0 / std::numbers::pi);
  command.param7 = kAimedOverMavlink;
  command.target_system = target_system;
  return command;
}

/// None when there is no such place.
std::optional<GeodeticOrigin> MakeOrigin(std::int32_t lat_e7, std::int32_t lon_e7, std::int32_t alt_mm) {
  const GeodeticOrigin origin{lat_e7 * 1e-7, lon_e7 * 1e-7, alt_mm * 1e-3};
  if (std::abs(origin.latitude_deg) > 90.0 || std::abs(origin.longitude_deg) > 180.0) return std::nullopt;
  return origin;
}

/// The greatest of the ratios; beyond every limit when one of them is no number.
double Worst(std::initializer_list<float> ratios) {
  constexpr float kHopeless = 1000.0F;
  float worst = 0.0F;
  for (const float ratio : ratios) worst = std::max(worst, ratio < kHopeless ? ratio : kHopeless);
  return static_cast<double>(worst);
}

}  // namespace

AutopilotClient::AutopilotClient(const AutopilotOptions& options, bool has_gimbal)
    : options_(options),
      has_gimbal_(has_gimbal),
      encoder_(static_cast<std::uint8_t>(options.system_id == 0 ? 1 : options.system_id),
               static_cast<std::uint8_t>(options.component_id)) {}

// ---- What the autopilot tells ----

void AutopilotClient::Receive(const Frame& frame, Instant now) {
  if (frame.message_id == Heartbeat::kId && TakeHeartbeat(frame, now)) return;
  if (target_system_ == 0 || frame.system_id != target_system_) return;
  TakeFromGimbal(frame, now);
  if (frame.component_id == kComponentAutopilot) TakeFromAutopilot(frame, now);
}

bool AutopilotClient::TakeHeartbeat(const Frame& frame, Instant now) {
  const auto heartbeat = Decode<Heartbeat>(frame);
  if (!heartbeat || frame.component_id != kComponentAutopilot) return false;
  const Dialect dialect = DialectOf(heartbeat->autopilot);
  const bool is_wanted = options_.system_id == 0 || frame.system_id == options_.system_id;
  if (heartbeat->type == kTypeGcs || dialect == Dialect::kUnknown || frame.system_id == 0 || !is_wanted)
    return false;
  if (target_system_ == 0) {
    target_system_ = frame.system_id;
    encoder_ = Encoder(target_system_, static_cast<std::uint8_t>(options_.component_id));
    parameters_.Begin(dialect);
    Note("found " + std::string(ToString(dialect)) + ", system " + std::to_string(target_system_));
  }
  if (frame.system_id != target_system_) return true;
  if (dialect_ != dialect || heartbeat_.custom_mode != heartbeat->custom_mode) {
    Note("autopilot mode: " + DescribeMode(dialect, heartbeat->custom_mode));
  }
  dialect_ = dialect;
  heartbeat_ = *heartbeat;
  heartbeat_at_ = now;
  return true;
}

void AutopilotClient::TakeFromAutopilot(const Frame& frame, Instant now) {
  arrivals_[frame.message_id].Add(now.steady_ns);
  if (const auto m = Decode<LocalPositionNed>(frame)) return TakePosition(*m, now);
  if (const auto m = Decode<AttitudeQuaternion>(frame)) return TakeAttitude(*m, now);
  if (const auto m = Decode<Timesync>(frame)) return TakeTimesync(*m, now);
  if (const auto m = Decode<Statustext>(frame)) return TakeText(*m, now);
  if (const auto m = Decode<BatteryStatus>(frame)) return TakeBattery(m->battery_remaining);
  if (const auto m = Decode<ExtendedSysState>(frame)) {
    landed_state_ = m->landed_state;
  } else if (const auto gps = Decode<GpsRawInt>(frame)) {
    gps_fix_ = gps->fix_type;
  } else if (const auto status = Decode<SysStatus>(frame)) {
    TakeBattery(status->battery_remaining);
    const bool has_check = (status->onboard_control_sensors_present & kSensorPrearmCheck) != 0;
    passes_prearm_.reset();
    if (has_check) passes_prearm_ = (status->onboard_control_sensors_health & kSensorPrearmCheck) != 0;
  } else if (const auto ekf = Decode<EkfStatusReport>(frame)) {
    estimator_flags_ = ekf->flags;
    estimator_ratio_ = Worst({ekf->velocity_variance, ekf->pos_horiz_variance, ekf->pos_vert_variance});
    compass_ratio_ = Worst({ekf->compass_variance});
  } else if (const auto estimator = Decode<EstimatorStatus>(frame)) {
    estimator_flags_ = estimator->flags;
    estimator_ratio_ = Worst({estimator->vel_ratio, estimator->pos_horiz_ratio, estimator->pos_vert_ratio});
    compass_ratio_ = Worst({estimator->mag_ratio});
    estimator_accuracy_m_ = Worst({estimator->pos_horiz_accuracy, estimator->pos_vert_accuracy});
  } else if (const auto origin = Decode<GpsGlobalOrigin>(frame)) {
    const auto place = MakeOrigin(origin->latitude, origin->longitude, origin->altitude);
    if (place) frame_.SetLocalOrigin(*place);
  } else if (const auto home = Decode<HomePosition>(frame)) {
    if (const auto place = MakeOrigin(home->latitude, home->longitude, home->altitude))
      frame_.SetHome(*place);
  } else if (const auto parameter = Decode<ParamValue>(frame)) {
    parameters_.Take(*parameter);
  } else if (const auto ack = Decode<mavlink::CommandAck>(frame)) {
    const bool is_ours = ack->target_component == 0 || ack->target_component == options_.component_id;
    const auto ask = asks_.find(ack->command);
    if (is_ours && ask != asks_.end()) ask->second.result = ack->result;
  }
}

void AutopilotClient::TakeFromGimbal(const Frame& frame, Instant now) {
  Eigen::Quaterniond ned_from_gimbal(0.0, 0.0, 0.0, 0.0);
  std::uint32_t time_boot_ms = 0;
  const double vehicle_yaw_rad = SwapYaw(YawOf(map_from_body_));
  const auto turn = [](double angle_rad, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
  };
  if (const auto status = Decode<GimbalDeviceAttitudeStatus>(frame)) {
    constexpr std::uint16_t kYawInEarthFrame = 64;
    const auto& q = status->q;
    const bool is_in_earth = (status->flags & (kGimbalYawLock | kYawInEarthFrame)) != 0;
    ned_from_gimbal = MakeQuaternion(q[0], q[1], q[2], q[3]);
    if (!is_in_earth) ned_from_gimbal = turn(vehicle_yaw_rad, Eigen::Vector3d::UnitZ()) * ned_from_gimbal;
    time_boot_ms = status->time_boot_ms;
  } else if (const auto mount = Decode<MountOrientation>(frame)) {
    const double deg = std::numbers::pi / 180.0;
    ned_from_gimbal = turn(vehicle_yaw_rad + mount->yaw * deg, Eigen::Vector3d::UnitZ()) *
                      turn(mount->pitch * deg, Eigen::Vector3d::UnitY()) *
                      turn(mount->roll * deg, Eigen::Vector3d::UnitX());
    time_boot_ms = mount->time_boot_ms;
  } else {
    return;
  }
  if (!IsRotation(ned_from_gimbal)) return;
  if (frame.component_id != kComponentAutopilot) arrivals_[frame.message_id].Add(now.steady_ns);
  const Eigen::Quaterniond map_from_gimbal = MapFromBody(ned_from_gimbal);
  const Eigen::Vector3d view = map_from_gimbal * Eigen::Vector3d::UnitX();
  gimbal_pitch_rad_ = std::asin(std::clamp(view.z(), -1.0, 1.0));
  if (const auto utc_ns = clock_.ToUtc(std::int64_t{time_boot_ms} * 1'000'000)) {
    poses_.AddGimbal(*utc_ns, map_from_gimbal);
  }
}

std::optional<std::int64_t> AutopilotClient::StampOf(std::uint32_t time_boot_ms, Instant now) {
  if (time_boot_ms + kRebootStep_ms < newest_boot_ms_) ForgetAfterReboot();
  newest_boot_ms_ = std::max(newest_boot_ms_, time_boot_ms);
  const std::int64_t remote_ns = std::int64_t{time_boot_ms} * 1'000'000;
  clock_.AddArrival(remote_ns, now.utc_ns);
  return clock_.ToUtc(remote_ns);
}

void AutopilotClient::ForgetAfterReboot() {
  Note("the autopilot was restarted");
  newest_boot_ms_ = 0;
  clock_.Reset();
  poses_.Clear();
  frame_.ForgetLocalOrigin();
  arrivals_.clear();
  requests_.clear();
  asks_.clear();
  position_at_ = {};
  estimator_flags_ = 0;
  passes_prearm_.reset();
  has_asked_to_land_ = false;
  parameters_.Begin(dialect_);
  has_told_parameters_ = false;
}

void AutopilotClient::TakePosition(const LocalPositionNed& message, Instant now) {
  const Eigen::Vector3d position(message.x, message.y, message.z);
  const Eigen::Vector3d velocity(message.vx, message.vy, message.vz);
  if (!position.allFinite() || !velocity.allFinite()) return;
  const auto utc_ns = StampOf(message.time_boot_ms, now);
  position_ = message;
  position_at_ = now;
  if (utc_ns && frame_.IsKnown()) {
    poses_.AddPosition(*utc_ns,
                       frame_.ToMap(position) + Eigen::Vector3d(0.0, 0.0, options_.reference_height_m));
  }
}

void AutopilotClient::TakeAttitude(const AttitudeQuaternion& message, Instant now) {
  const Eigen::Quaterniond ned_from_frd = MakeQuaternion(message.q1, message.q2, message.q3, message.q4);
  const Eigen::Vector3d rates(message.rollspeed, message.pitchspeed, message.yawspeed);
  if (!IsRotation(ned_from_frd) || !rates.allFinite()) return;
  const auto utc_ns = StampOf(message.time_boot_ms, now);
  map_from_body_ = MapFromBody(ned_from_frd);
  rotation_rate_radps_ = rates.norm();
  attitude_at_ = now;
  if (!utc_ns) return;
  poses_.AddAttitude(*utc_ns, map_from_body_);
  poses_.AddRate(*utc_ns, rotation_rate_radps_);
}

void AutopilotClient::TakeBattery(std::int8_t percent) {
  battery_ratio_ = percent >= 0 && percent <= 100 ? percent / 100.0 : -1.0;
}

void AutopilotClient::TakeText(const Statustext& message, Instant now) {
  const std::string text = TextOf(message.text);
  if (text.empty()) return;
  Note("autopilot says: " + text);
  if (message.severity > kSeverityWarning) return;
  complaint_ = text;
  complaint_at_ = now;
}

void AutopilotClient::TakeTimesync(const Timesync& message, Instant now) {
  // An answer carries our own question; its ts1 is the UTC time at which it was asked.
  if (message.tc1 > 0 && message.ts1 == timesync_sent_.utc_ns) {
    clock_.AddExchange(message.ts1, message.tc1, now.utc_ns);
  }
}

// ---- What is known from it ----

bool AutopilotClient::IsConnected(Instant now) const {
  return IsFresh(heartbeat_at_, options_.heartbeat_timeout_s, now);
}

bool AutopilotClient::HasPosition(Instant now) const {
  return frame_.IsKnown() && IsFresh(position_at_, options_.position_timeout_s, now) &&
         IsFresh(attitude_at_, options_.position_timeout_s, now);
}

bool AutopilotClient::HasEstimate() const {
  return (estimator_flags_ & kNeededEstimate) == kNeededEstimate && (estimator_flags_ & kBadEstimate) == 0;
}

bool AutopilotClient::TrustsPoses(Instant now) const {
  return HasPosition(now) && HasEstimate() && estimator_ratio_ <= options_.max_estimator_ratio &&
         estimator_accuracy_m_ <= options_.max_position_error_m && clock_.Uncertainty_ns().has_value();
}

std::optional<double> AutopilotClient::ClockUncertainty_s() const {
  const auto ns = clock_.Uncertainty_ns();
  if (!ns) return std::nullopt;
  return ToSeconds(*ns);
}

std::string AutopilotClient::LastComplaint(Instant now) const {
  return IsFresh(complaint_at_, kComplaintLife_s, now) ? complaint_ : "";
}

std::string AutopilotClient::FindEstimateProblem() const {
  if (gps_fix_ < kGps3dFix) return "the GPS has no 3D fix";
  if (!HasEstimate()) return "the autopilot's estimator is not well (flags " + Hex(estimator_flags_) + ")";
  return {};
}

std::string AutopilotClient::FindReadinessProblem(Instant now) const {
  if (target_system_ == 0) return "no autopilot was heard";
  if (!IsConnected(now)) return "the autopilot is silent";
  if (const std::string problem = FindEstimateProblem(); !problem.empty()) return problem;
  if (!frame_.HasLocalOrigin()) return "waiting for the estimator's origin";
  if (!frame_.origin()) return "waiting for the home position";
  if (!HasPosition(now)) return "waiting for the position";
  if (passes_prearm_ == false) {
    const std::string complaint = LastComplaint(now);
    return "the autopilot's arming checks do not pass" + (complaint.empty() ? "" : ": " + complaint);
  }
  return {};
}

Telemetry AutopilotClient::Report(Instant now) const {
  Telemetry telemetry;
  telemetry.is_connected = IsConnected(now);
  telemetry.autopilot = ToString(dialect_);
  telemetry.not_ready = FindReadinessProblem(now);
  if (!telemetry.is_connected) return telemetry;
  const std::uint32_t mode = heartbeat_.custom_mode;
  telemetry.mode = DescribeMode(dialect_, mode);
  telemetry.is_in_our_mode =
      IsCommandMode(dialect_, mode) || (has_asked_to_land_ && IsLandMode(dialect_, mode));
  telemetry.is_in_failsafe = heartbeat_.system_status >= kStateCritical;
  telemetry.is_armed = (heartbeat_.base_mode & kModeFlagSafetyArmed) != 0;
  telemetry.is_in_air = landed_state_ >= kLandedInAir;
  telemetry.intent_problem = intent_problem_;
  telemetry.battery_ratio = battery_ratio_;
  telemetry.position_doubt = FindEstimateProblem();
  telemetry.origin = frame_.origin();
  const bool has_gimbal = std::any_of(arrivals_.begin(), arrivals_.end(), [&](const auto& arrival) {
    return (arrival.first == GimbalDeviceAttitudeStatus::kId || arrival.first == MountOrientation::kId) &&
           now.steady_ns - arrival.second.newest_ns() < kLostGimbal_ns;
  });
  if (has_gimbal) telemetry.gimbal_pitch_rad = gimbal_pitch_rad_;
  telemetry.has_position = HasPosition(now);
  if (!telemetry.has_position) return telemetry;
  telemetry.position_in_map_m = frame_.ToMap(Eigen::Vector3d(position_.x, position_.y, position_.z)) +
                                Eigen::Vector3d(0.0, 0.0, options_.reference_height_m);
  telemetry.velocity_in_map_mps = SwapEnuNed(Eigen::Vector3d(position_.vx, position_.vy, position_.vz));
  telemetry.map_from_body = map_from_body_;
  telemetry.yaw_rad = YawOf(map_from_body_);
  telemetry.rotation_rate_radps = rotation_rate_radps_;
  telemetry.position_std_m = options_.position_std_m * Inflation(estimator_ratio_);
  telemetry.orientation_std_rad = options_.orientation_std_rad * Inflation(compass_ratio_);
  return telemetry;
}

std::vector<std::string> AutopilotClient::TakeNotes() { return std::exchange(notes_, {}); }

// ---- What is asked of it ----

std::vector<std::vector<std::uint8_t>> AutopilotClient::Pursue(const Intent& intent, Instant now) {
  outbox_ = std::exchange(announcing_, {});
  KeepContact(now);
  if (intent.order != order_) setpoint_sent_ = {};  // Said at once.
  order_ = intent.order;
  if (intent.kind != pursued_) {
    pursued_ = intent.kind;
    pursued_since_ = now;
    intent_problem_.clear();
    asks_.clear();
  }
  if (IsConnected(now)) {
    AskForMessages(now);
    AskForParameters(now);
    SetMissingHome(now);
  }
  if (target_system_ != 0) {  // Also when it is silent: it may hear us.
    switch (intent.kind) {
      case Intent::Kind::kNone:
        PursueNone(now);
        break;
      case Intent::Kind::kTakeOff:
        PursueTakeOff(intent, now);
        break;
      case Intent::Kind::kFlyTo:
        PursueFlyTo(intent, now);
        break;
      case Intent::Kind::kLand:
        PursueLand(now);
        break;
    }
    AimGimbal(intent, now);
  }
  return std::move(outbox_);
}

void AutopilotClient::KeepContact(Instant now) {
  if (IsDue(heartbeat_sent_, kHeartbeatEvery_s, now)) {
    heartbeat_sent_ = now;
    Heartbeat heartbeat;
    heartbeat.type = kTypeOnboardController;
    heartbeat.autopilot = kAutopilotInvalid;
    heartbeat.system_status = kStateActive;
    heartbeat.mavlink_version = 3;
    Send(heartbeat);
  }
  if (IsConnected(now) && IsDue(timesync_sent_, kTimesyncEvery_s, now)) {
    timesync_sent_ = now;
    Timesync question;
    question.ts1 = now.utc_ns;
    question.target_system = target_system_;
    question.target_component = kComponentAutopilot;
    Send(question);
  }
}

bool AutopilotClient::HasComeOnce(std::uint32_t message_id) const {
  const auto found = arrivals_.find(message_id);
  return found != arrivals_.end() && !found->second.IsEmpty();
}

std::vector<AutopilotClient::WantedMessage> AutopilotClient::ListWantedMessages() const {
  std::vector<WantedMessage> wanted = {
      {LocalPositionNed::kId, options_.pose_rate_hz},
      {AttitudeQuaternion::kId, options_.pose_rate_hz},
      {SysStatus::kId, 2.0},
      {GpsRawInt::kId, 2.0},
      {ExtendedSysState::kId, 4.0},
      {HomePosition::kId, 0.0},
      {GpsGlobalOrigin::kId, 0.0},
      {dialect_ == Dialect::kPx4 ? EstimatorStatus::kId : EkfStatusReport::kId, 2.0},
  };
  // A gimbal speaks the new protocol or the old one; both are asked for until one is heard.
  const bool is_new = HasComeOnce(GimbalDeviceAttitudeStatus::kId);
  const bool is_old = HasComeOnce(MountOrientation::kId);
  if (has_gimbal_ && (is_new || !is_old)) {
    wanted.push_back({GimbalDeviceAttitudeStatus::kId, options_.pose_rate_hz});
  }
  if (has_gimbal_ && !is_new) wanted.push_back({MountOrientation::kId, options_.pose_rate_hz});
  return wanted;
}

void AutopilotClient::AskForMessages(Instant now) {
  for (const WantedMessage& wanted : ListWantedMessages()) {
    const bool is_single = wanted.rate_hz == 0.0;
    const Arrivals& arrivals = arrivals_[wanted.id];
    const bool is_coming =
        is_single ? !arrivals.IsEmpty() : arrivals.KeepUpWith(wanted.rate_hz, now.steady_ns);
    if (is_coming) continue;
    Instant& asked = requests_[wanted.id];
    if (!IsDue(asked, kAskStreamEvery_s, now)) continue;
    asked = now;
    CommandLong request;
    request.command = is_single ? kCmdRequestMessage : kCmdSetMessageInterval;
    request.param1 = static_cast<float>(wanted.id);
    if (!is_single) request.param2 = static_cast<float>(1e6 / wanted.rate_hz);
    request.target_system = target_system_;
    request.target_component = kComponentAutopilot;
    Send(request);
  }
}

void AutopilotClient::AskForParameters(Instant now) {
  if (const auto name = parameters_.FindNextToAsk(now)) {
    ParamRequestRead request;
    request.param_index = -1;
    request.target_system = target_system_;
    request.target_component = kComponentAutopilot;
    request.param_id = ToTextField<16>(*name);
    Send(request);
  }
  if (has_told_parameters_ || !parameters_.IsDone()) return;
  has_told_parameters_ = true;
  for (const std::string& problem : ListUnsafeParameters())
    Note("unsafe parameter of the autopilot: " + problem);
}

/// Autopilots set home by themselves, as a rule; without it there is no map.
void AutopilotClient::SetMissingHome(Instant now) {
  const bool is_armed = (heartbeat_.base_mode & kModeFlagSafetyArmed) != 0;
  const bool is_missing = HasEstimate() && frame_.HasLocalOrigin() && !frame_.origin() && !is_armed;
  if (!is_missing) home_missing_since_ = now;
  if (SecondsBetween(home_missing_since_, now) < kHomePatience_s) return;
  home_missing_since_ = now;
  Note("the autopilot has no home: setting it to where the vehicle is");
  CommandLong set_home;
  set_home.command = kCmdDoSetHome;
  set_home.param1 = 1.0F;  // Here.
  set_home.target_system = target_system_;
  set_home.target_component = kComponentAutopilot;
  Send(set_home);
}

void AutopilotClient::Announce(const std::string& text) {
  ++announcements_;
  if (announcements_ == 0) ++announcements_;
  for (const Statustext& part : MakeStatusTexts("Soffit: " + text, kSeverityNotice, announcements_)) {
    announcing_.push_back(encoder_.Encode(part));
  }
}

void AutopilotClient::SendCommand(CommandLong command, double every_s, Instant now) {
  Ask& ask = asks_[command.command];
  if (ask.was_sent && SecondsBetween(ask.sent, now) < every_s) return;
  ask.sent = now;
  ask.was_sent = true;
  command.target_system = target_system_;
  command.target_component = kComponentAutopilot;
  Send(command);
}

void AutopilotClient::PursueNone(Instant now) {
  // After a landing ArduPilot refuses to arm until it is told to leave LAND.
  const bool is_armed = (heartbeat_.base_mode & kModeFlagSafetyArmed) != 0;
  if (!has_asked_to_land_ || is_armed) return;
  if (dialect_ == Dialect::kArduPilot && IsLandMode(dialect_, heartbeat_.custom_mode)) {
    SendCommand(MakeEnterCommandMode(dialect_), kAskModeEvery_s, now);
  } else {
    has_asked_to_land_ = false;
  }
}

void AutopilotClient::PursueTakeOff(const Intent& intent, Instant now) {
  const bool is_armed = (heartbeat_.base_mode & kModeFlagSafetyArmed) != 0;
  const bool is_px4 = dialect_ == Dialect::kPx4;
  if (is_px4) {
    SendSetpoint(intent.position_in_map_m, intent.yaw_rad, now);
    if (SecondsBetween(pursued_since_, now) < kOffboardWarmup_s) return;
  }
  if (!is_armed && SecondsBetween(pursued_since_, now) > options_.arm_timeout_s) {
    const auto ask = asks_.find(kCmdComponentArmDisarm);
    const std::string complaint = LastComplaint(now);
    intent_problem_ = "the autopilot does not arm";
    if (ask == asks_.end()) {
      intent_problem_ = "the autopilot does not enter its command mode";
    } else if (ask->second.result && *ask->second.result != kResultAccepted) {
      intent_problem_ += " (" + DescribeResult(*ask->second.result) + ")";
    }
    if (!complaint.empty()) intent_problem_ += ": " + complaint;
    return;
  }
  if (!IsCommandMode(dialect_, heartbeat_.custom_mode)) {
    if (!is_armed) SendCommand(MakeEnterCommandMode(dialect_), kAskModeEvery_s, now);
    return;
  }
  if (!is_armed) {
    CommandLong arm;
    arm.command = kCmdComponentArmDisarm;
    arm.param1 = 1.0F;
    return SendCommand(arm, kAskArmEvery_s, now);
  }
  has_asked_to_land_ = false;
  if (is_px4 || landed_state_ >= kLandedInAir) return;
  CommandLong takeoff;
  takeoff.command = kCmdNavTakeoff;
  takeoff.param7 =
      static_cast<float>(intent.position_in_map_m.z() - options_.reference_height_m - frame_.home_height_m());
  const auto ask = asks_.find(kCmdNavTakeoff);
  const bool was_refused = ask != asks_.end() && ask->second.result && *ask->second.result != kResultAccepted;
  SendCommand(takeoff, was_refused ? kAskModeEvery_s : kAskTakeoffEvery_s, now);
}

void AutopilotClient::PursueFlyTo(const Intent& intent, Instant now) {
  if (IsCommandMode(dialect_, heartbeat_.custom_mode)) {
    // A heartbeat may still tell the mode from before a landing was asked for.
    if (SecondsBetween(pursued_since_, now) > kModeLag_s) has_asked_to_land_ = false;
  } else if (has_asked_to_land_ && IsLandMode(dialect_, heartbeat_.custom_mode) &&
             heartbeat_.system_status < kStateCritical) {
    SendCommand(MakeEnterCommandMode(dialect_), kAskModeEvery_s, now);  // Our own landing is broken off.
    if (dialect_ != Dialect::kPx4) return;
  } else {
    return;
  }
  SendSetpoint(intent.position_in_map_m, intent.yaw_rad, now);
}

void AutopilotClient::PursueLand(Instant now) {
  has_asked_to_land_ = true;
  if (!IsLandMode(dialect_, heartbeat_.custom_mode)) SendCommand(MakeLand(dialect_), kAskModeEvery_s, now);
}

void AutopilotClient::SendSetpoint(const Eigen::Vector3d& in_map_m, double yaw_rad, Instant now) {
  const double tolerance_s = 0.005;  // Of a caller whose beat is as long as the setpoints'.
  if (!frame_.IsKnown() || !IsDue(setpoint_sent_, 1.0 / options_.setpoint_rate_hz - tolerance_s, now)) return;
  setpoint_sent_ = now;
  const Eigen::Vector3d ned =
      frame_.ToLocalNed(in_map_m - Eigen::Vector3d(0.0, 0.0, options_.reference_height_m));
  SetPositionTargetLocalNed target;
  target.time_boot_ms = newest_boot_ms_;
  target.x = static_cast<float>(ned.x());
  target.y = static_cast<float>(ned.y());
  target.z = static_cast<float>(ned.z());
  target.yaw = static_cast<float>(SwapYaw(yaw_rad));
  target.type_mask = kPositionAndYaw;
  target.coordinate_frame = kFrameLocalNed;
  target.target_system = target_system_;
  target.target_component = kComponentAutopilot;
  Send(target);
}

void AutopilotClient::AimGimbal(const Intent& intent, Instant now) {
  if (!has_gimbal_ || !intent.camera_pitch_rad || intent.kind == Intent::Kind::kNone) return;
  const bool is_new = gimbal_wanted_rad_ != intent.camera_pitch_rad;
  if (!is_new && !IsDue(gimbal_sent_, kGimbalEvery_s, now)) return;
  gimbal_wanted_rad_ = intent.camera_pitch_rad;
  gimbal_sent_ = now;
  if (HasComeOnce(MountOrientation::kId) && !HasComeOnce(GimbalDeviceAttitudeStatus::kId)) {
    Send(MakeMountControl(*intent.camera_pitch_rad, target_system_));
    return;
  }
  const auto control = asks_.find(kCmdDoGimbalManagerConfigure);
  if (control == asks_.end() || !control->second.result) {  // Whoever aims has to be in control of it.
    CommandLong configure;
    configure.command = kCmdDoGimbalManagerConfigure;
    configure.param1 = static_cast<float>(target_system_);
    configure.param2 = static_cast<float>(options_.component_id);
    configure.param3 = configure.param4 = -1.0F;  // The second in control: as it is.
    SendCommand(configure, kAskGimbalEvery_s, now);
  }
  GimbalManagerSetPitchyaw aim;
  aim.flags = kGimbalRollLock | kGimbalPitchLock;
  aim.pitch = static_cast<float>(*intent.camera_pitch_rad);
  aim.yaw = 0.0F;
  aim.pitch_rate = std::numeric_limits<float>::quiet_NaN();
  aim.yaw_rate = std::numeric_limits<float>::quiet_NaN();
  aim.target_system = target_system_;
  Send(aim);
}

}  // namespace soffit
