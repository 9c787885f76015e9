#include "service/mission/mission.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "service/mission/transit.h"

namespace soffit {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

Footprint Box(std::uint32_t id, double x, double y, double half_x, double half_y, double height_m) {
  Footprint box;
  box.object_id = id;
  box.polygon_in_map_m.outer = {
      {x - half_x, y - half_y}, {x + half_x, y - half_y}, {x + half_x, y + half_y}, {x - half_x, y + half_y}};
  box.height_m = height_m;
  return box;
}

const VehicleEnvelope kEnvelope{0.35, 0.30, 0.25};

ClearanceDecision Clear(std::uint32_t object_id, int side, double margin_m) {
  ClearanceDecision decision;
  decision.decision_id = 100 * object_id + static_cast<std::uint64_t>(side) + 1;
  decision.object_id = object_id;
  decision.side = side;
  decision.verdict = Verdict::kClear;
  decision.reason = "clear";
  decision.vehicle = kEnvelope;
  decision.margin_left_m = decision.margin_right_m = decision.margin_up_m = decision.margin_down_m = margin_m;
  Corridor corridor;
  corridor.object_id = object_id;
  corridor.entry_in_map_m = {0.0, 5.0, 0.8};
  corridor.exit_in_map_m = {0.0, 9.0, 0.8};
  corridor.free_width_m = 1.65;
  corridor.free_height_m = 1.5;
  decision.corridor = corridor;
  return decision;
}

ClearanceDecision Open(std::uint32_t object_id, const Viewpoint& wanted) {
  ClearanceDecision decision;
  decision.object_id = object_id;
  decision.reason = "the far end was not seen";
  decision.vehicle = kEnvelope;
  decision.wanted = wanted;
  return decision;
}

ClearanceDecision Blocked(std::uint32_t object_id) {
  ClearanceDecision decision;
  decision.object_id = object_id;
  decision.verdict = Verdict::kBlocked;
  decision.reason = "too low by 0.20 m";
  decision.vehicle = kEnvelope;
  return decision;
}

/// A vehicle that does at once what it is told, and a service that sees what the test says.
class Flight {
 public:
  Flight() {
    vehicle.vehicle_id = 7;
    vehicle.agent_epoch = 1;
    vehicle.phase = VehiclePhase::kOnGround;
    vehicle.envelope = kEnvelope;
    vehicle.camera = {1280, 960, 850.0, 850.0, 639.5, 479.5, {}};
    vehicle.max_speed_mps = 5.0;
    findings.map = {Box(1, 0.0, 7.0, 2.0, 0.75, 2.3), Box(2, -6.0, 9.0, 1.0, 1.0, 1.3)};
    findings.wanted = {1};
    findings.decisions = {Clear(1, 0, 0.1)};
    MissionOrder order;
    order.vehicle_id = 7;
    order.mission_id = 42;
    mission = StartMission(order);
    options.resend_s = 2.0;  // A step takes one second.
  }

  void Give(const MissionEvent& event) {
    MissionUpdate update = Advance(std::move(mission), event, now_ns, viewpoints, options);
    mission = std::move(update.mission);
    if (update.wants_findings) is_asked = true;
    for (FlightCommand& command : update.commands) {
      sent.push_back(command);
      if (!is_deaf) inbox.push_back(std::move(command));
    }
  }

  CommandAck Ack(const FlightCommand& command, AckStatus status, const std::string& reason = "") const {
    return {command.vehicle_id,
            command.mission_id,
            command.sequence,
            vehicle.agent_epoch,
            now_ns,
            status,
            reason};
  }

  /// Carries out one command as a perfect vehicle does.
  void Obey(const FlightCommand& command) {
    if (!command.path_in_map_m.empty()) vehicle.position_in_map_m = command.path_in_map_m.back();
    vehicle.armed = command.kind != CommandKind::kLand;
    vehicle.phase = vehicle.armed ? VehiclePhase::kHolding : VehiclePhase::kOnGround;
    Give(Ack(command, AckStatus::kAccepted));
    Give(Ack(command, AckStatus::kDone));
    if (command.kind == CommandKind::kLook) Give(PictureResult{command.capture_id, picture_problem(command)});
  }

