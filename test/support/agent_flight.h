#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "test/support/fake_vehicle.h"
#include "vehicle_agent/agent/agent.h"

namespace soffit {

/// An agent, its vehicle, and a service that may fall silent.
class Flight {
 public:
  static constexpr double kStep_s = 0.05;

  explicit Flight(AgentOptions options = {}, GuardOptions guard = {})
      : agent(MakeAgent(options, guard, now)) {
    Run(options.rival_listen_s + 0.5);
  }

  static Agent MakeAgent(const AgentOptions& options, const GuardOptions& guard, Instant now) {
    AgentIdentity identity;
    identity.vehicle_id = 7;
    identity.epoch = 100;
    identity.name = "kite";
    identity.envelope = {0.35, 0.30, 0.25};
    identity.cameras = {CameraId::kForward, CameraId::kDown};
    return Agent(identity, options, guard, now);
  }

  void Take(AgentOutputs outputs) {
    acks.insert(acks.end(), outputs.acks.begin(), outputs.acks.end());
    notes.insert(notes.end(), outputs.notes.begin(), outputs.notes.end());
    if (!outputs.exposure) return;
    exposures.push_back(*outputs.exposure);
    if (answers_pictures) Say(PictureOutcome{outputs.exposure->request_id, picture_problem});
  }
  void Say(const AgentEvent& event) { Take(agent.Step(event, now)); }

  void Run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / kStep_s); ++i) {
      now.steady_ns += ToNanoseconds(kStep_s);
      now.utc_ns += ToNanoseconds(kStep_s);
      vehicle.Follow(agent.intent(), kStep_s);
      vehicle.telemetry().position_in_map_m += gust_m;
      Telemetry heard = vehicle.telemetry();
      distort(heard);
      Say(heard);
      if (service_lives) Say(ServiceHeartbeat{3});
      Say(Beat{});
      highest_m = std::max(highest_m, position().z());
    }
  }
  /// Runs until the latest command is done or failed, for at most `seconds`.
  AckStatus RunToEnd(double seconds = 120.0) {
    for (double t = 0.0; t < seconds; t += 0.5) {
      Run(0.5);
      if (LastStatus() == AckStatus::kDone || LastStatus() == AckStatus::kFailed) break;
    }
    return LastStatus();
  }

  FlightCommand Make(CommandKind kind, std::vector<Eigen::Vector3d> path = {}) {
    FlightCommand command;
    command.vehicle_id = 7;
    command.mission_id = 3;
    command.sequence = ++sequence;
    command.valid_until_utc_ns = now.utc_ns + 5'000'000'000;
    command.kind = kind;
    command.path_in_map_m = std::move(path);
    command.speed_mps = kind == CommandKind::kFlyCorridor ? 0.6 : 2.0;
    if (kind == CommandKind::kLook) {
      command.capture_id = 40 + sequence;
      command.purpose = Purpose::kWall;
    }
    if (kind == CommandKind::kFlyCorridor) {
      command.permit = CorridorPermit{11, 2, 6, now.utc_ns + 60'000'000'000, {0.35, 0.30, 0.25}, 1.65, 1.5};
    }
    return command;
  }
  AckStatus Do(CommandKind kind, std::vector<Eigen::Vector3d> path = {}) {
    Say(Make(kind, std::move(path)));
    return RunToEnd();
  }
  void FlyToEntry() {
    ASSERT_EQ(Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
    ASSERT_EQ(Do(CommandKind::kGoTo, {{4.0, 0.0, 3.0}, {4.0, 0.0, 1.0}}), AckStatus::kDone);
  }
  /// Begins the corridor along x from 4 to 10 m and flies until x is beyond `x_m`.
  void FlyIntoCorridor(double x_m) {
    FlyToEntry();
    Say(Make(CommandKind::kFlyCorridor, {{4.0, 0.0, 1.0}, {10.0, 0.0, 1.0}}));
    for (int i = 0; i < 200 && position().x() < x_m; ++i) Run(2.0 * kStep_s);
    ASSERT_GT(position().x(), x_m);
    ASSERT_EQ(phase(), VehiclePhase::kInCorridor);
    highest_m = position().z();
  }

  AckStatus LastStatus() const { return acks.empty() ? AckStatus::kUnknown : acks.back().status; }
  std::string LastReason() const { return acks.empty() ? "" : acks.back().reason; }
  const Eigen::Vector3d& position() { return vehicle.telemetry().position_in_map_m; }
  VehiclePhase phase() const { return agent.Describe(now).phase; }
  std::string message() const { return agent.Describe(now).message; }

  Instant now{1'000'000'000, 1'700'000'000'000'000'000};
  FakeVehicle vehicle;
  Agent agent;
  std::vector<CommandAck> acks;
  std::vector<ExposureRequest> exposures;
  std::vector<std::string> notes;
  bool service_lives = true;
  bool answers_pictures = true;
  std::string picture_problem;
  std::function<void(Telemetry&)> distort = [](Telemetry&) {};  ///< What the agent hears of the vehicle.
  Eigen::Vector3d gust_m = Eigen::Vector3d::Zero();
  std::uint32_t sequence = 0;
  double highest_m = 0.0;
};

}  // namespace soffit
