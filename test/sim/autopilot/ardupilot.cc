/// ArduPilot Copter 4.5 as a companion computer meets it: measured on the real program, on loopback.
#include <algorithm>
#include <array>
#include <cmath>

#include "test/sim/autopilot/autopilot.h"

namespace soffit::sim {
namespace {

using namespace mavlink;

// Seconds after a cold start; a quick start takes 3/41 of them.
constexpr double kGpsFound_s = 10.0;
constexpr double kOriginSet_s = 20.0;
constexpr double kReady_s = 41.0;
constexpr double kQuickStartRatio = 3.0 / 41.0;
constexpr double kPrearmLag_s = 0.2;
// The EKF's origin is a few centimetres beside home in height.
const Eigen::Vector3d kOriginInMap_m(0.0, 0.0, 0.03);

constexpr double kSpoolUp_s = 4.0;
constexpr double kTouchdownTime_s = 1.0;
constexpr double kArrived_m = 0.1;
constexpr double kFarFromHome_m = 2.0;
constexpr double kLookAhead_m = 2.0;
constexpr double kBrakeDeceleration_mps2 = 1.3;
constexpr double kThrottleDownDescent_mps = 2.5;
constexpr double kGpsFlagsLost_s = 7.0;
constexpr double kGpsFailsafe_s = 7.5;
constexpr double kRadioFailsafe_s = 0.4;
constexpr double kBatteryFailsafe_s = 10.0;

constexpr std::uint16_t kFlagsBooting = 0x400;
constexpr std::uint16_t kFlagsNoGps = 0x0a7;
constexpr std::uint16_t kFlagsReady = 0x33f;
constexpr std::uint16_t kFlagsGpsLost = 0x025;

struct ModeTraits {
  CopterMode mode;
  const char* name;
  bool needs_position;
  bool can_arm;
};
constexpr std::array<ModeTraits, 8> kModes = {{{kCopterStabilize, "STABILIZE", false, true},
                                               {kCopterAltHold, "ALT_HOLD", false, true},
                                               {kCopterGuided, "GUIDED", true, true},
                                               {kCopterLoiter, "LOITER", true, true},
                                               {kCopterRtl, "RTL", true, false},
                                               {kCopterLand, "LAND", false, false},
                                               {kCopterPosHold, "POSHOLD", true, true},
                                               {kCopterBrake, "BRAKE", true, false}}};

const ModeTraits* FindMode(double number) {
  const auto found = std::find_if(kModes.begin(), kModes.end(), [&](const ModeTraits& traits) {
    return static_cast<double>(traits.mode) == number;
  });
  return found == kModes.end() ? nullptr : &*found;
}

std::map<std::string, double> DefaultParameters() {
  return {{"ARMING_CHECK", 1},     {"BATT_FS_LOW_ACT", 2}, {"BATT_LOW_RATIO", 0.15}, {"DISARM_DELAY", 10},
          {"FENCE_ENABLE", 0},     {"FS_EKF_ACTION", 1},   {"FS_GCS_ENABLE", 0},     {"FS_GCS_TIMEOUT", 5},
          {"FS_THR_ENABLE", 1},    {"GUID_OPTIONS", 0},    {"GUID_TIMEOUT", 3},      {"LAND_SPEED", 50},
          {"LAND_SPEED_HIGH", 0},  {"RTL_ALT", 1500},      {"RTL_LOIT_TIME", 5000},  {"SYSID_MYGCS", 255},
          {"SYSID_THISMAV", 1},    {"WPNAV_ACCEL", 250},   {"WPNAV_SPEED", 1000},    {"WPNAV_SPEED_DN", 150},
          {"WPNAV_SPEED_UP", 250}, {"WP_YAW_BEHAVIOR", 2}};
}

class ArduPilot final : public Autopilot {
 public:
  explicit ArduPilot(const AutopilotOptions& options) : Autopilot(options, DefaultParameters()) { Boot(); }

  std::string ModeName() const override { return FindMode(static_cast<double>(mode_))->name; }