  /// One second passes: the vehicle reports, does what it was told, and is seen.
  void Step() {
    now_ns += kSecond_ns / 2;
    if (!is_mute) Give(vehicle);
    std::vector<FlightCommand> todo = std::move(inbox);
    inbox.clear();
    for (const FlightCommand& command : todo) obey(command);
    if (std::exchange(is_asked, false)) {
      ++findings.scene_revision;
      for (ClearanceDecision& decision : findings.decisions)
        decision.scene_revision = findings.scene_revision;
      look(findings);
      Give(findings);
    }
    now_ns += kSecond_ns / 2;
    Give(Tick{});
  }

  void Run(int seconds = 400) {
    for (int i = 0; i < seconds && mission.status.state != MissionState::kEnded; ++i) Step();
  }
  void RunUntil(const std::function<bool()>& condition, int seconds = 400) {
    for (int i = 0; i < seconds && !condition(); ++i) Step();
    ASSERT_TRUE(condition()) << "the mission stands at: " << mission.status.message;
  }
  void RunUntilStep(MissionStep step) {
    RunUntil([&] { return mission.status.step == step; });
  }

  std::vector<CommandKind> Kinds() const {
    std::vector<CommandKind> kinds;
    for (const FlightCommand& command : sent) kinds.push_back(command.kind);
    return kinds;
  }
  int CountLooks(Purpose purpose) const {
    return static_cast<int>(std::count_if(sent.begin(), sent.end(), [&](const FlightCommand& c) {
      return c.kind == CommandKind::kLook && c.purpose == purpose;
    }));
  }
  const MissionStatus& status() const { return mission.status; }

