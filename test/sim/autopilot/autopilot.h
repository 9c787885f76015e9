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

/// A simulated autopilot: takes MAVLink packets, gives MAVLink packets, flies a vehicle step by step. Here is
/// what all autopilots have in common; how each of them behaves is in ardupilot.cc and px4.cc.
///
/// It answers on the link on which it was asked, and a stream runs on the link that asked for it. Heartbeats of
/// other components are passed on to the other links.
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
  virtual std::string ModeName() const = 0;
  const Gimbal& gimbal() const { return gimbal_; }

  // What a test does to it.
  virtual bool PilotSelects(const std::string& mode) = 0;  ///< By radio, sticks centred. False: no such mode.
  void SetGps(bool is_there);
  void SetRadio(bool is_there);
  void Reboot();
  void Crash();  ///< Disarms whatever the state.

 protected:
  Autopilot(const AutopilotOptions& options, std::map<std::string, double> parameters);

  // How an autopilot differs from the others.
  virtual void Boot() = 0;
  virtual mavlink::CommandResult Execute(const CommandRequest& request) = 0;
  virtual void TakeSetpoint(const mavlink::SetPositionTargetLocalNed& setpoint) = 0;
  virtual void TakeHeartbeat(const mavlink::Frame&) {}
  virtual void SetDataStream(const mavlink::RequestDataStream&) {}
  virtual void Update(double dt_s) = 0;  ///< Modes and failsafes, each step; sets goal_ and limits_.
  virtual void Describe(Report& report) const = 0;

  // Common parts of Execute; the commands that every autopilot knows.
  mavlink::CommandResult ExecuteCommon(const CommandRequest& request);
  void SetHome(const Eigen::Vector3d& in_map_m);
  void SetOrigin(const Eigen::Vector3d& in_map_m);
  void Announce(std::uint8_t severity, std::string_view text);
  void SetIntervalOnAllLinks(std::uint32_t message_id, double interval_s);
  Telemetry& asking_link() { return links_[asking_link_]; }
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
  bool IsForUs(std::uint8_t system, std::uint8_t component) const;
  std::int64_t BootNs() const { return static_cast<std::int64_t>(boot_s_ * 1e9); }

  std::vector<Telemetry> links_;
  std::size_t asking_link_ = 0;
  double next_timesync_s_ = 1.0;
};

std::unique_ptr<Autopilot> MakeArduPilot(const AutopilotOptions& options);
std::unique_ptr<Autopilot> MakePx4(const AutopilotOptions& options);

}  // namespace soffit::sim
