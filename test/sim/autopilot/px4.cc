/// PX4 as a companion computer meets it: offboard control needs a stream of setpoints, telemetry is on from
/// the start.
#include <algorithm>
#include <cmath>

#include "test/sim/autopilot/autopilot.h"

namespace soffit::sim {
namespace {

using namespace mavlink;

constexpr double kReady_s = 15.0;
constexpr double kQuickReady_s = 3.0;
constexpr double kLongestGap_s = 0.5;  // Offboard setpoints come at 2 Hz or more.
constexpr double kSpoolUp_s = 1.5;
constexpr double kArrived_m = 0.15;
constexpr double kGpsFailsafe_s = 5.0;
constexpr std::uint16_t kFlagsReady = 0x33f;
constexpr std::uint16_t kFlagsNoGps = 0x0a7;

constexpr std::uint32_t kPosition = Px4CustomMode(kPx4PosCtl);
constexpr std::uint32_t kOffboard = Px4CustomMode(kPx4Offboard);
constexpr std::uint32_t kTakeoff = Px4CustomMode(kPx4Auto, kPx4AutoTakeoff);
constexpr std::uint32_t kHold = Px4CustomMode(kPx4Auto, kPx4AutoLoiter);
constexpr std::uint32_t kReturn = Px4CustomMode(kPx4Auto, kPx4AutoRtl);
constexpr std::uint32_t kLand = Px4CustomMode(kPx4Auto, kPx4AutoLand);
const std::vector<FlightMode> kModes = {{kPosition, "POSCTL"},      {kOffboard, "OFFBOARD"},
                                        {kTakeoff, "AUTO.TAKEOFF"}, {kHold, "AUTO.LOITER"},
                                        {kReturn, "AUTO.RTL"},      {kLand, "AUTO.LAND"}};

std::map<std::string, double> DefaultParameters() {
  return {
      {"COM_LOW_BAT_ACT", 0},    {"COM_RCL_EXCEPT", 0},    {"NAV_DLL_ACT", 0},      {"NAV_RCL_ACT", 2},
      {"COM_DISARM_LAND", 2},    {"COM_DISARM_PRFLT", 10}, {"COM_OBL_RC_ACT", 5},   {"COM_OF_LOSS_T", 1},
      {"MIS_TAKEOFF_ALT", 2.5},  {"MPC_ACC_HOR", 3},       {"MPC_LAND_SPEED", 0.7}, {"MPC_XY_VEL_MAX", 12},
      {"MPC_Z_VEL_MAX_DN", 1.5}, {"MPC_Z_VEL_MAX_UP", 3},  {"RTL_RETURN_ALT", 60},  {"MAV_SYS_ID", 1}};
}

class Px4 final : public Autopilot {
 public:
  explicit Px4(const AutopilotOptions& options) : Autopilot(options, DefaultParameters(), kModes) { Boot(); }

 protected:
  void Boot() override {
    const std::pair<std::uint32_t, double> streams[] = {
        {Heartbeat::kId, 1.0},          {Attitude::kId, 0.02},         {AttitudeQuaternion::kId, 0.02},
        {LocalPositionNed::kId, 0.033}, {GlobalPositionInt::kId, 0.1}, {SysStatus::kId, 0.5},
        {BatteryStatus::kId, 1.0},      {ExtendedSysState::kId, 0.5},  {HomePosition::kId, 2.0},
        {GpsRawInt::kId, 0.2},          {EstimatorStatus::kId, 1.0},   {SystemTime::kId, 1.0}};
    for (const auto& [id, interval_s] : streams) SetIntervalOnAllLinks(id, interval_s);
    Enter(kHold);
  }

  CommandResult Execute(const CommandRequest& request) override {
    switch (request.command) {
      case kCmdDoSetMode:
        return SelectMode(request);
      case kCmdNavTakeoff:
        return TakeOff(request);
      case kCmdNavLand:
        return SelectMode(kLand);
      case kCmdNavReturnToLaunch:
        return SelectMode(kReturn);
      default:
        return ExecuteCommon(request);
    }
  }

