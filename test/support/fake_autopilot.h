#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "vehicle_agent/mavlink/codec.h"
#include "vehicle_agent/mavlink/constants.h"

namespace soffit {

/// An ArduPilot Copter (or PX4) that is just real enough to test against: silent until asked, particular
/// about the order of mode, arming and takeoff, deaf to setpoints in other modes. Its world is its local NED
/// frame; home is where it stands.
class FakeAutopilot {
 public:
  explicit FakeAutopilot(mavlink::Autopilot make = mavlink::kAutopilotArduPilot)
      : make_(make), encoder_(1, mavlink::kComponentAutopilot) {
    if (make_ == mavlink::kAutopilotPx4)
      mode = mavlink::Px4CustomMode(mavlink::kPx4Auto, mavlink::kPx4AutoLoiter);
  }

  std::uint32_t mode = mavlink::kCopterStabilize;
  bool is_armed = false;
  bool is_ready = true;
  bool answers_timesync = true;
  bool is_silent = false;
  bool is_deaf = false;  ///< To commands that make it do something.
  std::uint8_t system_status = mavlink::kStateStandby;
  std::string arming_complaint;  ///< Not empty: refuses to arm, and says so.
  Eigen::Vector3d position_ned_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_ned_mps = Eigen::Vector3d::Zero();
  double yaw_ned_rad = 0.0;
  bool has_home = true;
  float estimator_ratio = 0.1F;  ///< Of the innovation tests.
  float estimator_accuracy_m = 0.5F;
  bool has_old_mount = false;  ///< Speaks the gimbal protocol before GIMBAL_MANAGER.
  std::map<std::string, float> parameters;
  std::vector<mavlink::Statustext> texts;  ///< All that were received.
  std::int32_t home_latitude_e7 = 500000000;
  std::int32_t origin_latitude_e7 = 500000000;
  std::vector<mavlink::CommandLong> commands;  ///< All that were received.
  std::vector<mavlink::SetPositionTargetLocalNed> setpoints;
  std::vector<mavlink::GimbalManagerSetPitchyaw> gimbal_aims;
  int setpoints_during_takeoff = 0;

  void Reboot() {
    boot_ms_ = 0;
    intervals_ms_.clear();
    sent_ms_.clear();
    is_armed = false;
  }

  void Receive(const mavlink::Frame& frame) {
    using namespace mavlink;
    if (const auto command = Decode<CommandLong>(frame)) Do(*command);
    if (const auto aim = Decode<GimbalManagerSetPitchyaw>(frame)) gimbal_aims.push_back(*aim);
    if (const auto text = Decode<Statustext>(frame)) texts.push_back(*text);
    if (const auto request = Decode<ParamRequestRead>(frame)) SendParameter(TextOf(request->param_id));
    if (const auto sync = Decode<Timesync>(frame); sync && sync->tc1 == 0 && answers_timesync) {
      Timesync answer = *sync;
      answer.tc1 = std::int64_t{boot_ms_} * 1'000'000;
      Say(answer);
    }
    if (const auto target = Decode<SetPositionTargetLocalNed>(frame)) {
      setpoints.push_back(*target);
      if (is_climbing_) ++setpoints_during_takeoff;
      if (TakesSetpoints()) {
        target_ned_m_ = {target->x, target->y, target->z};
        target_yaw_rad_ = target->yaw;
      }
    }
  }

  /// Lives on for `ms` and gives what it sends meanwhile.
  std::vector<std::vector<std::uint8_t>> Live(std::uint32_t ms) {
    Move(1e-3 * ms);
    boot_ms_ += ms;
    if (!is_silent) SendDue();
    return std::exchange(outbox_, {});
  }

 private:
  bool IsInAir() const { return position_ned_m.z() < -0.1; }
  bool TakesSetpoints() const {
    return make_ == mavlink::kAutopilotPx4 ? mode == mavlink::Px4CustomMode(mavlink::kPx4Offboard)
                                           : mode == mavlink::kCopterGuided && IsInAir();
  }
  bool IsLanding() const {
    return mode == (make_ == mavlink::kAutopilotPx4
                        ? mavlink::Px4CustomMode(mavlink::kPx4Auto, mavlink::kPx4AutoLand)
                        : std::uint32_t{mavlink::kCopterLand});
  }

