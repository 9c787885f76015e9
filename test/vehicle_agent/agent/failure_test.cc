#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/support/agent_flight.h"

// What happens when something fails: the table of vehicle_agent/README.md, cell by cell.
namespace soffit {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kStep_s = Flight::kStep_s;

enum class Where { kTransit, kLooking, kCorridor, kRest };

AgentOptions QuickOptions(Failure failure) {
  AgentOptions options;
  options.hold_after_silence_s = 0.5;
  options.return_after_silence_s = failure == Failure::kServiceGone ? 1.0 : 1000.0;
  return options;
}

void BringTo(Where where, Flight& flight) {
  if (where == Where::kCorridor) return flight.FlyIntoCorridor(6.0);
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  if (where == Where::kTransit) {
    flight.Say(flight.Make(CommandKind::kGoTo, {{20.0, 0.0, 3.0}}));
    flight.Run(3.0);
  } else if (where == Where::kLooking) {
    flight.answers_pictures = false;
    flight.Say(flight.Make(CommandKind::kLook, {{0.5, 0.0, 3.0}}));
    while (flight.exposures.empty()) flight.Run(kStep_s);
  }
}

void Fail(Failure failure, Flight& flight) {
  switch (failure) {
    case Failure::kServiceSilent:
    case Failure::kServiceGone:
      flight.service_lives = false;
      break;
    case Failure::kCameraLost:
      flight.Say(CameraHealth{{{CameraId::kForward, "no answer"}, {CameraId::kDown, "no answer"}}});
      break;
    case Failure::kBatteryLow:
      flight.distort = [](Telemetry& heard) { heard.battery_ratio = 0.1; };
      break;
    case Failure::kOutOfBounds:
      flight.distort = [](Telemetry& heard) { heard.velocity_in_map_mps = {0.0, 3.1, 0.0}; };
      flight.Run(kStep_s);
      flight.distort = [](Telemetry&) {};
      break;
    case Failure::kPositionDoubtful:
      flight.distort = [](Telemetry& heard) { heard.position_doubt = "the GPS has no 3D fix"; };
      break;
    case Failure::kPositionLost:
      flight.distort = [](Telemetry& heard) {
        heard.has_position = false;
        heard.position_in_map_m.setZero();
      };
      break;
    case Failure::kAutopilotSilent:
      flight.distort = [](Telemetry& heard) { heard = {}; };
      break;
  }
}

void Recover(Flight& flight) {
  flight.service_lives = true;
  flight.answers_pictures = true;
  flight.distort = [](Telemetry&) {};
  flight.Say(CameraHealth{});
}

bool HasFailed(const Flight& flight) { return flight.LastStatus() == AckStatus::kFailed; }

/// Sees that the vehicle does what a reaction means, from the moment that something failed.
void ExpectReaction(const std::string& reaction, Where where, Flight& flight) {
  const Eigen::Vector3d place = flight.position();
  double highest_inside_m = 0.0;
  const auto run = [&](double seconds) {
    for (double t = 0.0; t < seconds; t += kStep_s) {
      flight.Run(kStep_s);
      if (flight.position().x() > 4.6) highest_inside_m = std::max(highest_inside_m, flight.position().z());
    }
  };
  run(5.0);
  const bool had_command = where != Where::kRest;
  if (reaction == "go_on" || reaction == "wait") {
    EXPECT_FALSE(HasFailed(flight)) << flight.LastReason();
    if (reaction == "wait") {
      const Eigen::Vector3d waits_at = flight.position();
      run(5.0);
      EXPECT_LT((flight.position() - waits_at).norm(), 0.2);
    }
    if (where == Where::kLooking) flight.Say(PictureOutcome{flight.exposures.back().request_id, ""});
    Recover(flight);
    EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone) << flight.LastReason();
  } else {
    EXPECT_EQ(HasFailed(flight), had_command) << flight.LastReason();
  }
  if (reaction == "hold") {
    EXPECT_LT((flight.position() - place).norm(), 3.5);
    EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kFlyTo);
    EXPECT_LT((flight.agent.intent().position_in_map_m - flight.position()).norm(), 0.3);
    Recover(flight);
    run(1.0);
    EXPECT_EQ(flight.phase(), VehiclePhase::kHolding);
  } else if (reaction == "back_out") {
    run(15.0);
    if (where == Where::kCorridor) {
      EXPECT_NEAR(flight.position().x(), 4.0, 0.4);
    }
    EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kFlyTo);
  } else if (reaction == "return") {
    run(90.0);
    EXPECT_FALSE(flight.vehicle.telemetry().is_armed);
    EXPECT_LT(flight.position().head<2>().norm(), 0.5);
  } else if (reaction == "land") {
    run(20.0);
    EXPECT_FALSE(flight.vehicle.telemetry().is_armed);
    EXPECT_LT((flight.position() - place).head<2>().norm(), 3.5);
  } else if (reaction == "release") {
    EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
    Recover(flight);
    run(3.0);
    EXPECT_EQ(flight.phase(), VehiclePhase::kHolding);  // It takes charge again.
  }
  if (where == Where::kCorridor) {
    EXPECT_LT(highest_inside_m, 1.2) << "climbed under a soffit";
  }
}