  bool PilotSelects(const std::string& mode) override {
    const auto found = std::find_if(kModes.begin(), kModes.end(),
                                    [&](const ModeTraits& traits) { return traits.name == mode; });
    if (found == kModes.end()) return false;
    SetRadio(true);
    Enter(found->mode);
    return true;
  }

 protected:
  void Boot() override {
    speed_mps_ = parameters_["WPNAV_SPEED"] * 0.01;
    is_failsafe_ = false;
    has_announced_battery_ = false;
    battery_low_since_s_.reset();
    SetIntervalOnAllLinks(Heartbeat::kId, 1.0);
    Enter(kCopterStabilize);
    Announce(kSeverityInfo, "ArduCopter V4.5.6 (simulated by Soffit)");
  }

  CommandResult Execute(const CommandRequest& request) override {
    switch (request.command) {
      case kCmdDoSetMode:
        return SelectMode(request);
      case kCmdComponentArmDisarm:
        return ArmOrDisarm(request);
      case kCmdNavTakeoff:
        return TakeOff(request);
      case kCmdNavLand:
        return SelectMode(kCopterLand);
      case kCmdNavReturnToLaunch:
        return SelectMode(kCopterRtl);
      case kCmdConditionYaw:
        return TurnTo(request);
      case kCmdDoChangeSpeed:
        if (!(request.param2 > 0.0)) return kResultFailed;
        speed_mps_ = request.param2;
        return kResultAccepted;
      case kCmdDoSetHome:
        if (!frame_ || request.param1 != 1.0) return kResultFailed;
        SetHome(senses_.estimate.position_m);
        return kResultAccepted;
      default:
        return ExecuteCommon(request);
    }
  }

  void TakeSetpoint(const SetPositionTargetLocalNed& m) override {
    if (mode_ != kCopterGuided || !is_armed_ || !frame_) return;
    const bool has_position = (m.type_mask & kIgnorePosition) == 0;
    const bool has_velocity = (m.type_mask & kIgnoreVelocity) == 0;
    const bool has_acceleration = (m.type_mask & kIgnoreAcceleration) == 0;
    const bool is_frame_known =
        m.coordinate_frame == kFrameLocalNed || m.coordinate_frame == kFrameLocalOffsetNed ||
        m.coordinate_frame == kFrameBodyNed || m.coordinate_frame == kFrameBodyOffsetNed;
    const bool has_yaw = (m.type_mask & kIgnoreYaw) == 0;
    const bool is_finite = (!has_position || std::isfinite(m.x + m.y + m.z)) &&
                           (!has_velocity || std::isfinite(m.vx + m.vy + m.vz)) &&
                           (!has_yaw || std::isfinite(m.yaw));
    if (!is_frame_known || !is_finite || has_acceleration || (!has_position && !has_velocity)) return Hold();
    if (is_landed_ && guided_ != Guided::kTakeoff) return;  // Only a takeoff leaves the ground.

    const bool is_body = m.coordinate_frame == kFrameBodyNed || m.coordinate_frame == kFrameBodyOffsetNed;
    const double yaw_rad = YawOf(senses_.estimate.map_from_body);
    const Eigen::AngleAxisd from_nose(is_body ? yaw_rad - 0.5 * M_PI : 0.0, Eigen::Vector3d::UnitZ());
    guided_ = has_position ? Guided::kPosition : Guided::kVelocity;
    setpoint_s_ = boot_s_;
    if (has_position) {
      const Eigen::Vector3d sent(m.x, m.y, m.z);
      const bool is_offset = m.coordinate_frame != kFrameLocalNed;
      target_m_ = is_offset
                      ? Eigen::Vector3d(senses_.estimate.position_m + from_nose * NedFrame::SwapVector(sent))
                      : frame_->ToMap(sent);
    }
    velocity_mps_.setZero();
    if (has_velocity) velocity_mps_ = from_nose * NedFrame::SwapVector(Eigen::Vector3d(m.vx, m.vy, m.vz));
    if (has_yaw) {
      yaw_rad_ = is_body ? WrapAngle(yaw_rad - static_cast<double>(m.yaw))
                         : NedFrame::SwapYaw(static_cast<double>(m.yaw));
    } else if (has_position) {
      const Eigen::Vector2d way_m = (target_m_ - senses_.estimate.position_m).head<2>();
      if (way_m.norm() > kLookAhead_m) yaw_rad_ = std::atan2(way_m.y(), way_m.x());
    }
  }

