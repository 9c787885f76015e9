#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "shared/result/result.h"
#include "test/sim/autopilot/autopilot.h"
#include "test/sim/flight/pose_history.h"
#include "test/sim/flight/recorder.h"
#include "vehicle_agent/mavlink/codec.h"

namespace soffit::sim {

/// A vehicle in the world, moved by a simulated autopilot or by another one that is listened to.
class Flight {
 public:
  virtual ~Flight() = default;

  /// A packet from a link, heard at `utc_ns`.
  virtual void Receive(const mavlink::Frame& frame, std::int64_t utc_ns, std::size_t link = 0) = 0;
  /// Moves on to `utc_ns`, step by step.
  virtual void Advance(std::int64_t utc_ns) = 0;
  /// What to send on a link.
  virtual std::vector<std::vector<std::uint8_t>> TakePackets(std::size_t link = 0) = 0;

  /// Makes something go wrong: "pilot LOITER", "gps off|on", "radio off|on", "battery 0.1", "reboot",
  /// "break".
  virtual Status Disturb(const std::string& words) = 0;

  /// State for people and scripts: mode, armed, landed, battery.
  virtual nlohmann::json State() const = 0;

  /// One line of the track per call, under Header().
  virtual std::string TrackLine() const = 0;
  static const char* TrackHeader();

  const PoseHistory& poses() const { return poses_; }
  const FlightRecorder& recorder() const { return recorder_; }

 protected:
  Flight(const World& world, const Space& space, const Truth& truth) : recorder_(world, space, truth) {}

  PoseHistory poses_;
  FlightRecorder recorder_;
};

enum class AutopilotKind { kArduPilot, kPx4 };

struct SimulatedFlightOptions {
  AutopilotKind autopilot = AutopilotKind::kArduPilot;
  bool is_quick_start = false;
  std::uint64_t seed = 0;
  std::int64_t start_utc_ns = 0;
  std::size_t link_count = 1;
};

/// All of it simulated: vehicle, wind, estimator, autopilot. A contact breaks the vehicle: it falls. Same
/// world, seed and packets at the same times: same flight.
std::unique_ptr<Flight> SimulateFlight(const World& world, const Space& space, const Truth& truth,
                                       const SimulatedFlightOptions& options);

/// Follows an autopilot that flies elsewhere: its reported pose is taken as the truth, and the world lies
/// about the first home that it reports, wherever on Earth that is. Asks it for LOCAL_POSITION_NED,
/// ATTITUDE_QUATERNION, HOME_POSITION, GPS_GLOBAL_ORIGIN, EXTENDED_SYS_STATE and the gimbal's attitude, and
/// again when they stop coming or come too slowly. It has one link.
std::unique_ptr<Flight> FollowFlight(const World& world, const Space& space, const Truth& truth);

}  // namespace soffit::sim
