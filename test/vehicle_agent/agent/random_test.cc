#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "test/support/agent_flight.h"

// Missions in which anything may fail, be taken over or be commanded at any moment: what must never happen.
namespace soffit {
namespace {

const Eigen::Vector3d kEntry_m(4.0, 0.0, 1.0);
const Eigen::Vector3d kExit_m(10.0, 0.0, 1.0);

class Misfortunes {
 public:
  explicit Misfortunes(std::uint64_t seed) : random_(seed) {}

  void Strike(Flight& flight) {
    switch (Draw(14)) {
      case 0:
        has_pilot_ = !has_pilot_;
        break;
      case 1:
        flight.service_lives = !flight.service_lives;
        break;
      case 2:
        has_position_ = !has_position_;
        break;
      case 3:
        hears_autopilot_ = !hears_autopilot_;
        break;
      case 4:
        is_doubtful_ = !is_doubtful_;
        break;
      case 5:
        flight.Say(Draw(2) == 0 ? CameraHealth{} : CameraHealth{{{CameraId::kForward, "no answer"}}});
        break;
      case 6:
        battery_ratio_ = Draw(4) == 0 ? 0.1 : 0.9;
        break;
      case 7:
        flight.gust_m = Draw(3) == 0 ? Eigen::Vector3d(0.0, 0.05, 0.0) : Eigen::Vector3d::Zero();
        break;
      default:
        Command(flight);
    }
    flight.distort = [this](Telemetry& heard) { Distort(heard); };
  }

  /// All is well again, so that the next mission gets anywhere.
  void Relent(Flight& flight) {
    has_pilot_ = is_doubtful_ = false;
    has_position_ = hears_autopilot_ = flight.service_lives = true;
    battery_ratio_ = 0.9;
    flight.gust_m.setZero();
    flight.Say(CameraHealth{});
  }

  bool IsPilotHeard() const { return has_pilot_ && hears_autopilot_; }

 private:
  int Draw(int count) { return std::uniform_int_distribution<int>(0, count - 1)(random_); }
  double Draw(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  void Distort(Telemetry& heard) const {
    heard.is_in_our_mode = !has_pilot_;
    heard.battery_ratio = battery_ratio_;
    if (is_doubtful_) heard.position_doubt = "no GPS";
    if (!has_position_) {
      heard.has_position = false;
      heard.position_in_map_m.setZero();
    }
    if (!hears_autopilot_) heard = {};
  }

  void Command(Flight& flight) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    const auto kind = static_cast<CommandKind>(Draw(8));  // One of them unknown.
    std::vector<Eigen::Vector3d> path = {{Draw(-20.0, 20.0), Draw(-20.0, 20.0), Draw(-1.0, 70.0)}};
    if (Draw(3) == 0) path = {{4.0, 0.0, 3.0}, kEntry_m};
    if (kind == CommandKind::kFlyCorridor) path = {kEntry_m, kExit_m};
    if (kind == CommandKind::kTakeOff) path.resize(1);
    FlightCommand command = flight.Make(kind, path);
    if (Draw(8) == 0) command.valid_until_utc_ns = flight.now.utc_ns - 1;
    if (Draw(8) == 0) command.speed_mps = Draw(2) == 0 ? kNan : 40.0;
    if (Draw(8) == 0 && command.permit) command.permit->free_width_m = 1.0;
    if (Draw(8) == 0) command.path_in_map_m.front().x() = kNan;
    flight.Say(command);
  }

  std::mt19937_64 random_;
  bool has_pilot_ = false;
  bool has_position_ = true;
  bool hears_autopilot_ = true;
  bool is_doubtful_ = false;
  double battery_ratio_ = 0.9;
};

/// Whether the vehicle, since it entered the corridor, has not been outside of it.
class UnderSoffit {
 public:
  bool Follow(Flight& flight) {
    const Eigen::Vector3d& position = flight.position();
    const bool is_there = position.x() > kEntry_m.x() + 0.5 && position.x() < kExit_m.x() - 0.5 &&
                          std::abs(position.y()) < 1.0 && position.z() > 0.2;
    is_under_ = is_there && (is_under_ || flight.phase() == VehiclePhase::kInCorridor);
    return is_under_;
  }

 private:
  bool is_under_ = false;
};

/// Accepted commands that were neither done nor failed yet. An answer may be repeated.
std::size_t CountOpenCommands(const Flight& flight) {
  std::set<std::uint32_t> accepted;
  std::map<std::uint32_t, AckStatus> ends;
  for (const CommandAck& ack : flight.acks) {
    if (ack.status == AckStatus::kAccepted) accepted.insert(ack.sequence);
    if (ack.status != AckStatus::kDone && ack.status != AckStatus::kFailed) continue;
    EXPECT_EQ(ends.try_emplace(ack.sequence, ack.status).first->second, ack.status);
  }
  return accepted.size() - ends.size();
}

class AnythingMayHappen : public ::testing::TestWithParam<int> {};

TEST_P(AnythingMayHappen, ButThePilotWinsAndNothingClimbsUnderASoffit) {
  Flight flight;
  Misfortunes misfortunes(static_cast<std::uint64_t>(GetParam()));
  UnderSoffit soffit;
  int steps_under_soffit = 0;
  for (int round = 0; round < 40; ++round) {
    misfortunes.Relent(flight);
    flight.Run(3.0);
    if (!flight.vehicle.telemetry().is_in_air) flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}});
    flight.Do(CommandKind::kGoTo, {{4.0, 0.0, 3.0}, kEntry_m});
    flight.Say(flight.Make(CommandKind::kFlyCorridor, {kEntry_m, kExit_m}));
    flight.Run(8.0);
    for (int step = 0; step < 60; ++step) {
      if (step % 6 == 0) misfortunes.Strike(flight);
      flight.Run(Flight::kStep_s);
      const Intent& intent = flight.agent.intent();
      ASSERT_TRUE(intent.position_in_map_m.allFinite());
      ASSERT_LT(intent.position_in_map_m.z(), GuardOptions{}.ceiling_m + 0.1);
      ASSERT_LE(CountOpenCommands(flight), 1u) << "each command ends once";
      if (misfortunes.IsPilotHeard() && flight.vehicle.telemetry().is_armed) {
        ASSERT_EQ(intent.kind, Intent::Kind::kNone);
      }
      if (soffit.Follow(flight)) {
        ++steps_under_soffit;
        ASSERT_NE(intent.kind, Intent::Kind::kTakeOff);
        ASSERT_LT(intent.position_in_map_m.z(), kEntry_m.z() + 0.1);
        ASSERT_LT(flight.position().z(), kEntry_m.z() + 0.1);
      }
    }
  }
  EXPECT_GT(steps_under_soffit, 500);
}

INSTANTIATE_TEST_SUITE_P(Seeds, AnythingMayHappen, ::testing::Range(0, 50));

}  // namespace
}  // namespace soffit