  Mission mission;
  VehicleState vehicle;
  Findings findings;
  MissionOptions options;
  ViewpointOptions viewpoints;
  std::int64_t now_ns = 1'000 * kSecond_ns;
  std::vector<FlightCommand> sent;
  std::vector<FlightCommand> inbox;
  bool is_asked = false;
  bool is_mute = false;  ///< Sends no state.
  bool is_deaf = false;  ///< Hears no command.
  std::function<void(const FlightCommand&)> obey = [this](const FlightCommand& command) { Obey(command); };
  std::function<std::string(const FlightCommand&)> picture_problem = [](const FlightCommand&) { return ""; };
  std::function<void(Findings&)> look = [](Findings&) {};
};

// ---- The whole way ----

TEST(Advance, FliesThroughAClearBuildingAndComesHome) {
  Flight flight;
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
  EXPECT_THAT(flight.status().problems, IsEmpty());
  EXPECT_EQ(flight.CountLooks(Purpose::kOverview), 1);
  EXPECT_EQ(flight.CountLooks(Purpose::kTop), 2);
  EXPECT_GE(flight.CountLooks(Purpose::kWall), 2);
  EXPECT_EQ(flight.CountLooks(Purpose::kCorridor), 1);
  const std::vector<CommandKind> kinds = flight.Kinds();
  EXPECT_EQ(kinds.front(), CommandKind::kTakeOff);
  EXPECT_THAT(
      std::vector<CommandKind>(kinds.end() - 4, kinds.end()),
      ElementsAre(CommandKind::kGoTo, CommandKind::kFlyCorridor, CommandKind::kGoTo, CommandKind::kLand));
  EXPECT_EQ(flight.status().progress_ratio, 1.0);
}

TEST(Advance, NumbersItsCommandsWithoutGapsAndItsPicturesUniquely) {
  Flight flight;
  flight.Run();
  std::uint32_t sequence = 0;
  std::uint32_t capture_id = 0;
  for (const FlightCommand& command : flight.sent) {
    EXPECT_EQ(command.sequence, ++sequence);
    EXPECT_GT(command.valid_until_utc_ns, command.issued_utc_ns);
    if (command.kind == CommandKind::kLook) {
      EXPECT_EQ(command.capture_id, ++capture_id);
    }
  }
}

TEST(Advance, EntersOnlyWithLeaveForThisVehicleAndTheNewestScene) {
  Flight flight;
  flight.Run();
  const auto corridor = std::find_if(flight.sent.begin(), flight.sent.end(), [](const FlightCommand& c) {
    return c.kind == CommandKind::kFlyCorridor;
  });
  ASSERT_NE(corridor, flight.sent.end());
  ASSERT_TRUE(corridor->permit.has_value());
  EXPECT_EQ(corridor->permit->decision_id, 101u);
  EXPECT_EQ(corridor->permit->scene_revision, flight.findings.scene_revision);
  EXPECT_EQ(corridor->permit->envelope.radius_m, kEnvelope.radius_m);
  EXPECT_GT(corridor->permit->valid_until_utc_ns, corridor->issued_utc_ns);
  EXPECT_THAT(corridor->path_in_map_m, ElementsAre(Eigen::Vector3d(0, 5, 0.8), Eigen::Vector3d(0, 9, 0.8)));
  EXPECT_NEAR(corridor->yaw_rad, M_PI / 2.0, 1e-9);
}

TEST(Advance, LooksAlongTheCorridorThatItFliesThoughTheWallsAreNumberedAnew) {
  const Eigen::Vector3d entry(-3.0, 7.0, 0.8);
  const Eigen::Vector3d exit(3.0, 7.0, 0.8);
  Flight flight;
  flight.look = [&](Findings& findings) {  // After the first look the same side is another wall.
    if (flight.CountLooks(Purpose::kCorridor) == 0) return;
    for (ClearanceDecision& decision : findings.decisions) {
      decision.corridor->entry_in_map_m = entry;
      decision.corridor->exit_in_map_m = exit;
    }
  };
  flight.Run();
  EXPECT_EQ(flight.CountLooks(Purpose::kCorridor), 2);
  Eigen::Vector3d looked_from = Eigen::Vector3d::Zero();
  for (const FlightCommand& command : flight.sent) {
    if (command.purpose == Purpose::kCorridor) looked_from = command.path_in_map_m.back();
    if (command.kind != CommandKind::kFlyCorridor) continue;
    EXPECT_EQ(command.path_in_map_m.front(), entry);
    EXPECT_NEAR(looked_from.y(), entry.y(), 0.3);
    EXPECT_LT(looked_from.x(), entry.x());
  }
}

TEST(Advance, TransitsAboveEverythingKnown) {
  Flight flight;
  flight.Run();
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  for (const FlightCommand& command : flight.sent) {
    for (const Eigen::Vector3d& to : command.path_in_map_m) {
      const bool is_across = (to - from).head<2>().norm() > 0.5 && command.kind != CommandKind::kFlyCorridor;
      const bool is_to_entry = (to - Eigen::Vector3d(0, 5, 0.8)).norm() < 1e-9;
      if (is_across && !is_to_entry && command.kind != CommandKind::kTakeOff) {
        EXPECT_GE(std::min(from.z(), to.z()), 2.3 + 0.4) << ToString(command.kind) << " " << command.sequence;
      }
      from = to;
    }
  }
}

TEST(Advance, GoesDownForWallsOnlyWhereAPictureFromAboveShowedTheGround) {
  Flight flight;
  flight.Run();
  std::vector<Eigen::Vector3d> from_above;
  int walls = 0;
  for (const FlightCommand& command : flight.sent) {
    if (command.kind != CommandKind::kLook) continue;
    const Eigen::Vector3d place = command.path_in_map_m.back();
    if (command.purpose == Purpose::kOverview || command.purpose == Purpose::kTop)
      from_above.push_back(place);
    if (command.purpose != Purpose::kWall) continue;
    ++walls;
    EXPECT_TRUE(std::any_of(from_above.begin(), from_above.end(), [&](const Eigen::Vector3d& eye) {
      return (eye - place).head<2>().norm() < eye.z() * 480.0 / 850.0;
    })) << place.transpose();
  }
  EXPECT_GT(walls, 0);
}

TEST(Advance, DecidesAgainWithThePictureAlongTheCorridor) {
  Flight flight;
  flight.look = [&](Findings& findings) {
    if (flight.CountLooks(Purpose::kCorridor) > 0) findings.decisions = {Blocked(1)};
  };
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kBlocked);
  EXPECT_THAT(flight.Kinds(), Not(Contains(CommandKind::kFlyCorridor)));
}

// ---- Ends without a flight through ----

TEST(Advance, ComesHomeWithTheReasonWhenTheWayIsBlocked) {
  Flight flight;
  flight.findings.decisions = {Blocked(1)};
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kBlocked);
  EXPECT_THAT(flight.status().message, HasSubstr("too low by 0.20 m"));
  EXPECT_THAT(flight.Kinds(), Not(Contains(CommandKind::kFlyCorridor)));
  EXPECT_EQ(flight.sent.back().kind, CommandKind::kLand);
}

TEST(Advance, EndsWhenTheBuildingIsNotThere) {
  Flight flight;
  flight.findings.wanted.clear();
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kNoMatch);
  EXPECT_EQ(flight.CountLooks(Purpose::kOverview), 2);
  EXPECT_EQ(flight.sent.back().kind, CommandKind::kLand);
}

