#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "test/sim/autopilot/ned.h"
#include "test/sim/vehicle/estimator.h"
#include "vehicle_agent/mavlink/codec.h"

namespace soffit::sim {

/// All that the telemetry tells, as it is at one moment.
struct Report {
  double boot_s = 0.0;  ///< Since the autopilot's start.
  std::int64_t utc_ns = 0;
  Estimate estimate;
  const NedFrame* frame = nullptr;  ///< None: no origin yet.
  std::optional<Eigen::Vector3d> home_in_map_m;
  bool has_position = false;
  std::uint8_t autopilot = 0;
  std::uint8_t base_mode = 0;
  std::uint32_t custom_mode = 0;
  std::uint8_t system_status = 0;
  std::uint8_t landed_state = 0;
  bool is_ready_to_arm = false;
  std::uint16_t estimator_flags = 0;
  bool has_gps = false;
  bool has_radio = false;
  double battery_ratio = 1.0;
  std::uint8_t battery_charge_state = 1;
  double throttle_ratio = 0.0;  ///< Of the pilot's stick.
  std::optional<Eigen::Vector3d> target_in_map_m;
  double gimbal_pitch_rad = 0.0;
  double gimbal_yaw_from_nose_rad = 0.0;
  double gimbal_yaw_from_north_rad = 0.0;
  bool is_gimbal_yaw_against_north = false;
};

/// The messages of one link: which are sent how often, and what stands in them.
class Telemetry {
 public:
  Telemetry(std::uint8_t system_id, std::uint8_t component_id) : encoder_(system_id, component_id) {}

  /// Seconds between two of these messages; 0 stops them. False: no such message here.
  bool SetInterval(std::uint32_t message_id, double interval_s);
  std::optional<double> Interval(std::uint32_t message_id) const;  ///< None: no such message; 0: not sent.
  void Stop() { streams_.clear(); }

  /// Sends what is due.
  void Step(const Report& report);
  /// Sends one message now; false when there is none, or nothing to tell in it.
  bool SendNow(std::uint32_t message_id, const Report& report);

  template <class Message>
  void Send(const Message& message) {
    packets_.push_back(encoder_.Encode(message));
  }
  void SendText(std::uint8_t severity, std::string_view text);
  /// A packet of another sender, as it came.
  void PassOn(const mavlink::Frame& frame) { packets_.push_back(mavlink::Pack(frame)); }

  /// The packets since the last call.
  std::vector<std::vector<std::uint8_t>> TakePackets() { return std::exchange(packets_, {}); }

 private:
  struct Stream {
    double interval_s = 0.0;
    double next_s = 0.0;
  };

  mavlink::Encoder encoder_;
  std::map<std::uint32_t, Stream> streams_;
  std::vector<std::vector<std::uint8_t>> packets_;
};

}  // namespace soffit::sim