  void Move(double dt_s) {
    if (!is_armed) return;
    if (IsLanding()) {
      velocity_ned_mps = {0.0, 0.0, 1.0};
      if (position_ned_m.z() > -0.02) {
        is_armed = false;
        velocity_ned_mps.setZero();
        position_ned_m.z() = 0.0;
        return;
      }
    } else if (TakesSetpoints() || is_climbing_) {
      velocity_ned_mps = 1.5 * (target_ned_m_ - position_ned_m);
      if (velocity_ned_mps.norm() > 3.0) velocity_ned_mps *= 3.0 / velocity_ned_mps.norm();
      yaw_ned_rad = target_yaw_rad_;
      if ((target_ned_m_ - position_ned_m).norm() < 0.2) is_climbing_ = false;
    }
    position_ned_m += velocity_ned_mps * dt_s;
  }

  void Do(const mavlink::CommandLong& command) {
    using namespace mavlink;
    commands.push_back(command);
    const bool is_request =
        command.command == kCmdSetMessageInterval || command.command == kCmdRequestMessage;
    if (command.target_system != 1 || (is_deaf && !is_request)) return;
    std::uint8_t result = kResultAccepted;
    switch (command.command) {
      case kCmdSetMessageInterval:
        intervals_ms_[static_cast<std::uint32_t>(command.param1)] =
            static_cast<std::uint32_t>(command.param2 / 1000.0F);
        break;
      case kCmdRequestMessage:
        SendMessage(static_cast<std::uint32_t>(command.param1));
        break;
      case kCmdDoSetMode:
        mode = make_ == kAutopilotPx4 ? static_cast<std::uint32_t>(command.param2) << 16
                                      : static_cast<std::uint32_t>(command.param2);
        if (make_ == kAutopilotPx4 && setpoints.empty()) result = kResultFailed;
        break;
      case kCmdDoSetHome:
        has_home = true;
        break;
      case kCmdDoMountControl:
        mount_pitch_deg_ = command.param1;
        break;
      case kCmdDoGimbalManagerConfigure:
        break;
      case kCmdNavLand:
        mode = Px4CustomMode(kPx4Auto, kPx4AutoLand);
        break;
      case kCmdComponentArmDisarm:
        if (!arming_complaint.empty() || IsLanding()) {
          result = kResultFailed;
          Statustext text;
          text.severity = kSeverityCritical;
          text.text = ToTextField<50>(arming_complaint);
          Say(text);
        } else {
          is_armed = true;
        }
        break;
      case kCmdNavTakeoff:
        if (!is_armed || mode != kCopterGuided || IsInAir()) {
          result = kResultFailed;
        } else {
          is_climbing_ = true;
          target_ned_m_ = {position_ned_m.x(), position_ned_m.y(), -command.param7};
        }
        break;
      default:
        result = kResultUnsupported;
    }
    mavlink::CommandAck ack;
    ack.command = command.command;
    ack.result = result;
    Say(ack);
  }

  void SendDue() {
    if (boot_ms_ >= heartbeat_ms_ + 1000 || boot_ms_ < heartbeat_ms_) {
      heartbeat_ms_ = boot_ms_;
      mavlink::Heartbeat heartbeat;
      heartbeat.type = mavlink::kTypeQuadrotor;
      heartbeat.autopilot = make_;
      heartbeat.custom_mode = mode;
      heartbeat.base_mode = is_armed ? mavlink::kModeFlagSafetyArmed : 0;
      heartbeat.system_status = system_status;
      Say(heartbeat);
    }
    for (const auto& [id, interval_ms] : intervals_ms_) {
      if (boot_ms_ - sent_ms_[id] < interval_ms) continue;
      sent_ms_[id] = boot_ms_;
      SendMessage(id);
    }
  }