TEST(Advance, FindsWithASecondOverviewWhatTheFirstDidNotShow) {
  Flight flight;
  flight.look = [&](Findings& findings) {
    findings.wanted.clear();
    if (flight.CountLooks(Purpose::kOverview) > 1) findings.wanted = {1};
  };
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
  std::vector<double> altitudes_m;
  for (const FlightCommand& command : flight.sent) {
    if (command.purpose == Purpose::kOverview) altitudes_m.push_back(command.path_in_map_m.back().z());
  }
  ASSERT_EQ(altitudes_m.size(), 2u);
  EXPECT_GT(altitudes_m[1], altitudes_m[0]);
}

TEST(Advance, LooksAtEachBuildingFromAboveWhenOverviewsDoNotTellTheWantedOne) {
  Flight flight;
  flight.look = [&](Findings& findings) {
    findings.wanted.clear();
    if (flight.CountLooks(Purpose::kTop) > 0) findings.wanted = {1};
  };
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
  EXPECT_EQ(flight.CountLooks(Purpose::kOverview), 2);
}

TEST(Advance, EndsWhenSeveralPlacesFit) {
  Flight flight;
  flight.findings.wanted.clear();
  flight.findings.is_ambiguous = true;
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kAmbiguous);
}

TEST(Advance, LooksWhereAnOpenDecisionWantsToAndThenFlies) {
  Flight flight;
  Viewpoint wanted{Purpose::kWall, {4.0, 4.0, 1.2}, 2.3, 0.0, 1, -1, "the far end"};
  flight.findings.decisions = {Open(1, wanted)};
  flight.look = [&](Findings& findings) {
    if (flight.mission.status.step == MissionStep::kLookAgain) findings.decisions = {Clear(1, 0, 0.1)};
    for (ClearanceDecision& decision : findings.decisions) decision.scene_revision = findings.scene_revision;
  };
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
}

TEST(Advance, GivesUpAfterABoundedNumberOfFurtherViews) {
  Flight flight;
  double x = 4.0;
  flight.look = [&](Findings& findings) {
    findings.decisions = {Open(1, {Purpose::kWall, {x += 1.0, 4.0, 1.2}, 2.3, 0.0, 1, -1, "again"})};
  };
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kInsufficientData);
  EXPECT_THAT(flight.status().message, HasSubstr("the far end was not seen"));
}

TEST(Advance, NeverTakesTheSameViewTwiceForAnOpenDecision) {
  Flight flight;
  flight.findings.decisions = {Open(1, {Purpose::kCorridor, {4.0, 4.0, 1.2}, 2.3, 0.0, 1, -1, "again"})};
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kInsufficientData);
  EXPECT_EQ(flight.CountLooks(Purpose::kCorridor), 1);
}

TEST(Advance, DoesNotGoToAViewInsideABuilding) {
  Flight flight;
  flight.findings.decisions = {Open(1, {Purpose::kCorridor, {-6.0, 9.0, 0.8}, 0.0, 0.0, 1, -1, "inside"})};
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kInsufficientData);
  EXPECT_EQ(flight.CountLooks(Purpose::kCorridor), 0);
}

TEST(Advance, TriesEveryBuildingOfAGroup) {
  Flight flight;
  flight.findings.wanted = {2, 1};
  flight.findings.decisions = {Blocked(2), Clear(1, 0, 0.1)};
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown);
  EXPECT_EQ(flight.CountLooks(Purpose::kTop), 4);
}

TEST(Advance, DoesNotEnterWithADecisionForAnotherEnvelope) {
  Flight flight;
  flight.findings.decisions[0].vehicle.radius_m = 0.30;
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kInsufficientData);
  EXPECT_THAT(flight.Kinds(), Not(Contains(CommandKind::kFlyCorridor)));
}

TEST(Advance, DoesNotEnterWithADecisionForAnOlderScene) {
  Flight flight;
  flight.look = [](Findings& findings) {
    findings.decisions[0].scene_revision = findings.scene_revision - 1;
  };
  flight.Run();
  EXPECT_NE(flight.status().outcome, MissionOutcome::kFlown);
  EXPECT_THAT(flight.Kinds(), Not(Contains(CommandKind::kFlyCorridor)));
}

// ---- Answers, silence, retries ----

TEST(Advance, WaitsForAVehicleThatIsReadyAndSaysWhy) {
  Flight flight;
  flight.vehicle.phase = VehiclePhase::kNotReady;
  flight.vehicle.message = "no GPS";
  flight.Run(30);
  EXPECT_EQ(flight.status().state, MissionState::kWaiting);
  EXPECT_THAT(flight.status().message, HasSubstr("no GPS"));
  EXPECT_THAT(flight.sent, IsEmpty());
}