  void TakeSetpoint(const SetPositionTargetLocalNed& m) override {
    const std::optional<Setpoint> setpoint = ToMap(m);
    const bool is_known = m.coordinate_frame == kFrameLocalNed ||
                          (m.coordinate_frame == kFrameBodyNed && setpoint && !setpoint->position_m);
    if (!setpoint || !is_known) return;
    previous_setpoint_s_ = setpoint_s_;
    setpoint_s_ = boot_s_;
    const double heading_rad = setpoint->heading_rad.value_or(NAN);
    wanted_ = {setpoint->position_m ? FlightGoal::Kind::kPosition : FlightGoal::Kind::kVelocity,
               setpoint->position_m.value_or(Eigen::Vector3d::Zero()),
               setpoint->velocity_mps.value_or(Eigen::Vector3d::Zero()),
               std::isfinite(heading_rad) ? NedFrame::SwapYaw(heading_rad) : wanted_.yaw_rad};
  }

  void Locate() override {
    if (boot_s_ < (options_.is_quick_start ? kQuickReady_s : kReady_s)) return;
    SetOrigin(Eigen::Vector3d::Zero());
    SetHome(senses_.estimate.position_m);
  }

  FlightLimits Limits() const override {
    return {parameters_["MPC_XY_VEL_MAX"],
            parameters_["MPC_Z_VEL_MAX_UP"],
            parameters_["MPC_Z_VEL_MAX_DN"],
            parameters_["MPC_ACC_HOR"],
            FlightLimits{}.vertical_acceleration_mps2,
            FlightLimits{}.yaw_rate_radps};
  }

  void Describe(Report& report) const override {
    report.autopilot = kAutopilotPx4;
    report.base_mode = static_cast<std::uint8_t>(kModeFlagCustomModeEnabled | kModeFlagStabilizeEnabled |
                                                 kModeFlagGuidedEnabled | kModeFlagAutoEnabled |
                                                 (is_armed_ ? kModeFlagSafetyArmed : 0));
    report.custom_mode = mode_;
    report.system_status = is_failsafe_ ? kStateCritical : is_armed_ ? kStateActive : kStateStandby;
    report.landed_state = is_landed_          ? kLandedOnGround
                          : mode_ == kTakeoff ? kLandedTakeoff
                          : mode_ == kLand    ? kLandedLanding
                                              : kLandedInAir;
    report.has_gps = has_gps_;
    report.has_position = HasPosition();
    report.is_ready_to_arm = HasPosition();
    report.estimator_flags = HasPosition() ? kFlagsReady : kFlagsNoGps;
    report.throttle_ratio = 0.5;
    if (mode_ == kOffboard && wanted_.kind == FlightGoal::Kind::kPosition)
      report.target_in_map_m = wanted_.position_m;
  }

  CommandResult Refusal() const override { return kResultTemporarilyRejected; }
  CommandResult RefuseToDisarm() override {
    Announce(kSeverityCritical, "Disarming denied: not landed");
    return kResultDenied;
  }
  std::string ReasonNotToArm() const override {
    return HasPosition() ? "" : "Arming denied: Resolve system health failures first";
  }

 private:
  bool HasPosition() const {
    return frame_.has_value() && (has_gps_ || SecondsSince(gps_changed_s_) < kGpsFailsafe_s);
  }
  bool HasOffboardStream() const {
    return setpoint_s_ > 0.0 && SecondsSince(setpoint_s_) < kLongestGap_s &&
           setpoint_s_ - previous_setpoint_s_ <= kLongestGap_s;
  }

  // Commands.

  CommandResult SelectMode(const CommandRequest& request) {
    if (request.param1 < 1.0) return kResultUnsupported;
    for (const FlightMode& mode : kModes) {
      const double main_mode = static_cast<double>(mode.number >> 16 & 0xff);
      const double sub_mode = static_cast<double>(mode.number >> 24);
      if (request.param2 == main_mode && request.param3 == sub_mode) return SelectMode(mode.number);
    }
    return kResultUnsupported;
  }

  CommandResult SelectMode(std::uint32_t mode) {
    const bool lacks_stream = mode == kOffboard && !HasOffboardStream();
    if (lacks_stream || !HasPosition()) {
      Announce(kSeverityCritical, "Switching to this mode is currently not available");
      return kResultTemporarilyRejected;
    }
    Enter(mode);
    return kResultAccepted;
  }

