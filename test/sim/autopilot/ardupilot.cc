/// ArduPilot Copter 4.5 as a companion computer meets it: measured on the real program, on loopback.
#include <algorithm>
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

const std::vector<FlightMode> kModes = {{kCopterStabilize, "STABILIZE", false, true},
                                        {kCopterAltHold, "ALT_HOLD", false, true},
                                        {kCopterGuided, "GUIDED", true, true},
                                        {kCopterLoiter, "LOITER", true, true},
                                        {kCopterRtl, "RTL", true, false},
                                        {kCopterLand, "LAND", false, false},
                                        {kCopterPosHold, "POSHOLD", true, true},
                                        {kCopterBrake, "BRAKE", true, false}};

std::map<std::string, double> DefaultParameters() {
  return {{"ARMING_CHECK", 1},     {"BATT_FS_LOW_ACT", 2},  {"BATT_LOW_RATIO", 0.15}, {"DISARM_DELAY", 10},
          {"FENCE_ACTION", 1},     {"FENCE_ENABLE", 0},     {"FS_OPTIONS", 16},       {"FS_EKF_ACTION", 1},
          {"FS_GCS_ENABLE", 0},    {"FS_GCS_TIMEOUT", 5},   {"FS_THR_ENABLE", 1},     {"GUID_OPTIONS", 0},
          {"GUID_TIMEOUT", 3},     {"LAND_SPEED", 50},      {"LAND_SPEED_HIGH", 0},   {"RTL_ALT", 1500},
          {"RTL_LOIT_TIME", 5000}, {"SYSID_MYGCS", 255},    {"SYSID_THISMAV", 1},     {"WPNAV_ACCEL", 250},
          {"WPNAV_SPEED", 1000},   {"WPNAV_SPEED_DN", 150}, {"WPNAV_SPEED_UP", 250},  {"WP_YAW_BEHAVIOR", 2}};
}

class ArduPilot final : public Autopilot {
 public:
  explicit ArduPilot(const AutopilotOptions& options) : Autopilot(options, DefaultParameters(), kModes) {
    Boot();
  }