TEST(Advance, SendsAnUnansweredCommandAgainWithItsNumber) {
  Flight flight;
  flight.is_deaf = true;
  flight.Run(5);
  ASSERT_GE(flight.sent.size(), 3u);
  for (const FlightCommand& command : flight.sent) EXPECT_EQ(command.sequence, 1u);
  EXPECT_GT(flight.sent.back().valid_until_utc_ns, flight.sent.front().valid_until_utc_ns);
}

TEST(Advance, StopsTheVehicleBeforeItTriesAgainWhatWasNotAnswered) {
  Flight flight;
  flight.RunUntilStep(MissionStep::kTop);
  flight.is_deaf = true;
  flight.inbox.clear();
  flight.RunUntil([&] { return flight.sent.back().kind == CommandKind::kHold; }, 60);
  flight.is_deaf = false;
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
}

TEST(Advance, EndsWhenATakeOffIsRefusedAgainAndAgain) {
  Flight flight;
  flight.obey = [&](const FlightCommand& command) {
    flight.Give(flight.Ack(command, AckStatus::kRefused, "Arm: Need Position Estimate"));
  };
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFailed);
  EXPECT_THAT(flight.status().message, HasSubstr("Need Position Estimate"));
  EXPECT_EQ(flight.sent.size(), 3u);
}

TEST(Advance, RetakesAPictureThatCannotBeUsed) {
  Flight flight;
  int spoiled = 0;
  flight.picture_problem = [&](const FlightCommand& command) {
    return command.purpose == Purpose::kWall && spoiled++ == 0 ? std::string("not a JPEG") : std::string();
  };
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown);
  EXPECT_THAT(flight.status().problems, Contains(HasSubstr("not a JPEG")));
}

TEST(Advance, LeavesOutAWallThatCannotBeSeenAndGoesOn) {
  Flight flight;
  const Flight whole = [] {
    Flight f;
    f.Run();
    return f;
  }();
  int refused = 0;
  flight.obey = [&](const FlightCommand& command) {
    const bool is_first_wall =
        command.kind == CommandKind::kLook && command.purpose == Purpose::kWall && refused < 3;
    if (!is_first_wall) return flight.Obey(command);
    ++refused;
    flight.Give(flight.Ack(command, AckStatus::kRefused, "outside the geofence"));
  };
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown);
  EXPECT_THAT(flight.status().problems, Contains(HasSubstr("outside the geofence")));
}

TEST(Advance, IgnoresAnAnswerToAnotherCommandOrFromAnotherAgent) {
  Flight flight;
  flight.obey = [&](const FlightCommand& command) {
    CommandAck foreign = flight.Ack(command, AckStatus::kDone);
    foreign.agent_epoch = 99;
    flight.Give(foreign);
    CommandAck old = flight.Ack(command, AckStatus::kDone);
    old.sequence += 1;
    flight.Give(old);
    CommandAck other_mission = flight.Ack(command, AckStatus::kDone);
    other_mission.mission_id = 41;
    flight.Give(other_mission);
  };
  flight.Run(5);
  EXPECT_EQ(flight.status().step, MissionStep::kTakeOff);
}

TEST(Advance, CommandsNothingToASilentVehicleAndGoesOnWhenItIsBack) {
  Flight flight;
  flight.RunUntilStep(MissionStep::kWalls);
  flight.is_mute = true;
  flight.inbox.clear();
  flight.is_deaf = true;
  for (int i = 0; i < 4; ++i) flight.Step();
  const std::size_t before = flight.sent.size();
  for (int i = 0; i < 10; ++i) flight.Step();
  EXPECT_EQ(flight.sent.size(), before);
  EXPECT_THAT(flight.status().message, HasSubstr("silent"));
  flight.is_mute = flight.is_deaf = false;
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
}

TEST(Advance, EndsWhenTheVehicleIsLost) {
  Flight flight;
  flight.RunUntilStep(MissionStep::kWalls);
  flight.is_mute = flight.is_deaf = true;
  flight.Run(100);
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFailed);
  EXPECT_THAT(flight.status().message, HasSubstr("lost"));
}

