/// PX4 as a companion computer meets it: offboard control needs a stream of setpoints, telemetry is on from
/// the start.
#include <algorithm>
#include <array>
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

struct ModeTraits {
  std::uint32_t custom_mode;
  const char* name;
};
constexpr std::uint32_t kPosition = Px4CustomMode(kPx4PosCtl);
constexpr std::uint32_t kOffboard = Px4CustomMode(kPx4Offboard);
constexpr std::uint32_t kTakeoff = Px4CustomMode(kPx4Auto, kPx4AutoTakeoff);
constexpr std::uint32_t kHold = Px4CustomMode(kPx4Auto, kPx4AutoLoiter);
constexpr std::uint32_t kReturn = Px4CustomMode(kPx4Auto, kPx4AutoRtl);
constexpr std::uint32_t kLand = Px4CustomMode(kPx4Auto, kPx4AutoLand);
constexpr std::array<ModeTraits, 6> kModes = {{{kPosition, "POSCTL"},
                                               {kOffboard, "OFFBOARD"},
                                               {kTakeoff, "AUTO.TAKEOFF"},
                                               {kHold, "AUTO.LOITER"},
                                               {kReturn, "AUTO.RTL"},
                                               {kLand, "AUTO.LAND"}}};

std::map<std::string, double> DefaultParameters() {
  return {{"COM_DISARM_LAND", 2},  {"COM_DISARM_PRFLT", 10}, {"COM_OBL_RC_ACT", 5},
          {"COM_OF_LOSS_T", 1},    {"MIS_TAKEOFF_ALT", 2.5}, {"MPC_ACC_HOR", 3},
          {"MPC_LAND_SPEED", 0.7}, {"MPC_XY_VEL_MAX", 12},   {"MPC_Z_VEL_MAX_DN", 1.5},
          {"MPC_Z_VEL_MAX_UP", 3}, {"RTL_RETURN_ALT", 60},   {"MAV_SYS_ID", 1}};
}

class Px4 final : public Autopilot {
 public:
  explicit Px4(const AutopilotOptions& options) : Autopilot(options, DefaultParameters()) { Boot(); }

  std::string ModeName() const override {
    return std::find_if(kModes.begin(), kModes.end(), [&](const auto& m) { return m.custom_mode == mode_; })
        ->name;
  }

  bool PilotSelects(const std::string& mode) override {
    const auto found =
        std::find_if(kModes.begin(), kModes.end(), [&](const auto& m) { return m.name == mode; });
    if (found == kModes.end()) return false;
    SetRadio(true);
    Enter(found->custom_mode);
    return true;
  }