 protected:
  void Boot() override {
    speed_mps_ = parameters_["WPNAV_SPEED"] * 0.01;
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
      case kCmdNavTakeoff:
        return TakeOff(request);
      case kCmdNavLand:
        return SelectMode(*FindMode(kCopterLand));
      case kCmdNavReturnToLaunch:
        return SelectMode(*FindMode(kCopterRtl));
      case kCmdConditionYaw:
        return TurnTo(request);
      case kCmdDoChangeSpeed:
        if (!(request.param2 > 0.0)) return kResultFailed;
        speed_mps_ = request.param2;
        return kResultAccepted;
      default:
        break;
    }
    const bool was_armed = is_armed_;
    const CommandResult result = ExecuteCommon(request);
    if (is_armed_ && !was_armed) Announce(kSeverityInfo, "Arming motors");
    return result;
  }

  void TakeSetpoint(const SetPositionTargetLocalNed& m) override {
    if (mode_ != kCopterGuided || !is_armed_ || !frame_) return;
    const std::optional<Setpoint> setpoint = ToMap(m);
    const bool has_acceleration = (m.type_mask & kIgnoreAcceleration) == 0;
    if (!setpoint || has_acceleration || !std::isfinite(setpoint->heading_rad.value_or(0.0)))
      return Enter(mode_);
    if (is_landed_ && guided_ != Guided::kTakeoff) return;  // Only a takeoff leaves the ground.

    guided_ = setpoint->position_m ? Guided::kPosition : Guided::kVelocity;
    setpoint_s_ = boot_s_;
    target_m_ = setpoint->position_m.value_or(target_m_);
    velocity_mps_ = setpoint->velocity_mps.value_or(Eigen::Vector3d::Zero());
    if (setpoint->heading_rad) {
      const bool is_body = m.coordinate_frame == kFrameBodyNed || m.coordinate_frame == kFrameBodyOffsetNed;
      yaw_rad_ = is_body ? WrapAngle(YawOf(senses_.estimate.map_from_body) - *setpoint->heading_rad)
                         : NedFrame::SwapYaw(*setpoint->heading_rad);
    } else if (setpoint->position_m) {
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

  void Locate() override {
    if (boot_s_ < Start(kOriginSet_s)) return;
    SetOrigin(kOriginInMap_m);
    Announce(kSeverityInfo, "EKF3 IMU0 origin set");
    SetHome(Eigen::Vector3d::Zero());
  }

  FlightLimits Limits() const override {
    return {speed_mps_,
            parameters_["WPNAV_SPEED_UP"] * 0.01,
            parameters_["WPNAV_SPEED_DN"] * 0.01,
            parameters_["WPNAV_ACCEL"] * 0.01,
            FlightLimits{}.vertical_acceleration_mps2,
            FlightLimits{}.yaw_rate_radps};
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

  CommandResult Refusal() const override { return kResultFailed; }
  CommandResult RefuseToDisarm() override { return kResultFailed; }

  std::string ReasonNotToArm() const override {
    const FlightMode& mode = *FindMode(mode_);
    if (!mode.can_arm) return "Arm: Mode not armable";
    if (mode.needs_position && !HasPosition()) return "Arm: Need Position Estimate";
    if (senses_.battery_ratio < parameters_["BATT_LOW_RATIO"])
      return "Arm: Battery 1 below minimum arming capacity";
    if (!has_radio_ && mode_ != kCopterGuided) return "Arm: RC not found";
    return "";
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
    const FlightMode* mode = FindMode(request.param2);
    if (mode == nullptr) {
      Announce(kSeverityWarning, "No such mode");
      return kResultFailed;
    }
    return SelectMode(*mode);
  }

  CommandResult SelectMode(const FlightMode& mode) {
    if (is_armed_ && mode.needs_position && !HasPosition()) {
      Announce(kSeverityWarning, std::string("Mode change to ") + mode.name + " failed: requires position");
      return kResultFailed;
    }
    if (mode.number != mode_) Enter(mode.number);
    return kResultAccepted;
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

  void OnEnter() override {
    guided_ = Guided::kHold;
    velocity_mps_.setZero();
    if (mode_ == kCopterRtl && home_in_map_m_) {
      return_ = Return::kClimb;
      const Eigen::Vector3d& here_m = senses_.estimate.position_m;
      const double away_m = (here_m - *home_in_map_m_).head<2>().norm();
      const double height_m = home_in_map_m_->z() + parameters_["RTL_ALT"] * 0.01;
      target_m_ = here_m;
      if (away_m > kFarFromHome_m) target_m_.z() = std::max(here_m.z(), height_m);
    }
  }

  void Fly() override {
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

  void CheckLanded() override {
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

  void Disarm() override {
    if (is_armed_) Announce(kSeverityInfo, "Disarming motors");
    is_armed_ = false;
    is_failsafe_ = false;
    Enter(mode_);
  }

  // Failsafes.

  void CheckFailsafes() override {
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

  void FailSafe(std::uint32_t mode, std::string_view text) {
    if (is_failsafe_ && mode_ == mode) return;
    is_failsafe_ = true;
    Announce(kSeverityWarning, text);
    if (is_landed_) return Disarm();
    Enter(mode);
  }

  Guided guided_ = Guided::kHold;
  Return return_ = Return::kClimb;
  Eigen::Vector3d velocity_mps_ = Eigen::Vector3d::Zero();
  double speed_mps_ = 10.0;
  double touched_s_ = 0.0;
  bool has_announced_battery_ = false;
  std::optional<double> battery_low_since_s_;
};

}  // namespace

std::unique_ptr<Autopilot> MakeArduPilot(const AutopilotOptions& options) {
  return std::make_unique<ArduPilot>(options);
}

}  // namespace soffit::sim