struct Row {
  Failure failure;
  const char* name;
  const char* in_transit;
  const char* looking;
  const char* in_corridor;
  const char* at_rest;
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.name; }

class OnFailure : public ::testing::TestWithParam<std::tuple<Row, Where>> {};

TEST_P(OnFailure, DoesWhatTheTableSays) {
  const auto& [row, where] = GetParam();
  GuardOptions guard;
  guard.max_speed_mps = 2.0;
  Flight flight(QuickOptions(row.failure), guard);
  BringTo(where, flight);
  Fail(row.failure, flight);
  const char* const cells[] = {row.in_transit, row.looking, row.in_corridor, row.at_rest};
  ExpectReaction(cells[static_cast<int>(where)], where, flight);
}

std::string WhereName(Where where) {
  const char* const names[] = {"InTransit", "Looking", "InCorridor", "AtRest"};
  return names[static_cast<int>(where)];
}

const auto kEverywhere = ::testing::Values(Where::kTransit, Where::kLooking, Where::kCorridor, Where::kRest);

INSTANTIATE_TEST_SUITE_P(
    ByDefault, OnFailure,
    ::testing::Combine(
        ::testing::Values(Row{Failure::kServiceSilent, "ServiceSilent", "wait", "go_on", "go_on", "go_on"},
                          Row{Failure::kServiceGone, "ServiceGone", "return", "return", "go_on", "return"},
                          Row{Failure::kCameraLost, "CameraLost", "go_on", "hold", "go_on", "go_on"},
                          Row{Failure::kBatteryLow, "BatteryLow", "return", "return", "go_on", "return"},
                          Row{Failure::kOutOfBounds, "OutOfBounds", "hold", "hold", "hold", "go_on"},
                          Row{Failure::kPositionDoubtful, "PositionDoubtful", "hold", "hold", "hold",
                              "go_on"},
                          Row{Failure::kPositionLost, "PositionLost", "hold", "hold", "hold", "hold"},
                          Row{Failure::kAutopilotSilent, "AutopilotSilent", "hold", "hold", "hold", "hold"}),
        kEverywhere),
    [](const auto& test) { return std::get<0>(test.param).name + WhereName(std::get<1>(test.param)); });

/// A failure whose cell is set to a reaction: each reaction can be had everywhere.
class Configured : public ::testing::TestWithParam<std::tuple<const char*, Where>> {};

TEST_P(Configured, DoesWhatTheCellSays) {
  const auto& [reaction, where] = GetParam();
  AgentOptions options = QuickOptions(Failure::kPositionDoubtful);
  options.on_failure.position_doubtful = {reaction, reaction, reaction, reaction};
  Flight flight(options);
  BringTo(where, flight);
  Fail(Failure::kPositionDoubtful, flight);
  ExpectReaction(reaction, where, flight);
}

INSTANTIATE_TEST_SUITE_P(Anything, Configured,
                         ::testing::Combine(::testing::Values("go_on", "wait", "hold", "back_out", "return",
                                                              "land", "release"),
                                            kEverywhere),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) + "_" +
                                  WhereName(std::get<1>(test.param));
                         });

class BlindlyConfigured : public ::testing::TestWithParam<const char*> {};

TEST_P(BlindlyConfigured, DoesWhatTheCellSaysThoughNothingIsHeard) {
  const std::string reaction = GetParam();
  AgentOptions options;
  options.on_failure.autopilot_silent.in_corridor = reaction;
  Flight flight(options);
  flight.FlyIntoCorridor(6.0);
  Fail(Failure::kAutopilotSilent, flight);
  ExpectReaction(reaction, Where::kCorridor, flight);
}

INSTANTIATE_TEST_SUITE_P(Anything, BlindlyConfigured, ::testing::Values("hold", "land", "release"),
                         [](const auto& test) { return std::string(test.param); });