  void TakeHeartbeat(const Frame& frame) override {
    if (frame.system_id == static_cast<std::uint8_t>(parameters_["SYSID_MYGCS"]))
      last_heartbeat_of_gcs_s_ = boot_s_;
  }

  void SetDataStream(const RequestDataStream& request) override {
    const bool is_on = request.start_stop != 0 && request.req_message_rate > 0;
    const double interval_s = is_on ? 1.0 / request.req_message_rate : 0.0;
    const auto set = [&](std::uint8_t stream, std::initializer_list<std::uint32_t> ids) {
      if (request.req_stream_id != stream && request.req_stream_id != kStreamAll) return;
      for (const std::uint32_t id : ids) asking_link().SetInterval(id, interval_s);
    };
    set(kStreamExtendedStatus, {SysStatus::kId, GpsRawInt::kId, PositionTargetLocalNed::kId});
    set(kStreamRcChannels, {RcChannels::kId});
    set(kStreamPosition, {GlobalPositionInt::kId, LocalPositionNed::kId});
    set(kStreamExtra1, {Attitude::kId});
    set(kStreamExtra3,
        {SystemTime::kId, BatteryStatus::kId, EkfStatusReport::kId, GimbalDeviceAttitudeStatus::kId});
  }

  void Update(double) override {
    if (!frame_ && boot_s_ >= Start(kOriginSet_s) && has_gps_) {
      SetOrigin(kOriginInMap_m);
      Announce(kSeverityInfo, "EKF3 IMU0 origin set");
      SetHome(Eigen::Vector3d::Zero());
    }
    limits_ = {speed_mps_,
               parameters_["WPNAV_SPEED_UP"] * 0.01,
               parameters_["WPNAV_SPEED_DN"] * 0.01,
               parameters_["WPNAV_ACCEL"] * 0.01,
               FlightLimits{}.vertical_acceleration_mps2,
               FlightLimits{}.yaw_rate_radps};
    if (!is_armed_) {
      is_landed_ = senses_.is_on_ground;
      return;
    }
    CheckFailsafes();
    Fly();
    CheckLanded();
  }

  void Describe(Report& report) const override {
    report.autopilot = kAutopilotArduPilot;
    report.base_mode = static_cast<std::uint8_t>(
        kModeFlagCustomModeEnabled | kModeFlagStabilizeEnabled | kModeFlagManualInputEnabled |
        (mode_ == kCopterGuided ? kModeFlagGuidedEnabled : 0) | (is_armed_ ? kModeFlagSafetyArmed : 0));
    report.custom_mode = mode_;
    report.system_status = is_failsafe_               ? kStateCritical
                           : is_armed_ && !is_landed_ ? kStateActive
                                                      : kStateStandby;
    report.landed_state = LandedState();
    report.has_gps = has_gps_ && boot_s_ >= Start(kGpsFound_s);
    report.has_position = HasPosition();
    report.is_ready_to_arm = boot_s_ >= Start(kReady_s) + kPrearmLag_s && HasPosition();
    report.estimator_flags = EstimatorFlags();
    report.battery_charge_state = battery_low_since_s_ ? kBatteryLow : kBatteryOk;
    report.throttle_ratio = has_radio_ ? 0.5 : 0.0;
    if (mode_ == kCopterGuided && guided_ == Guided::kPosition && is_armed_)
      report.target_in_map_m = target_m_;
  }

 private:
  enum class Guided { kHold, kTakeoff, kPosition, kVelocity };
  enum class Return { kClimb, kFly, kWait, kLand };

  double Start(double cold_s) const { return options_.is_quick_start ? kQuickStartRatio * cold_s : cold_s; }

  bool HasPosition() const { return EstimatorFlags() == kFlagsReady; }

