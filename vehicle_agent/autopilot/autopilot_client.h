#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shared/options/options.h"
#include "vehicle_agent/autopilot/dialect.h"
#include "vehicle_agent/autopilot/map_frame.h"
#include "vehicle_agent/autopilot/parameter_watch.h"
#include "vehicle_agent/mavlink/arrivals.h"
#include "vehicle_agent/mavlink/codec.h"
#include "vehicle_agent/pose/clock_offset.h"
#include "vehicle_agent/pose/pose_buffer.h"
#include "vehicle_agent/vehicle/vehicle.h"

namespace soffit {

struct AutopilotOptions {
  int system_id = 0;
  int component_id = 191;
  double heartbeat_timeout_s = 3.0;
  double position_timeout_s = 1.0;
  double setpoint_rate_hz = 10.0;
  double pose_rate_hz = 50.0;
  double arm_timeout_s = 30.0;
  double reference_height_m = 0.0;
  double position_std_m = 0.05;
  double orientation_std_rad = 0.01;
  double max_estimator_ratio = 1.0;
  double max_position_error_m = 3.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("system_id", self.system_id,
          OptionInfo{0, 255, "", "Of the vehicle; 0: the first autopilot that is heard"});
    field("component_id", self.component_id,
          OptionInfo{1, 255, "", "Under which the agent speaks, with the vehicle's system id"});
    field("heartbeat_timeout_s", self.heartbeat_timeout_s,
          OptionInfo{1.5, 60.0, "s", "Then the autopilot counts as silent"});
    field("position_timeout_s", self.position_timeout_s,
          OptionInfo{0.2, 10.0, "s", "Then its position counts as lost"});
    field("setpoint_rate_hz", self.setpoint_rate_hz, OptionInfo{4.0, 50.0, "Hz", "PX4 needs more than 2"});
    field("pose_rate_hz", self.pose_rate_hz,
          OptionInfo{5.0, 200.0, "Hz", "Asked for: position, attitude, gimbal"});
    field("arm_timeout_s", self.arm_timeout_s,
          OptionInfo{1.0, 300.0, "s", "Then the takeoff fails, with the reason that the autopilot gives"});
    field("reference_height_m", self.reference_height_m,
          OptionInfo{-2.0, 5.0, "m", "Height of the vehicle's centre over ground when the autopilot says 0"});
    field(
        "position_std_m", self.position_std_m,
        OptionInfo{0.0, 10.0, "m",
                   "Of the reported position, per axis, within one flight; more when the sensors contradict "
                   "the estimator"});
    field(
        "orientation_std_rad", self.orientation_std_rad,
        OptionInfo{0.0, 0.5, "rad", "Of the reported attitude, per axis; more when the compass contradicts"});
    field("max_estimator_ratio", self.max_estimator_ratio,
          OptionInfo{0.1, 10.0, "", "Innovation test ratio of the estimator: above, poses are not trusted"});
    field("max_position_error_m", self.max_position_error_m,
          OptionInfo{0.01, 100.0, "m", "The same for the error that PX4's estimator expects of itself"});
  }
};

/// Speaks with one MAVLink autopilot: takes its messages, keeps what they tell, and finds the messages that
/// bring about an intent.
///
/// ArduPilot Copter is flown in GUIDED, PX4 in OFFBOARD. Nothing is sent but what is needed for the present
/// intent, and everything is repeated until the vehicle does it: message intervals after a reboot or when
/// another station has slowed them down, modes, arming, takeoff. Pure: no socket, clock or thread; the same
/// messages at the same times give the same bytes.
class AutopilotClient {
 public:
  /// @param has_gimbal  Whether there is a gimbal to aim, and to be asked for its attitude.
  explicit AutopilotClient(const AutopilotOptions& options, bool has_gimbal = false);

  /// Messages of other systems, and of components other than autopilot and gimbal, are left alone.
  void Receive(const mavlink::Frame& frame, Instant now);

  /// What has to be sent now; call it at 20 Hz or faster.
  std::vector<std::vector<std::uint8_t>> Pursue(const Intent& intent, Instant now);

  Telemetry Report(Instant now) const;
  const PoseBuffer& poses() const { return poses_; }
  bool TrustsPoses(Instant now) const;  ///< The estimator is well, and the clocks are tied.
  std::optional<double> ClockUncertainty_s() const;

  /// A line for the pilot's ground station, which the autopilot passes on.
  void Announce(const std::string& text);

  /// Whether the autopilot's parameters were read, and which of them are not safe.
  bool KnowsParameters() const { return target_system_ != 0 && parameters_.IsDone(); }
  std::vector<std::string> ListUnsafeParameters() const {
    return FindUnsafeParameters(dialect_, parameters_.values());
  }