TEST(OnSeveralFailures, TheGravestReactionCounts) {
  AgentOptions options = QuickOptions(Failure::kServiceSilent);
  Flight flight(options);
  BringTo(Where::kTransit, flight);
  flight.service_lives = false;
  flight.Run(2.0);
  EXPECT_FALSE(HasFailed(flight));
  Fail(Failure::kBatteryLow, flight);
  flight.Run(kStep_s);
  EXPECT_THAT(flight.LastReason(), HasSubstr("battery is at 10.00 %: returning home"));
}

TEST(OnSeveralFailures, AReleasedVehicleIsNotTakenAgainBeforeItsFailureIsOver) {
  AgentOptions options;
  options.on_failure.position_doubtful.in_transit = "release";
  Flight flight(options);
  BringTo(Where::kTransit, flight);
  Fail(Failure::kPositionDoubtful, flight);
  flight.Run(10.0);
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
  Recover(flight);
  flight.Run(1.0);
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kFlyTo);
}

TEST(OnSeveralFailures, AMilderOneDoesNotStopAReturn) {
  Flight flight(QuickOptions(Failure::kBatteryLow));
  BringTo(Where::kTransit, flight);
  Fail(Failure::kBatteryLow, flight);
  flight.Run(1.0);
  flight.service_lives = false;
  flight.Run(90.0);
  EXPECT_FALSE(flight.vehicle.telemetry().is_armed);
  EXPECT_LT(flight.position().head<2>().norm(), 0.5);
}

TEST(OnFailureOnTheGround, TheTakeoffFailsAndNothingIsCommanded) {
  Flight flight;
  flight.vehicle.telemetry().is_connected = true;
  flight.Say(flight.Make(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}));
  Fail(Failure::kAutopilotSilent, flight);
  flight.Run(kStep_s);
  EXPECT_TRUE(HasFailed(flight));
  EXPECT_THAT(flight.LastReason(), HasSubstr("autopilot fell silent"));
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
}

TEST(OnFailureInTheClimb, ItIsFinishedFirst) {
  Flight flight(QuickOptions(Failure::kServiceSilent));
  flight.Say(flight.Make(CommandKind::kTakeOff, {{0.0, 0.0, 9.0}}));
  flight.Run(1.0);
  Fail(Failure::kPositionDoubtful, flight);
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
  EXPECT_NEAR(flight.position().z(), 9.0, 0.5);
}

TEST(OnFailureInALanding, ItGoesOn) {
  Flight flight(QuickOptions(Failure::kServiceGone));
  BringTo(Where::kRest, flight);
  flight.Say(flight.Make(CommandKind::kLand, {{5.0, 0.0, 3.0}}));
  flight.service_lives = false;
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
  EXPECT_NEAR(flight.position().x(), 5.0, 0.5);
  EXPECT_FALSE(flight.vehicle.telemetry().is_armed);
}

TEST(OnOutOfBounds, TheVehicleMayBeCalledBackFromOutside) {
  GuardOptions guard;
  guard.max_distance_m = 10.0;
  Flight flight({}, guard);
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{9.5, 0.0, 3.0}}));
  flight.Run(3.0);
  flight.gust_m = {0.5, 0.0, 0.0};
  flight.Run(2.0);
  flight.gust_m.setZero();
  EXPECT_TRUE(HasFailed(flight));
  EXPECT_THAT(flight.LastReason(), AnyOf(HasSubstr("too far"), HasSubstr("too fast")));
  flight.vehicle.telemetry().position_in_map_m = {14.0, 0.0, 3.0};
  flight.Run(5.0);
  EXPECT_EQ(flight.Do(CommandKind::kGoTo, {{2.0, 0.0, 3.0}}), AckStatus::kDone) << flight.LastReason();
}

TEST(FindPolicyProblem, NamesTheCellThatIsWrong) {
  EXPECT_THAT(FindPolicyProblem({}), IsEmpty());
  FailurePolicy policy;
  policy.battery_low.looking = "panic";
  EXPECT_THAT(FindPolicyProblem(policy), HasSubstr("battery_low.looking: 'panic' is no reaction"));
  policy = {};
  policy.autopilot_silent.in_corridor = "return";
  EXPECT_THAT(FindPolicyProblem(policy), HasSubstr("autopilot_silent.in_corridor: 'return' cannot be"));
}

TEST(ReactionTable, TakesAnUnreadableCellForHold) {
  FailurePolicy policy;
  policy.camera_lost.in_transit = "";
  const auto trouble =
      ReactionTable(policy).FindGravest({{Failure::kCameraLost, "gone"}}, Situation::kInTransit);
  ASSERT_TRUE(trouble.has_value());
  EXPECT_EQ(trouble->reaction, Reaction::kHold);
  EXPECT_EQ(trouble->words, "gone: stopping here");
}

}  // namespace
}  // namespace soffit