  std::uint16_t EstimatorFlags() const {
    if (boot_s_ < Start(0.8 * kGpsFound_s)) return kFlagsBooting;
    if (boot_s_ < Start(kGpsFound_s)) return 0;
    if (boot_s_ < Start(kReady_s) || !frame_) return kFlagsNoGps;
    return !has_gps_ && SecondsSince(gps_changed_s_) > kGpsFlagsLost_s ? kFlagsGpsLost : kFlagsReady;
  }

  std::uint8_t LandedState() const {
    if (is_landed_) return kLandedOnGround;
    if (mode_ == kCopterGuided && guided_ == Guided::kTakeoff) return kLandedTakeoff;
    const bool is_landing = mode_ == kCopterLand || (mode_ == kCopterRtl && return_ == Return::kLand);
    return is_landing ? kLandedLanding : kLandedInAir;
  }

  // Commands.

  CommandResult SelectMode(const CommandRequest& request) {
    if (request.param1 < 1.0) return kResultUnsupported;
    const ModeTraits* traits = FindMode(request.param2);
    if (traits == nullptr) {
      Announce(kSeverityWarning, "No such mode");
      return kResultFailed;
    }
    return SelectMode(traits->mode);
  }

  CommandResult SelectMode(CopterMode mode) {
    const ModeTraits* traits = FindMode(static_cast<double>(mode));
    if (is_armed_ && traits->needs_position && !HasPosition()) {
      Announce(kSeverityWarning,
               std::string("Mode change to ") + traits->name + " failed: requires position");
      return kResultFailed;
    }
    if (mode != mode_) Enter(mode);
    return kResultAccepted;
  }

  CommandResult ArmOrDisarm(const CommandRequest& request) {
    const bool is_forced = request.param2 == static_cast<double>(kForceArmDisarm);
    if (request.param1 == 0.0) {
      if (!is_landed_ && !is_forced) return kResultFailed;
      Disarm();
      return kResultAccepted;
    }
    if (request.param1 != 1.0) return kResultUnsupported;
    if (is_armed_) return kResultAccepted;
    if (const char* reason = is_forced ? nullptr : ReasonNotToArm()) {
      Announce(kSeverityCritical, std::string("Arm: ") + reason);
      return kResultFailed;
    }
    Announce(kSeverityInfo, "Arming motors");
    is_armed_ = true;
    is_failsafe_ = false;
    idle_since_s_ = boot_s_;
    if (frame_) SetHome(senses_.estimate.position_m);
    Enter(mode_);
    return kResultAccepted;
  }

  const char* ReasonNotToArm() const {
    const ModeTraits* traits = FindMode(static_cast<double>(mode_));
    if (!traits->can_arm) return "Mode not armable";
    if (traits->needs_position && !HasPosition()) return "Need Position Estimate";
    if (senses_.battery_ratio < parameters_["BATT_LOW_RATIO"])
      return "Battery 1 below minimum arming capacity";
    if (!has_radio_ && mode_ != kCopterGuided) return "RC not found";
    return nullptr;
  }

  CommandResult TakeOff(const CommandRequest& request) {
    if (mode_ != kCopterGuided || !is_armed_ || !is_landed_ || !(request.z > 0.0) || !home_in_map_m_ ||
        guided_ == Guided::kTakeoff) {
      return kResultFailed;
    }
    guided_ = Guided::kTakeoff;
    setpoint_s_ = boot_s_;
    target_m_ = senses_.estimate.position_m;
    target_m_.z() = home_in_map_m_->z() + request.z;
    return kResultAccepted;
  }

  CommandResult TurnTo(const CommandRequest& request) {
    if (mode_ != kCopterGuided || !is_armed_ || is_landed_ || !std::isfinite(request.param1))
      return kResultFailed;
    const double angle_rad = request.param1 * M_PI / 180.0;
    const double direction = request.param3 < 0.0 ? 1.0 : -1.0;  // Clockwise is negative in the map.
    yaw_rad_ =
        request.param4 != 0.0 ? WrapAngle(yaw_rad_ + direction * angle_rad) : NedFrame::SwapYaw(angle_rad);
    return kResultAccepted;
  }