TEST(Advance, RepeatsWhatARestartedAgentHasForgotten) {
  Flight flight;
  flight.RunUntilStep(MissionStep::kWalls);
  flight.is_mute = flight.is_deaf = true;
  flight.inbox.clear();
  for (int i = 0; i < 5; ++i) flight.Step();
  flight.vehicle.agent_epoch = 2;
  flight.is_mute = flight.is_deaf = false;
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
  EXPECT_THAT(flight.status().problems, Contains(HasSubstr("restarted")));
}

TEST(Advance, ListensToTheFirstOfTwoAgentsWithOneIdAndSaysSo) {
  Flight flight;
  flight.RunUntilStep(MissionStep::kTop);
  VehicleState second = flight.vehicle;
  second.agent_epoch = 2;
  second.name = "intruder";
  second.position_in_map_m = {1000.0, 0.0, 0.0};
  flight.Give(second);
  flight.Give(second);
  EXPECT_EQ(flight.mission.vehicle->agent_epoch, 1u);
  EXPECT_THAT(flight.status().problems, ElementsAre(HasSubstr("intruder")));
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown);
}

TEST(Advance, DoesNotStartWhileTwoAgentsHaveOneId) {
  Flight flight;
  flight.vehicle.phase = VehiclePhase::kNotReady;
  flight.Give(flight.vehicle);
  VehicleState second = flight.vehicle;
  second.agent_epoch = 2;
  flight.Give(second);
  flight.vehicle.phase = VehiclePhase::kOnGround;
  flight.Give(flight.vehicle);
  EXPECT_THAT(flight.status().message, HasSubstr("two agents"));
  EXPECT_THAT(flight.sent, IsEmpty());
}

// ---- People ----

TEST(Advance, HoldsWhilePausedAndGoesOnWhereItWas) {
  Flight flight;
  flight.obey = [&](const FlightCommand& command) {
    const bool is_second_wall = flight.CountLooks(Purpose::kWall) == 2 && command.kind == CommandKind::kLook;
    if (is_second_wall && flight.status().state == MissionState::kFlying)
      return flight.Give(OperatorWish::kPause);
    flight.Obey(command);
  };
  flight.RunUntil([&] { return flight.status().state == MissionState::kPaused; });
  EXPECT_EQ(flight.sent.back().kind, CommandKind::kHold);
  const std::size_t before = flight.sent.size();
  for (int i = 0; i < 20; ++i) flight.Step();
  EXPECT_EQ(flight.sent.size(), before);
  flight.obey = [&](const FlightCommand& command) { flight.Obey(command); };
  flight.Give(OperatorWish::kResume);
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
}

TEST(Advance, CommandsNothingWhenItLearnsWhilePausedWhatToLookAt) {
  Flight flight;
  flight.findings.map[0] = Box(1, 0.0, 30.0, 12.0, 0.75, 6.0);  // The ground around it has to be looked at.
  flight.look = [&](Findings&) {
    if (flight.status().step == MissionStep::kTop) flight.Give(OperatorWish::kPause);
  };
  flight.RunUntil([&] { return flight.status().state == MissionState::kPaused; });
  ASSERT_EQ(flight.status().step, MissionStep::kTop);
  ASSERT_EQ(flight.mission.views.size(), 1u);
  EXPECT_FALSE(flight.mission.errand);
}

TEST(Advance, AbortsAtOnceAndComesHome) {
  Flight flight;
  flight.RunUntilStep(MissionStep::kWalls);
  flight.Give(OperatorWish::kAbort);
  EXPECT_EQ(flight.sent.back().kind, CommandKind::kAbort);
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kAborted);
  EXPECT_EQ(flight.sent.back().kind, CommandKind::kLand);
}

TEST(Advance, AbortBeforeTakeOffEndsAtOnce) {
  Flight flight;
  flight.Give(OperatorWish::kAbort);
  EXPECT_EQ(flight.status().state, MissionState::kEnded);
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kAborted);
  EXPECT_THAT(flight.sent, IsEmpty());
}

TEST(Advance, YieldsToThePilotUntilResumed) {
  Flight flight;
  flight.RunUntilStep(MissionStep::kWalls);
  flight.vehicle.phase = VehiclePhase::kPilotInControl;
  flight.inbox.clear();
  const std::size_t before = flight.sent.size();
  for (int i = 0; i < 20; ++i) flight.Step();
  EXPECT_EQ(flight.sent.size(), before);
  EXPECT_EQ(flight.status().state, MissionState::kPaused);
  EXPECT_THAT(flight.status().message, HasSubstr("pilot"));
  flight.vehicle.phase = VehiclePhase::kHolding;
  for (int i = 0; i < 5; ++i) flight.Step();
  EXPECT_EQ(flight.sent.size(), before);
  flight.Give(OperatorWish::kResume);
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
}