  void SendMessage(std::uint32_t id) {
    using namespace mavlink;
    if (id == LocalPositionNed::kId && is_ready) {
      LocalPositionNed m;
      m.time_boot_ms = boot_ms_;
      m.x = static_cast<float>(position_ned_m.x());
      m.y = static_cast<float>(position_ned_m.y());
      m.z = static_cast<float>(position_ned_m.z());
      m.vx = static_cast<float>(velocity_ned_mps.x());
      m.vy = static_cast<float>(velocity_ned_mps.y());
      m.vz = static_cast<float>(velocity_ned_mps.z());
      Say(m);
    } else if (id == AttitudeQuaternion::kId) {
      AttitudeQuaternion m;
      m.time_boot_ms = boot_ms_;
      m.q1 = static_cast<float>(std::cos(0.5 * yaw_ned_rad));
      m.q4 = static_cast<float>(std::sin(0.5 * yaw_ned_rad));
      Say(m);
    } else if (id == MountOrientation::kId && has_old_mount) {
      MountOrientation m;
      m.time_boot_ms = boot_ms_;
      m.pitch = mount_pitch_deg_;
      Say(m);
    } else if (id == GimbalDeviceAttitudeStatus::kId && !has_old_mount) {
      const double pitch_rad = gimbal_aims.empty() ? 0.0 : static_cast<double>(gimbal_aims.back().pitch);
      GimbalDeviceAttitudeStatus m;
      m.time_boot_ms = boot_ms_;
      m.q = {static_cast<float>(std::cos(0.5 * pitch_rad)), 0.0F,
             static_cast<float>(std::sin(0.5 * pitch_rad)), 0.0F};
      Say(m);
    } else if (id == SysStatus::kId) {
      SysStatus m;
      m.battery_remaining = 77;
      m.onboard_control_sensors_present = kSensorPrearmCheck;
      m.onboard_control_sensors_health = is_ready ? kSensorPrearmCheck : 0;
      Say(m);
    } else if (id == GpsRawInt::kId) {
      GpsRawInt m;
      m.fix_type = is_ready ? kGps3dFix : kGpsNoFix;
      Say(m);
    } else if (id == ExtendedSysState::kId) {
      ExtendedSysState m;
      m.landed_state = is_climbing_ && IsInAir() ? kLandedTakeoff
                       : IsInAir()               ? kLandedInAir
                                                 : kLandedOnGround;
      Say(m);
    } else if (id == EkfStatusReport::kId) {
      EkfStatusReport m;
      m.flags = is_ready ? 0x33f : 0xa7;
      m.pos_horiz_variance = m.compass_variance = estimator_ratio;
      Say(m);
    } else if (id == EstimatorStatus::kId) {
      EstimatorStatus m;
      m.flags = is_ready ? 0x33f : 0xa7;
      m.pos_horiz_ratio = m.mag_ratio = estimator_ratio;
      m.pos_horiz_accuracy = estimator_accuracy_m;
      Say(m);
    } else if (id == HomePosition::kId && is_ready && has_home) {
      HomePosition m;
      m.latitude = home_latitude_e7;
      m.longitude = 190000000;
      m.altitude = 250000;
      Say(m);
    } else if (id == GpsGlobalOrigin::kId && is_ready) {
      GpsGlobalOrigin m;
      m.latitude = origin_latitude_e7;
      m.longitude = 190000000;
      m.altitude = 250000;
      Say(m);
    }
  }

  void SendParameter(const std::string& name) {
    const auto found = parameters.find(name);
    if (found == parameters.end()) return;
    mavlink::ParamValue m;
    m.param_id = mavlink::ToTextField<16>(name);
    m.param_value = found->second;
    m.param_type = mavlink::kParamReal32;
    Say(m);
  }

  template <class Message>
  void Say(const Message& message) {
    outbox_.push_back(encoder_.Encode(message));
  }

  mavlink::Autopilot make_;
  mavlink::Encoder encoder_;
  std::vector<std::vector<std::uint8_t>> outbox_;
  std::uint32_t boot_ms_ = 5000;
  std::uint32_t heartbeat_ms_ = 0;
  std::map<std::uint32_t, std::uint32_t> intervals_ms_;
  std::map<std::uint32_t, std::uint32_t> sent_ms_;
  bool is_climbing_ = false;
  float mount_pitch_deg_ = 0.0F;
  Eigen::Vector3d target_ned_m_ = Eigen::Vector3d::Zero();
  double target_yaw_rad_ = 0.0;
};

}  // namespace soffit
