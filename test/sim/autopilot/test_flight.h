#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "test/sim/autopilot/autopilot.h"
#include "test/sim/vehicle/estimator.h"
#include "test/sim/vehicle/multicopter.h"

namespace soffit::sim {

/// A vehicle in still air with a simulated autopilot, flown by a test in its own time.
class TestFlight {
 public:
  static constexpr double kStep_s = 0.005;

  explicit TestFlight(std::unique_ptr<Autopilot> pilot, std::uint8_t system_id = 1)
      : autopilot(std::move(pilot)), encoder_(system_id, mavlink::kComponentOnboardComputer) {}

  void Run(double seconds) {
    for (const double end_s = time_s + seconds; time_s < end_s - 0.5 * kStep_s; time_s += kStep_s) {
      const BodyState& state = vehicle.state();
      const Estimate estimate = estimator.Step(state, kStep_s);
      const MotorCommand command = autopilot->Step(
          {estimate, state.is_on_ground, state.battery_ratio, 1'700'000'000'000'000'000}, kStep_s);
      vehicle.Step(command, Eigen::Vector3d::Zero(), kStep_s);
      Collect();
    }
  }

  /// Runs until `is_done`, and tells how long it took; none after `limit_s`.
  template <class Predicate>
  std::optional<double> RunUntil(Predicate is_done, double limit_s = 120.0) {
    const double start_s = time_s;
    while (time_s - start_s < limit_s) {
      if (is_done()) return time_s - start_s;
      Run(kStep_s);
    }
    return std::nullopt;
  }

  template <class Message>
  void Send(const Message& message) {
    for (const mavlink::Frame& frame : from_test_.Feed(encoder_.Encode(message))) autopilot->Receive(frame);
    Collect();
  }

  /// Sends a COMMAND_LONG and gives the result in its acknowledgement; none when there was none.
  std::optional<int> Command(std::uint16_t command, std::vector<float> params = {}, std::uint8_t system = 1) {
    params.resize(7, 0.0F);
    mavlink::CommandLong m;
    m.target_system = system;
    m.target_component = mavlink::kComponentAutopilot;
    m.command = command;
    m.param1 = params[0];
    m.param2 = params[1];
    m.param3 = params[2];
    m.param4 = params[3];
    m.param5 = params[4];
    m.param6 = params[5];
    m.param7 = params[6];
    const std::size_t before = Count<mavlink::CommandAck>();
    Send(m);
    if (Count<mavlink::CommandAck>() == before) return std::nullopt;
    return Last<mavlink::CommandAck>()->result;
  }

  /// A position (NED) with a heading, as the agent sends it.
  void GoTo(float north_m, float east_m, float down_m, float heading_rad = 0.0F) {
    mavlink::SetPositionTargetLocalNed m;
    m.target_system = 1;
    m.target_component = mavlink::kComponentAutopilot;
    m.coordinate_frame = mavlink::kFrameLocalNed;
    m.type_mask = mavlink::kPositionAndYaw;
    m.x = north_m;
    m.y = east_m;
    m.z = down_m;
    m.yaw = heading_rad;
    Send(m);
  }

  template <class Message>
  std::optional<Message> Last() const {
    for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) {
      if (auto message = mavlink::Decode<Message>(*frame)) return message;
    }
    return std::nullopt;
  }
  template <class Message>
  std::size_t Count() const {
    return static_cast<std::size_t>(std::count_if(
        frames.begin(), frames.end(), [](const auto& f) { return f.message_id == Message::kId; }));
  }
  bool Heard(const std::string& text) const {
    return std::any_of(frames.begin(), frames.end(), [&](const mavlink::Frame& frame) {
      const auto m = mavlink::Decode<mavlink::Statustext>(frame);
      return m && mavlink::TextOf(m->text).find(text) != std::string::npos;
    });
  }

  const Eigen::Vector3d& position_m() const { return vehicle.state().position_m; }
  double height_m() const { return position_m().z(); }
  double speed_mps() const { return vehicle.state().velocity_mps.norm(); }

  std::unique_ptr<Autopilot> autopilot;
  Multicopter vehicle{BodyState{}};
  Estimator estimator{PoseNoise{}, 1};
  std::vector<mavlink::Frame> frames;  ///< Everything that the autopilot said.
  double time_s = 0.0;

 private:
  void Collect() {
    for (const auto& packet : autopilot->TakePackets()) {
      for (auto& frame : from_autopilot_.Feed(packet)) frames.push_back(std::move(frame));
    }
  }

  mavlink::Encoder encoder_;
  mavlink::FrameParser from_test_;
  mavlink::FrameParser from_autopilot_;
};

}  // namespace soffit::sim