TEST(Advance, EndsWhenThePilotLands) {
  Flight flight;
  flight.RunUntilStep(MissionStep::kWalls);
  flight.vehicle.phase = VehiclePhase::kPilotInControl;
  flight.inbox.clear();
  flight.Step();
  flight.vehicle.phase = VehiclePhase::kOnGround;
  flight.vehicle.armed = false;
  flight.Run(5);
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kAborted);
}

// ---- Inside the corridor ----

TEST(Advance, ComesHomeWhenTheAgentBackedOut) {
  Flight flight;
  flight.obey = [&](const FlightCommand& command) {
    if (command.kind != CommandKind::kFlyCorridor) return flight.Obey(command);
    flight.Give(flight.Ack(command, AckStatus::kAccepted));
    flight.Give(flight.Ack(command, AckStatus::kFailed, "0.3 m off the line, backed out"));
  };
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFailed);
  EXPECT_THAT(flight.status().message, HasSubstr("backed out"));
  EXPECT_EQ(flight.sent.back().kind, CommandKind::kLand);
}

TEST(Advance, ResumesInsideTheCorridorWithoutGoingBackToItsEntry) {
  Flight flight;
  bool is_paused_once = false;
  flight.obey = [&](const FlightCommand& command) {
    if (command.kind != CommandKind::kFlyCorridor || is_paused_once) return flight.Obey(command);
    is_paused_once = true;
    flight.Give(flight.Ack(command, AckStatus::kAccepted));
    flight.vehicle.position_in_map_m = {0.0, 7.0, 0.8};
    flight.Give(OperatorWish::kPause);
  };
  flight.RunUntil([&] { return flight.status().state == MissionState::kPaused; });
  for (int i = 0; i < 5; ++i) flight.Step();
  flight.Give(OperatorWish::kResume);
  EXPECT_EQ(flight.sent.back().kind, CommandKind::kFlyCorridor);
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown);
}

TEST(Advance, NeverCommandsAnAgentThatWasRestartedInsideTheCorridor) {
  Flight flight;
  flight.obey = [&](const FlightCommand& command) {
    if (command.kind != CommandKind::kFlyCorridor) return flight.Obey(command);
    flight.Give(flight.Ack(command, AckStatus::kAccepted));
    flight.is_mute = true;
  };
  flight.RunUntil([&] { return flight.is_mute; });
  const std::size_t before = flight.sent.size();
  for (int i = 0; i < 4; ++i) flight.Step();
  flight.is_mute = false;
  flight.vehicle.agent_epoch = 2;
  flight.Step();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFailed);
  EXPECT_EQ(flight.sent.size(), before);
  EXPECT_THAT(flight.status().message, HasSubstr("inside the corridor"));
}

TEST(Advance, LooksAgainWhenTheDecisionExpiredBeforeTheEntry) {
  Flight flight;
  bool is_paused_once = false;
  flight.obey = [&](const FlightCommand& command) {
    if (command.kind != CommandKind::kGoTo || is_paused_once) return flight.Obey(command);
    is_paused_once = true;
    flight.Give(OperatorWish::kPause);
  };
  flight.RunUntil([&] { return is_paused_once; });
  for (int i = 0; i < 200; ++i) flight.Step();
  flight.Give(OperatorWish::kResume);
  flight.Run();
  EXPECT_EQ(flight.status().outcome, MissionOutcome::kFlown) << flight.status().message;
  EXPECT_EQ(flight.CountLooks(Purpose::kCorridor), 2);
}

TEST(Advance, WaitsForALandingAsLongAsItsHeightTakes) {
  Flight flight;
  flight.findings.map.front().height_m = 70.0;  // Home is flown to above it.
  flight.obey = [&](const FlightCommand& command) {
    if (command.kind != CommandKind::kLand) return flight.Obey(command);
    flight.vehicle.phase = VehiclePhase::kLanding;
    flight.Give(flight.Ack(command, AckStatus::kAccepted));
  };
  flight.RunUntil([&] { return !flight.sent.empty() && flight.sent.back().kind == CommandKind::kLand; });
  ASSERT_GT(flight.vehicle.position_in_map_m.z(), 70.0);
  for (int second = 0; second < 180; ++second) {  // It sinks; the time that it may take must not.
    flight.vehicle.position_in_map_m.z() = std::max(1.0, 70.0 - 0.4 * second);
    flight.Step();
  }
  EXPECT_EQ(flight.sent.back().kind, CommandKind::kLand);
  EXPECT_THAT(flight.status().problems, IsEmpty());
}