  CommandResult TakeOff(const CommandRequest& request) {
    if (!is_landed_ || !home_in_map_m_ || !frame_) return kResultTemporarilyRejected;
    const double home_amsl_m = frame_->GeodeticOf(*home_in_map_m_).altitude_amsl_m;
    const double rise_m = std::isfinite(request.z) ? request.z - home_amsl_m : parameters_["MIS_TAKEOFF_ALT"];
    Enter(kTakeoff);
    target_m_.z() = home_in_map_m_->z() + std::max(rise_m, 0.5);
    return kResultAccepted;
  }

  // Modes.

  void OnEnter() override {
    if (mode_ == kReturn && home_in_map_m_) {
      has_climbed_ = false;
      target_m_.z() = std::max(target_m_.z(), home_in_map_m_->z() + parameters_["RTL_RETURN_ALT"]);
    }
  }

  bool WantsToLift() const {
    if (SecondsSince(armed_s_) < kSpoolUp_s) return false;
    if (mode_ == kTakeoff) return true;
    const double height_m = senses_.estimate.position_m.z();
    return mode_ == kOffboard &&
           (wanted_.kind == FlightGoal::Kind::kPosition ? wanted_.position_m.z() > height_m + 0.2
                                                        : wanted_.velocity_mps.z() > 0.1);
  }

  void Fly() override {
    if (is_landed_ && !WantsToLift()) {
      goal_.kind = FlightGoal::Kind::kIdle;
      return;
    }
    const bool has_arrived = (senses_.estimate.position_m - target_m_).norm() < kArrived_m;
    switch (mode_) {
      case kOffboard:
        goal_ = wanted_;
        return;
      case kTakeoff:
        FlyTo(target_m_);
        if (has_arrived) Enter(kHold);
        return;
      case kReturn:
        if (has_arrived && has_climbed_) return Enter(kLand);
        if (has_arrived) {
          has_climbed_ = true;
          target_m_.head<2>() = home_in_map_m_->head<2>();
        }
        return FlyTo(target_m_);
      case kLand:
        return Sink(parameters_["MPC_LAND_SPEED"]);
      default:
        return FlyTo(target_m_);
    }
  }

  void CheckLanded() override {
    if (!senses_.is_on_ground) {
      is_landed_ = false;
      idle_since_s_ = boot_s_;
      return;
    }
    if (!WantsToLift() && SecondsSince(idle_since_s_) > 0.3) is_landed_ = true;
    if (!is_landed_ || WantsToLift()) return;
    const bool has_flown = mode_ == kLand;
    if (SecondsSince(idle_since_s_) > parameters_[has_flown ? "COM_DISARM_LAND" : "COM_DISARM_PRFLT"])
      Disarm();
  }

  void Disarm() override {
    is_armed_ = false;
    is_failsafe_ = false;
    if (mode_ == kLand || mode_ == kReturn) Enter(kHold);
  }

  void CheckFailsafes() override {
    if (mode_ == kOffboard && SecondsSince(setpoint_s_) > parameters_["COM_OF_LOSS_T"]) {
      FailSafe(kHold, "Failsafe activated: no offboard signal");
    }
    if (!has_gps_ && SecondsSince(gps_changed_s_) > kGpsFailsafe_s && mode_ != kLand) {
      FailSafe(kLand, "Failsafe activated: no position, landing");
    }
    if (radio_lost_s_ > 0.0 && !has_radio_ && mode_ != kOffboard) {
      radio_lost_s_ = 0.0;
      FailSafe(kReturn, "Failsafe activated: manual control lost");
    }
  }

  void FailSafe(std::uint32_t mode, std::string_view text) {
    is_failsafe_ = true;
    Announce(kSeverityCritical, text);
    Enter(mode);
  }

  FlightGoal wanted_;
  double previous_setpoint_s_ = -1.0;
  bool has_climbed_ = false;
};

}  // namespace

std::unique_ptr<Autopilot> MakePx4(const AutopilotOptions& options) { return std::make_unique<Px4>(options); }

}  // namespace soffit::sim