  // Modes.

  void Enter(CopterMode mode) {
    mode_ = mode;
    Hold();
    if (mode == kCopterRtl && home_in_map_m_) {
      return_ = Return::kClimb;
      const Eigen::Vector3d& here_m = senses_.estimate.position_m;
      const double away_m = (here_m - *home_in_map_m_).head<2>().norm();
      const double height_m = home_in_map_m_->z() + parameters_["RTL_ALT"] * 0.01;
      target_m_ = here_m;
      if (away_m > kFarFromHome_m) target_m_.z() = std::max(here_m.z(), height_m);
    }
  }

  void Hold() {
    guided_ = Guided::kHold;
    target_m_ = StoppingPoint();
    velocity_mps_.setZero();
    yaw_rad_ = YawOf(senses_.estimate.map_from_body);
  }

  void FlyTo(const Eigen::Vector3d& position_m) {
    goal_ = {FlightGoal::Kind::kPosition, position_m, Eigen::Vector3d::Zero(), yaw_rad_};
  }
  void FlyAt(const Eigen::Vector3d& velocity_mps) {
    goal_ = {FlightGoal::Kind::kVelocity, Eigen::Vector3d::Zero(), velocity_mps, yaw_rad_};
  }
  /// Straight down over `target_m_`.
  void Sink(double speed_mps) {
    FlyTo({target_m_.x(), target_m_.y(), control_.path_position_m().z()});
    goal_.velocity_mps.z() = -speed_mps;
  }

  void Fly() {
    const bool is_taking_off = mode_ == kCopterGuided && guided_ == Guided::kTakeoff;
    if (is_landed_ && !(is_taking_off && SecondsSince(setpoint_s_) >= kSpoolUp_s)) {
      goal_.kind = FlightGoal::Kind::kIdle;
      return;
    }
    switch (mode_) {
      case kCopterGuided:
        return FlyGuided();
      case kCopterRtl:
        return FlyHome();
      case kCopterLand:
        return Sink(parameters_["LAND_SPEED"] * 0.01);
      case kCopterBrake:
        limits_.acceleration_mps2 = kBrakeDeceleration_mps2;
        return FlyAt(Eigen::Vector3d::Zero());
      case kCopterStabilize:
        if (has_radio_) return FlyTo(target_m_);
        goal_.kind = FlightGoal::Kind::kIdle;  // The stick is at the bottom, and so are the motors.
        return;
      default:
        if (has_radio_) return FlyTo(target_m_);
        limits_.descent_mps = kThrottleDownDescent_mps;
        return Sink(kThrottleDownDescent_mps);
    }
  }

  void FlyGuided() {
    switch (guided_) {
      case Guided::kVelocity:
        if (SecondsSince(setpoint_s_) > parameters_["GUID_TIMEOUT"]) velocity_mps_.setZero();
        return FlyAt(velocity_mps_);
      case Guided::kTakeoff:
        FlyTo(target_m_);
        if (std::abs(senses_.estimate.position_m.z() - target_m_.z()) < kArrived_m)
          guided_ = Guided::kPosition;
        return;
      case Guided::kHold:
      case Guided::kPosition:
        if (SecondsSince(setpoint_s_) > parameters_["GUID_TIMEOUT"]) velocity_mps_.setZero();
        FlyTo(target_m_);
        goal_.velocity_mps = velocity_mps_;
        return;
    }
  }

  void FlyHome() {
    const bool has_arrived = (senses_.estimate.position_m - target_m_).norm() < 2.0 * kArrived_m;
    switch (return_) {
      case Return::kClimb:
        if (has_arrived && home_in_map_m_) {
          return_ = Return::kFly;
          target_m_.head<2>() = home_in_map_m_->head<2>();
        }
        return FlyTo(target_m_);
      case Return::kFly:
        if (has_arrived) {
          return_ = Return::kWait;
          setpoint_s_ = boot_s_;
        }
        return FlyTo(target_m_);
      case Return::kWait:
        if (SecondsSince(setpoint_s_) > parameters_["RTL_LOIT_TIME"] * 1e-3) return_ = Return::kLand;
        return FlyTo(target_m_);
      case Return::kLand: {
        const double height_m = senses_.estimate.position_m.z() - home_in_map_m_->z();
        return Sink(height_m > 10.0 ? limits_.descent_mps : parameters_["LAND_SPEED"] * 0.01);
      }
    }
  }