  /// What the autopilot told people since the last call, and what was noticed about it.
  std::vector<std::string> TakeNotes();

 private:
  /// A message that the agent lives on, and how often it wants it; 0: once, by request.
  struct WantedMessage {
    std::uint32_t id;
    double rate_hz;
  };

  struct Ask {
    Instant sent;
    bool was_sent = false;
    std::optional<std::uint8_t> result;
  };

  bool TakeHeartbeat(const mavlink::Frame& frame, Instant now);
  void TakeFromAutopilot(const mavlink::Frame& frame, Instant now);
  void TakeFromGimbal(const mavlink::Frame& frame, Instant now);
  void TakePosition(const mavlink::LocalPositionNed& message, Instant now);
  void TakeAttitude(const mavlink::AttitudeQuaternion& message, Instant now);
  void TakeBattery(std::int8_t percent);
  void TakeText(const mavlink::Statustext& message, Instant now);
  void TakeTimesync(const mavlink::Timesync& message, Instant now);
  std::optional<std::int64_t> StampOf(std::uint32_t time_boot_ms, Instant now);
  void ForgetAfterReboot();

  bool IsConnected(Instant now) const;
  bool HasPosition(Instant now) const;
  bool HasEstimate() const;
  std::string FindEstimateProblem() const;
  std::string FindReadinessProblem(Instant now) const;
  std::string LastComplaint(Instant now) const;

  void KeepContact(Instant now);
  void AskForMessages(Instant now);
  void AskForParameters(Instant now);
  void SetMissingHome(Instant now);
  std::vector<WantedMessage> ListWantedMessages() const;
  bool HasComeOnce(std::uint32_t message_id) const;
  void PursueTakeOff(const Intent& intent, Instant now);
  void PursueFlyTo(const Intent& intent, Instant now);
  void PursueLand(Instant now);
  void PursueNone(Instant now);
  void AimGimbal(const Intent& intent, Instant now);
  void SendSetpoint(const Eigen::Vector3d& in_map_m, double yaw_rad, Instant now);
  void SendCommand(mavlink::CommandLong command, double every_s, Instant now);
  template <class Message>
  void Send(const Message& message) {
    outbox_.push_back(encoder_.Encode(message));
  }
  void Note(std::string text) { notes_.push_back(std::move(text)); }

  AutopilotOptions options_;
  bool has_gimbal_;
  mavlink::Encoder encoder_;
  std::vector<std::vector<std::uint8_t>> outbox_;
  std::vector<std::vector<std::uint8_t>> announcing_;
  std::vector<std::string> notes_;

  Dialect dialect_ = Dialect::kUnknown;
  std::uint8_t target_system_ = 0;
  mavlink::Heartbeat heartbeat_;
  Instant heartbeat_at_;
  std::map<std::uint32_t, mavlink::Arrivals> arrivals_;  ///< By message id, on the steady clock.
  std::map<std::uint32_t, Instant> requests_;
  std::uint8_t landed_state_ = 0;
  std::uint8_t gps_fix_ = 0;
  std::uint16_t estimator_flags_ = 0;
  double estimator_ratio_ = 0.0;
  double compass_ratio_ = 0.0;
  double estimator_accuracy_m_ = 0.0;  ///< 0: not told.
  std::optional<bool> passes_prearm_;
  double battery_ratio_ = -1.0;
  std::string complaint_;
  Instant complaint_at_;

  ParameterWatch parameters_;
  bool has_told_parameters_ = false;
  std::uint16_t announcements_ = 0;
  Instant home_missing_since_;

  MapFrame frame_;
  ClockOffset clock_;
  PoseBuffer poses_;
  std::uint32_t newest_boot_ms_ = 0;
  mavlink::LocalPositionNed position_;
  Instant position_at_;
  Eigen::Quaterniond map_from_body_ = Eigen::Quaterniond::Identity();
  double rotation_rate_radps_ = 0.0;
  Instant attitude_at_;
  std::optional<double> gimbal_pitch_rad_;

  Intent::Kind pursued_ = Intent::Kind::kNone;
  std::uint32_t order_ = 0;
  Instant pursued_since_;
  std::string intent_problem_;
  bool has_asked_to_land_ = false;
  std::map<std::uint16_t, Ask> asks_;  ///< By command.
  Instant setpoint_sent_;
  Instant gimbal_sent_;
  std::optional<double> gimbal_wanted_rad_;
  Instant heartbeat_sent_;
  Instant timesync_sent_;
};

}  // namespace soffit