 protected:
  void Boot() override {
    is_failsafe_ = false;
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
      case kCmdComponentArmDisarm:
        return ArmOrDisarm(request);
      case kCmdNavTakeoff:
        return TakeOff(request);
      case kCmdNavLand:
        return SelectMode(kLand);
      case kCmdNavReturnToLaunch:
        return SelectMode(kReturn);
      case kCmdDoSetHome:
        if (!frame_ || request.param1 != 1.0) return kResultTemporarilyRejected;
        SetHome(senses_.estimate.position_m);
        return kResultAccepted;
      default:
        return ExecuteCommon(request);
    }
  }

  void TakeSetpoint(const SetPositionTargetLocalNed& m) override {
    const bool has_position = (m.type_mask & kIgnorePosition) == 0;
    const bool has_velocity = (m.type_mask & kIgnoreVelocity) == 0;
    const bool is_body = m.coordinate_frame == kFrameBodyNed;
    if (!frame_ || (m.coordinate_frame != kFrameLocalNed && !is_body) || (!has_position && !has_velocity) ||
        (is_body && has_position) || (has_position && !std::isfinite(m.x + m.y + m.z)) ||
        (has_velocity && !std::isfinite(m.vx + m.vy + m.vz))) {
      return;
    }
    previous_setpoint_s_ = setpoint_s_;
    setpoint_s_ = boot_s_;
    const Eigen::AngleAxisd from_nose(is_body ? YawOf(senses_.estimate.map_from_body) - 0.5 * M_PI : 0.0,
                                      Eigen::Vector3d::UnitZ());
    wanted_ = {has_position ? FlightGoal::Kind::kPosition : FlightGoal::Kind::kVelocity,
               Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), wanted_.yaw_rad};
    if (has_position) wanted_.position_m = frame_->ToMap(Eigen::Vector3d(m.x, m.y, m.z));
    if (has_velocity) {
      wanted_.velocity_mps = from_nose * NedFrame::SwapVector(Eigen::Vector3d(m.vx, m.vy, m.vz));
    }
    if ((m.type_mask & kIgnoreYaw) == 0 && std::isfinite(m.yaw)) {
      wanted_.yaw_rad = NedFrame::SwapYaw(static_cast<double>(m.yaw));
    }
  }

  void Update(double) override {
    if (!frame_ && IsReady() && has_gps_) {
      SetOrigin(Eigen::Vector3d::Zero());
      SetHome(senses_.estimate.position_m);
    }
    limits_ = {parameters_["MPC_XY_VEL_MAX"],
               parameters_["MPC_Z_VEL_MAX_UP"],
               parameters_["MPC_Z_VEL_MAX_DN"],
               parameters_["MPC_ACC_HOR"],
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

 private:
  bool IsReady() const { return boot_s_ >= (options_.is_quick_start ? kQuickReady_s : kReady_s); }
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
    for (const ModeTraits& traits : kModes) {
      const double main_mode = static_cast<double>(traits.custom_mode >> 16 & 0xff);
      const double sub_mode = static_cast<double>(traits.custom_mode >> 24);
      if (request.param2 == main_mode && request.param3 == sub_mode) return SelectMode(traits.custom_mode);
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

  CommandResult ArmOrDisarm(const CommandRequest& request) {
    const bool is_forced = request.param2 == static_cast<double>(kForceArmDisarm);
    if (request.param1 == 0.0) {
      if (!is_landed_ && !is_forced) {
        Announce(kSeverityCritical, "Disarming denied: not landed");
        return kResultDenied;
      }
      Disarm();
      return kResultAccepted;
    }
    if (request.param1 != 1.0) return kResultUnsupported;
    if (is_armed_) return kResultAccepted;
    if (!HasPosition() && !is_forced) {
      Announce(kSeverityCritical, "Arming denied: Resolve system health failures first");
      return kResultTemporarilyRejected;
    }
    is_armed_ = true;
    is_failsafe_ = false;
    armed_s_ = idle_since_s_ = boot_s_;
    SetHome(senses_.estimate.position_m);
    Enter(mode_);
    return kResultAccepted;
  }

  CommandResult TakeOff(const CommandRequest& request) {
    if (!is_landed_ || !home_in_map_m_ || !frame_) return kResultTemporarilyRejected;
    const double home_amsl_m = frame_->GeodeticOf(*home_in_map_m_).altitude_amsl_m;
    const double rise_m = std::isfinite(request.z) ? request.z - home_amsl_m : parameters_["MIS_TAKEOFF_ALT"];
    Enter(kTakeoff);
    hold_m_.z() = home_in_map_m_->z() + std::max(rise_m, 0.5);
    return kResultAccepted;
  }

  // Modes.

  void Enter(std::uint32_t mode) {
    mode_ = mode;
    hold_m_ = StoppingPoint();
    yaw_rad_ = YawOf(senses_.estimate.map_from_body);
    if (mode == kReturn && home_in_map_m_) {
      has_climbed_ = false;
      hold_m_.z() = std::max(hold_m_.z(), home_in_map_m_->z() + parameters_["RTL_RETURN_ALT"]);
    }
  }

  void FlyTo(const Eigen::Vector3d& position_m) {
    goal_ = {FlightGoal::Kind::kPosition, position_m, Eigen::Vector3d::Zero(), yaw_rad_};
  }

  bool WantsToLift() const {
    if (SecondsSince(armed_s_) < kSpoolUp_s) return false;
    if (mode_ == kTakeoff) return true;
    const double height_m = senses_.estimate.position_m.z();
    return mode_ == kOffboard &&
           (wanted_.kind == FlightGoal::Kind::kPosition ? wanted_.position_m.z() > height_m + 0.2
                                                        : wanted_.velocity_mps.z() > 0.1);
  }

  void Fly() {
    if (is_landed_ && !WantsToLift()) {
      goal_.kind = FlightGoal::Kind::kIdle;
      return;
    }
    const bool has_arrived = (senses_.estimate.position_m - hold_m_).norm() < kArrived_m;
    switch (mode_) {
      case kOffboard:
        goal_ = wanted_;
        return;
      case kTakeoff:
        FlyTo(hold_m_);
        if (has_arrived) Enter(kHold);
        return;
      case kReturn:
        if (has_arrived && has_climbed_) return Enter(kLand);
        if (has_arrived) {
          has_climbed_ = true;
          hold_m_.head<2>() = home_in_map_m_->head<2>();
        }
        return FlyTo(hold_m_);
      case kLand:
        FlyTo({hold_m_.x(), hold_m_.y(), control_.path_position_m().z()});
        goal_.velocity_mps.z() = -parameters_["MPC_LAND_SPEED"];
        return;
      default:
        return FlyTo(hold_m_);
    }
  }

  void CheckLanded() {
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

  void Disarm() {
    is_armed_ = false;
    is_failsafe_ = false;
    if (mode_ == kLand || mode_ == kReturn) Enter(kHold);
  }

  void CheckFailsafes() {
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

  std::uint32_t mode_ = kHold;
  FlightGoal wanted_;
  Eigen::Vector3d hold_m_ = Eigen::Vector3d::Zero();
  double yaw_rad_ = 0.0;
  double setpoint_s_ = 0.0;
  double previous_setpoint_s_ = -1.0;
  double armed_s_ = 0.0;
  double idle_since_s_ = 0.0;
  bool has_climbed_ = false;
  bool is_failsafe_ = false;
};

}  // namespace

std::unique_ptr<Autopilot> MakePx4(const AutopilotOptions& options) { return std::make_unique<Px4>(options); }

}  // namespace soffit::sim
