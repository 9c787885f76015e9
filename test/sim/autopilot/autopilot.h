#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/flight/flight.h"
#include "test/sim/autopilot/flight_control.h"
#include "test/sim/autopilot/gimbal.h"
#include "test/sim/autopilot/ned.h"
#include "test/sim/autopilot/parameters.h"
#include "test/sim/autopilot/telemetry.h"
#include "vehicle_agent/mavlink/codec.h"
#include "vehicle_agent/mavlink/constants.h"

namespace soffit::sim {

struct AutopilotOptions {
  GeodeticOrigin map_origin;
  bool is_quick_start = false;  ///< Ready after 3 s instead of after 41 s (ArduPilot) or 15 s (PX4).
  std::uint8_t system_id = 1;
  std::size_t link_count = 1;  ///< Each has its own streams and answers.
};

/// What an autopilot feels at one step.
struct Senses {
  Estimate estimate;
  bool is_on_ground = true;
  double battery_ratio = 1.0;
  std::int64_t utc_ns = 0;
};

/// A COMMAND_LONG or COMMAND_INT.
struct CommandRequest {
  std::uint16_t command = 0;
  double param1 = 0.0;
  double param2 = 0.0;
  double param3 = 0.0;
  double param4 = 0.0;
  double x = 0.0;  ///< COMMAND_LONG's param5; COMMAND_INT's x in its own unit.
  double y = 0.0;
  double z = 0.0;
  std::uint8_t frame = mavlink::kFrameGlobalRelativeAlt;
};

/// One of an autopilot's modes.
struct FlightMode {
  std::uint32_t number = 0;  ///< As in the heartbeat's custom_mode.
  const char* name = "";
  bool needs_position = true;
  bool can_arm = true;
};

/// A setpoint in the map. What it does not say is none.
struct Setpoint {
  std::optional<Eigen::Vector3d> position_m;
  std::optional<Eigen::Vector3d> velocity_mps;
  std::optional<double> heading_rad;  ///< As sent, even NaN: clockwise, from north or from the nose.
};

/// A simulated autopilot: takes MAVLink packets, gives MAVLink packets, flies a vehicle step by step. Here is
/// what all autopilots have in common; how each of them behaves is in ardupilot.cc and px4.cc.
///
/// It answers on the link on which it was asked, and a stream runs on the link that asked for it. Heartbeats
/// of other components are passed on to the other links.
class Autopilot {
 public:
  virtual ~Autopilot() = default;

  void Receive(const mavlink::Frame& frame, std::size_t link = 0);
  MotorCommand Step(const Senses& senses, double dt_s);
  std::vector<std::vector<std::uint8_t>> TakePackets(std::size_t link = 0) {
    return links_.at(link).TakePackets();
  }

  bool is_armed() const { return is_armed_; }
  bool is_landed() const { return is_landed_; }
  std::string ModeName() const { return FindMode(mode_)->name; }
  const Gimbal& gimbal() const { return gimbal_; }

  // What a test does to it.
  bool PilotSelects(const std::string& mode);  ///< By radio, sticks centred. False: no such mode.
  void SetGps(bool is_there);
  void SetRadio(bool is_there);
  void Reboot();
  void Crash();  ///< Disarms whatever the state.

 protected:
  Autopilot(const AutopilotOptions& options, std::map<std::string, double> parameters,
            std::vector<FlightMode> modes);

  // How an autopilot differs from the others.
  virtual void Boot() = 0;
  virtual mavlink::CommandResult Execute(const CommandRequest& request) = 0;
  virtual void TakeSetpoint(const mavlink::SetPositionTargetLocalNed& setpoint) = 0;
  virtual void TakeHeartbeat(const mavlink::Frame&) {}
  virtual void SetDataStream(const mavlink::RequestDataStream&) {}
  virtual void Describe(Report& report) const = 0;
  virtual mavlink::CommandResult Refusal() const = 0;  ///< Of what it would do at another time.
  virtual mavlink::CommandResult RefuseToDisarm() = 0;
  virtual std::string ReasonNotToArm() const = 0;  ///< Empty: it may be armed.
  virtual void Disarm() = 0;
  virtual void Locate() = 0;  ///< Each step until there is an origin, while there is GPS.
  virtual FlightLimits Limits() const = 0;
  virtual void OnEnter() {}  ///< A mode was entered, and holds its place.
  // Each step while it is armed, in this order.
  virtual void CheckFailsafes() = 0;
  virtual void Fly() = 0;  ///< Sets goal_.
  virtual void CheckLanded() = 0;

  // Common parts of Execute; the commands that every autopilot knows.
  mavlink::CommandResult ExecuteCommon(const CommandRequest& request);
  void SetHome(const Eigen::Vector3d& in_map_m);
  void SetOrigin(const Eigen::Vector3d& in_map_m);
  void Announce(std::uint8_t severity, std::string_view text);
  void SetIntervalOnAllLinks(std::uint32_t message_id, double interval_s);
  Telemetry& asking_link() { return links_[asking_link_]; }
  const FlightMode* FindMode(double number) const;  ///< None: no such mode.
  void Enter(std::uint32_t mode);
  /// None without an origin, or for a frame or numbers that mean nothing.
  std::optional<Setpoint> ToMap(const mavlink::SetPositionTargetLocalNed& setpoint) const;
  void FlyTo(const Eigen::Vector3d& position_m);
  void FlyAt(const Eigen::Vector3d& velocity_mps);
  void Sink(double speed_mps);  ///< Straight down over target_m_.
  double SecondsSince(double boot_s) const { return boot_s_ - boot_s; }
  Eigen::Vector3d StoppingPoint() const;
  Report MakeReport() const;

  const AutopilotOptions options_;
  Parameters parameters_;
  FlightControl control_;
  Gimbal gimbal_;
  std::optional<NedFrame> frame_;
  std::optional<Eigen::Vector3d> home_in_map_m_;
  Senses senses_;
  FlightGoal goal_;
  FlightLimits limits_;
  std::uint32_t mode_ = 0;
  Eigen::Vector3d target_m_ = Eigen::Vector3d::Zero();
  double yaw_rad_ = 0.0;
  double setpoint_s_ = 0.0;  ///< When the newest setpoint came.
  double armed_s_ = 0.0;
  double idle_since_s_ = 0.0;
  bool is_failsafe_ = false;
  double boot_s_ = 0.0;
  bool is_armed_ = false;
  bool is_landed_ = true;
  bool has_gps_ = true;
  bool has_radio_ = false;
  double gps_changed_s_ = 0.0;
  double radio_lost_s_ = 0.0;
  double last_heartbeat_of_gcs_s_ = -1.0;

 private:
  void PassOn(const mavlink::Frame& frame);
  void AnswerCommand(const mavlink::Frame& frame, const CommandRequest& request);
  void AnswerTimesync(const mavlink::Frame& frame, const mavlink::Timesync& request);
  mavlink::CommandResult ArmOrDisarm(const CommandRequest& request);
  void Update();
  bool IsForUs(std::uint8_t system, std::uint8_t component) const;
  std::int64_t BootNs() const { return static_cast<std::int64_t>(boot_s_ * 1e9); }

  const std::vector<FlightMode> modes_;
  std::vector<Telemetry> links_;
  std::size_t asking_link_ = 0;
  double next_timesync_s_ = 1.0;
};

std::unique_ptr<Autopilot> MakeArduPilot(const AutopilotOptions& options);
std::unique_ptr<Autopilot> MakePx4(const AutopilotOptions& options);

}  // namespace soffit::sim
