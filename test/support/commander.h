#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "shared/dds/reader.h"
#include "shared/dds/writer.h"
#include "shared/wire/topics.h"

namespace soffit {

/// The side of the service that commands a vehicle, as small as it can be: it sends a command again and again
/// until it is answered, says that it lives, and keeps what comes back.
class Commander {
 public:
  Commander(const Participant& radio, std::uint32_t vehicle_id, std::uint64_t mission_id)
      : vehicle_id_(vehicle_id),
        mission_id_(mission_id),
        commands_(radio),
        heartbeats_(radio),
        acks_(radio, [this](const CommandAck& ack) { Keep(ack, kept_acks_); }),
        states_(radio, [this](const VehicleState& state) { Keep(state, kept_states_); }),
        captures_(radio, [this](const Capture& capture) { Keep(capture, kept_captures_); }) {}

  /// Sends the command until it is done, failed or refused; none when that takes longer than `timeout_s`.
  std::optional<CommandAck> Do(FlightCommand command, double timeout_s) {
    command.vehicle_id = vehicle_id_;
    command.mission_id = mission_id_;
    command.sequence = ++sequence_;
    command.valid_until_utc_ns = NowUtc_ns() + 30'000'000'000;
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
    for (int beat = 0; std::chrono::steady_clock::now() < until; ++beat) {
      if (beat % 10 == 0 && !FindAck(sequence_)) commands_.Write(command);
      Live();
      const auto ack = FindAck(sequence_);
      if (ack && ack->status != AckStatus::kAccepted) return ack;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return std::nullopt;
  }

  bool WaitFor(const std::function<bool(const VehicleState&)>& is_so, double timeout_s) {
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
    while (std::chrono::steady_clock::now() < until) {
      const auto states = States();
      if (!states.empty() && is_so(states.back())) return true;
      Live();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  void Live() {
    MissionHeartbeat heartbeat;
    heartbeat.vehicle_id = vehicle_id_;
    heartbeat.mission_id = mission_id_;
    heartbeat.stamp_utc_ns = NowUtc_ns();
    heartbeats_.Write(heartbeat);
  }

  std::vector<VehicleState> States() { return Copy(kept_states_); }
  std::vector<Capture> Captures() { return Copy(kept_captures_); }
  std::vector<CommandAck> Acks() { return Copy(kept_acks_); }

  static std::int64_t NowUtc_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  }

 private:
  template <class T>
  void Keep(const T& value, std::vector<T>& kept) {
    const std::lock_guard lock(mutex_);
    kept.push_back(value);
  }
  template <class T>
  std::vector<T> Copy(const std::vector<T>& kept) {
    const std::lock_guard lock(mutex_);
    return kept;
  }
  std::optional<CommandAck> FindAck(std::uint32_t sequence) {
    std::optional<CommandAck> found;
    for (const CommandAck& ack : Acks()) {
      if (ack.mission_id == mission_id_ && ack.sequence == sequence) found = ack;
    }
    return found;
  }

  std::uint32_t vehicle_id_;
  std::uint64_t mission_id_;
  std::uint32_t sequence_ = 0;
  std::mutex mutex_;
  std::vector<CommandAck> kept_acks_;
  std::vector<VehicleState> kept_states_;
  std::vector<Capture> kept_captures_;
  Writer<FlightCommandTopic> commands_;
  Writer<MissionHeartbeatTopic> heartbeats_;
  Reader<CommandAckTopic> acks_;
  Reader<VehicleStateTopic> states_;
  Reader<CaptureTopic> captures_;
};

}  // namespace soffit