  void CheckLanded() {
    if (!senses_.is_on_ground) {
      is_landed_ = false;
      touched_s_ = boot_s_;
      idle_since_s_ = boot_s_;
      return;
    }
    const bool goes_up = mode_ == kCopterGuided && guided_ == Guided::kTakeoff;
    if (!is_landed_ && SecondsSince(touched_s_) > 0.3 && !goes_up) {
      is_landed_ = true;
      idle_since_s_ = boot_s_;
    }
    if (!is_landed_) return;
    const bool is_landing = mode_ == kCopterLand || mode_ == kCopterRtl;
    if (goes_up && SecondsSince(setpoint_s_) < kSpoolUp_s + 5.0) return;
    if (SecondsSince(idle_since_s_) > (is_landing ? kTouchdownTime_s : parameters_["DISARM_DELAY"])) Disarm();
  }

  void Disarm() {
    if (is_armed_) Announce(kSeverityInfo, "Disarming motors");
    is_armed_ = false;
    is_failsafe_ = false;
    Hold();
  }

  // Failsafes.

  void CheckFailsafes() {
    if (!has_gps_ && SecondsSince(gps_changed_s_) > kGpsFailsafe_s && !is_landed_) {
      FailSafe(kCopterLand, "EKF Failsafe: changed to LAND Mode");
    }
    if (radio_lost_s_ > 0.0 && !has_radio_ && SecondsSince(radio_lost_s_) > kRadioFailsafe_s &&
        parameters_["FS_THR_ENABLE"] > 0.0) {
      radio_lost_s_ = 0.0;
      FailSafe(kCopterRtl, "Radio Failsafe - changed to RTL Mode");
    }
    if (senses_.battery_ratio >= parameters_["BATT_LOW_RATIO"]) {
      battery_low_since_s_.reset();
    } else if (!battery_low_since_s_) {
      battery_low_since_s_ = boot_s_;
    } else if (SecondsSince(*battery_low_since_s_) > kBatteryFailsafe_s && !has_announced_battery_) {
      has_announced_battery_ = true;
      Announce(kSeverityWarning, "Battery 1 is low");
      FailSafe(kCopterRtl, "Battery Failsafe - changed to RTL Mode");
    }
    if (parameters_["FS_GCS_ENABLE"] > 0.0 && last_heartbeat_of_gcs_s_ >= 0.0 &&
        SecondsSince(last_heartbeat_of_gcs_s_) > parameters_["FS_GCS_TIMEOUT"]) {
      last_heartbeat_of_gcs_s_ = -1.0;
      FailSafe(kCopterRtl, "GCS Failsafe - changed to RTL Mode");
    }
  }

  void FailSafe(CopterMode mode, std::string_view text) {
    if (is_failsafe_ && mode_ == mode) return;
    is_failsafe_ = true;
    Announce(kSeverityWarning, text);
    if (is_landed_) return Disarm();
    Enter(mode);
  }

  CopterMode mode_ = kCopterStabilize;
  Guided guided_ = Guided::kHold;
  Return return_ = Return::kClimb;
  Eigen::Vector3d target_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  double yaw_rad_ = 0.0;
  double speed_mps_ = 10.0;
  double setpoint_s_ = 0.0;
  double idle_since_s_ = 0.0;
  double touched_s_ = 0.0;
  bool is_failsafe_ = false;
  bool has_announced_battery_ = false;
  std::optional<double> battery_low_since_s_;
};

}  // namespace

std::unique_ptr<Autopilot> MakeArduPilot(const AutopilotOptions& options) {
  return std::make_unique<ArduPilot>(options);
}

}  // namespace soffit::sim