TEST(ContinueMission, GoesOnWhereverItWasInterrupted) {
  Flight whole;
  whole.Run();
  const auto commands = static_cast<std::uint32_t>(whole.sent.size());
  for (std::uint32_t interrupted = 1; interrupted <= commands; ++interrupted) {
    for (const bool is_command_lost : {true, false}) {
      Flight flight;
      while (flight.mission.last_sequence < interrupted &&
             flight.mission.status.state != MissionState::kEnded)
        flight.Step();
      if (is_command_lost) flight.inbox.clear();
      flight.now_ns += 5 * kSecond_ns;
      flight.mission = ContinueMission(std::move(flight.mission), flight.now_ns, flight.options);
      if (flight.mission.is_waiting_for_findings) flight.is_asked = true;
      flight.Run();
      EXPECT_EQ(flight.mission.status.outcome, MissionOutcome::kFlown)
          << interrupted << ": " << flight.mission.status.message;
    }
  }
}

TEST(ContinueMission, CommandsNothingBeforeTheVehicleIsHeardAgain) {
  Flight flight;
  flight.Step();
  flight.inbox.clear();
  const std::size_t sent = flight.sent.size();
  flight.now_ns += 100 * kSecond_ns;
  flight.mission = ContinueMission(std::move(flight.mission), flight.now_ns, flight.options);
  flight.Give(Tick{});
  EXPECT_EQ(flight.sent.size(), sent);
  EXPECT_NE(flight.mission.status.state, MissionState::kEnded);
  flight.Give(flight.vehicle);
  ASSERT_EQ(flight.sent.size(), sent + 1);
  EXPECT_EQ(flight.sent.back().sequence, flight.mission.last_sequence);
}

TEST(Advance, GivesTheSameForTheSameEvents) {
  Flight first;
  Flight second;
  first.Run();
  second.Run();
  ASSERT_EQ(first.sent.size(), second.sent.size());
  for (std::size_t i = 0; i < first.sent.size(); ++i) {
    EXPECT_EQ(first.sent[i].path_in_map_m, second.sent[i].path_in_map_m);
    EXPECT_EQ(first.sent[i].issued_utc_ns, second.sent[i].issued_utc_ns);
  }
}

// ---- Transit ----

TEST(FlyOver, GoesUpAcrossAndDown) {
  EXPECT_THAT(FlyOver({0, 0, 1}, {5, 0, 2}, 4.0),
              ElementsAre(Eigen::Vector3d(0, 0, 4), Eigen::Vector3d(5, 0, 4), Eigen::Vector3d(5, 0, 2)));
}

TEST(FlyOver, NeverDescendsBeforeItIsAcross) {
  EXPECT_THAT(FlyOver({0, 0, 9}, {5, 0, 2}, 4.0),
              ElementsAre(Eigen::Vector3d(5, 0, 9), Eigen::Vector3d(5, 0, 2)));
}

TEST(TransitAltitude, IsAboveEveryBuildingOfKnownHeight) {
  const auto altitude = [](const std::vector<Footprint>& map) {
    return TransitAltitude(map, {-5, 0}, {5, 0}, kEnvelope, 1.5, 9.0);
  };
  EXPECT_NEAR(altitude({Box(1, 0, 20, 1, 1, 2.3)}), 2.3 + 0.4 + 1.5, 1e-12);
  EXPECT_EQ(altitude({}), 9.0);
}

TEST(TransitAltitude, TakesWhatIsOfUnknownHeightOnTheWayForAsHighAsItMightBe) {
  const auto altitude = [](const Footprint& unknown) {
    return TransitAltitude({Box(1, 0, 20, 1, 1, 2.3), unknown}, {-5, 0}, {5, 0}, kEnvelope, 1.5, 9.0);
  };
  EXPECT_EQ(altitude(Box(2, 0, 0, 1, 1, 0.0)), 9.0);
  EXPECT_EQ(altitude(Box(2, 4.5, 0, 20, 20, 0.0)), 9.0);
  EXPECT_EQ(altitude(Box(2, 0, 2.4, 1, 1, 0.0)), 9.0);
  EXPECT_NEAR(altitude(Box(2, 0, 4.0, 1, 1, 0.0)), 2.3 + 0.4 + 1.5, 1e-12);
}

}  // namespace
}  // namespace soffit
