#include "vehicle_agent/agent/agent.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/support/agent_flight.h"

namespace soffit {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kStep_s = Flight::kStep_s;

std::vector<AckStatus> StatusesOf(const std::vector<CommandAck>& acks) {
  std::vector<AckStatus> statuses;
  for (const CommandAck& ack : acks) statuses.push_back(ack.status);
  return statuses;
}

TEST(Agent, CommandsNothingUntilItIsTold) {
  Flight flight;
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
  EXPECT_EQ(flight.phase(), VehiclePhase::kOnGround);
}

TEST(Agent, SaysWhyItIsNotReady) {
  Flight flight;
  flight.vehicle.telemetry().not_ready = "waiting for GPS: no 3D fix";
  flight.Run(0.1);
  EXPECT_EQ(flight.phase(), VehiclePhase::kNotReady);
  EXPECT_THAT(flight.message(), HasSubstr("no 3D fix"));
  flight.Say(flight.Make(CommandKind::kTakeOff, {{0, 0, 9}}));
  EXPECT_EQ(flight.LastStatus(), AckStatus::kRefused);
  EXPECT_THAT(flight.LastReason(), HasSubstr("no 3D fix"));
}

TEST(Agent, FliesAWholeMissionInOrder) {
  Flight flight;
  EXPECT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 9.0}}), AckStatus::kDone);
  EXPECT_NEAR(flight.position().z(), 9.0, 0.5);
  EXPECT_EQ(flight.phase(), VehiclePhase::kHolding);
  EXPECT_EQ(flight.Do(CommandKind::kLook, {{4.0, 3.0, 9.0}, {4.0, 3.0, 2.0}}), AckStatus::kDone);
  ASSERT_EQ(flight.exposures.size(), 1U);
  EXPECT_EQ(flight.exposures[0].camera, CameraId::kForward);
  EXPECT_EQ(flight.exposures[0].capture_id, 42U);
  EXPECT_EQ(flight.Do(CommandKind::kGoTo, {{4.0, 0.0, 2.0}}), AckStatus::kDone);
  EXPECT_EQ(flight.Do(CommandKind::kFlyCorridor, {{4.0, 0.0, 2.0}, {10.0, 0.0, 2.0}}), AckStatus::kDone);
  EXPECT_NEAR(flight.position().x(), 10.0, 0.5);
  EXPECT_EQ(flight.Do(CommandKind::kLand), AckStatus::kDone);
  EXPECT_EQ(flight.phase(), VehiclePhase::kOnGround);
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
}

TEST(Agent, AcknowledgesAcceptedThenDone) {
  Flight flight;
  flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}});
  EXPECT_THAT(StatusesOf(flight.acks), ElementsAre(AckStatus::kAccepted, AckStatus::kDone));
  EXPECT_EQ(flight.acks.back().agent_epoch, 100U);
  EXPECT_EQ(flight.acks.back().mission_id, 3U);
  EXPECT_EQ(flight.acks.back().sequence, 1U);
}

TEST(Agent, AnswersAResentCommandAgainAndDoesItOnce) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  const FlightCommand look = flight.Make(CommandKind::kLook, {{2.0, 0.0, 3.0}});
  flight.Say(look);
  flight.Run(0.2);
  flight.Say(look);
  EXPECT_EQ(flight.LastStatus(), AckStatus::kAccepted);
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
  flight.acks.clear();
  flight.Run(6.0);
  flight.Say(look);  // By now it is stale as well.
  flight.Run(5.0);
  EXPECT_THAT(StatusesOf(flight.acks), ElementsAre(AckStatus::kDone));
  EXPECT_EQ(flight.exposures.size(), 1U);
}

TEST(Agent, AnswersARefusedCommandTheSameWayWhenItIsResent) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  const FlightCommand far = flight.Make(CommandKind::kGoTo, {{900.0, 0.0, 3.0}});
  flight.Say(far);
  const std::string reason = flight.LastReason();
  EXPECT_THAT(reason, HasSubstr("too far"));
  flight.Say(far);
  EXPECT_EQ(flight.LastStatus(), AckStatus::kRefused);
  EXPECT_EQ(flight.LastReason(), reason);
  EXPECT_EQ(flight.Do(CommandKind::kGoTo, {{1.0, 0.0, 3.0}}), AckStatus::kDone);
}

TEST(Agent, IgnoresCommandsForOtherVehicles) {
  Flight flight;
  FlightCommand command = flight.Make(CommandKind::kTakeOff, {{0, 0, 9}});
  command.vehicle_id = 8;
  flight.Say(command);
  flight.Run(1.0);
  EXPECT_THAT(flight.acks, IsEmpty());
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
}

TEST(Agent, RefusesAnOldMissionAfterANewOneBegan) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  FlightCommand next = flight.Make(CommandKind::kGoTo, {{1.0, 0.0, 3.0}});
  next.mission_id = 4;
  flight.Say(next);
  ASSERT_EQ(flight.RunToEnd(), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{2.0, 0.0, 3.0}}));
  EXPECT_EQ(flight.LastStatus(), AckStatus::kRefused);
  EXPECT_THAT(flight.LastReason(), HasSubstr("mission 3 is over"));
}

TEST(Agent, StaysWithinTheCommandedSpeed) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{20.0, 0.0, 3.0}}));
  double fastest_mps = 0.0;
  for (int i = 0; i < 400 && flight.LastStatus() != AckStatus::kDone; ++i) {
    flight.Run(kStep_s);
    fastest_mps = std::max(fastest_mps, flight.vehicle.telemetry().velocity_in_map_mps.norm());
  }
  EXPECT_EQ(flight.LastStatus(), AckStatus::kDone);
  EXPECT_GT(fastest_mps, 1.5);
  EXPECT_LT(fastest_mps, 2.2);
}

TEST(Agent, FliesCornersAndDoesNotCutThem) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 9.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{8.0, 0.0, 9.0}, {8.0, 0.0, 1.0}}));
  double worst_m = 0.0;
  while (flight.LastStatus() != AckStatus::kDone) {
    flight.Run(kStep_s);
    worst_m = std::max(
        worst_m, std::min(std::abs(flight.position().z() - 9.0), std::abs(flight.position().x() - 8.0)));
  }
  EXPECT_LT(worst_m, 0.45);
}

TEST(Agent, ChoosesTheDownwardCameraForSteepLooks) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  FlightCommand look = flight.Make(CommandKind::kLook, {{1.0, 0.0, 3.0}});
  look.camera_pitch_rad = -1.5;
  flight.Say(look);
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
  ASSERT_EQ(flight.exposures.size(), 1U);
  EXPECT_EQ(flight.exposures[0].camera, CameraId::kDown);
}

TEST(Agent, ExposesOnlyWhenTheVehicleIsAtRest) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kLook, {{1.0, 0.0, 3.0}}));
  flight.vehicle.telemetry().rotation_rate_radps = 1.0;
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kFailed);
  EXPECT_THAT(flight.exposures, IsEmpty());
  EXPECT_THAT(flight.LastReason(), HasSubstr("gave up"));
  EXPECT_EQ(flight.phase(), VehiclePhase::kHolding);
}

TEST(Agent, TriesAPictureAgainAndThenFailsWithTheReason) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.picture_problem = "the picture is cut off";
  EXPECT_EQ(flight.Do(CommandKind::kLook, {{1.0, 0.0, 3.0}}), AckStatus::kFailed);
  EXPECT_EQ(flight.exposures.size(), 3U);
  EXPECT_THAT(flight.LastReason(), HasSubstr("cut off"));
}

TEST(Agent, RefusesALookWhoseCameraIsMissingAndSaysSoInItsState) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(CameraHealth{{{CameraId::kForward, "connection refused"}}});
  flight.Say(flight.Make(CommandKind::kLook, {{1.0, 0.0, 3.0}}));
  EXPECT_EQ(flight.LastStatus(), AckStatus::kRefused);
  EXPECT_THAT(flight.LastReason(), HasSubstr("forward camera: connection refused"));
  EXPECT_THAT(flight.message(), HasSubstr("forward camera: connection refused"));
  FlightCommand down = flight.Make(CommandKind::kLook, {{1.0, 0.0, 3.0}});
  down.camera_pitch_rad = -1.57;
  flight.Say(down);
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
}

TEST(Agent, StopsAtOnceOnAbort) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{30.0, 0.0, 3.0}}));
  flight.Run(5.0);
  const double x_m = flight.position().x();
  ASSERT_GT(flight.vehicle.telemetry().velocity_in_map_mps.x(), 1.0);
  flight.Say(flight.Make(CommandKind::kAbort));
  flight.Run(kStep_s);
  EXPECT_LT((flight.agent.intent().position_in_map_m - flight.position()).norm(), 2.0);
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
  EXPECT_LT(flight.position().x(), x_m + 2.5);
  EXPECT_EQ(flight.phase(), VehiclePhase::kHolding);
  ASSERT_GE(flight.acks.size(), 3U);
  EXPECT_THAT(flight.acks[flight.acks.size() - 3].reason, HasSubstr("superseded by command 3 (abort)"));
}

TEST(Agent, LandsInsteadOfLiftingOffWhenAbortedBefore) {
  Flight flight;
  flight.Say(flight.Make(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}));
  flight.vehicle.telemetry().is_armed = true;
  flight.Say(flight.vehicle.telemetry());
  flight.Say(flight.Make(CommandKind::kAbort));
  EXPECT_EQ(flight.LastStatus(), AckStatus::kDone);
  flight.Run(1.0);
  EXPECT_LT(flight.highest_m, 0.5);
  EXPECT_FALSE(flight.vehicle.telemetry().is_armed);
}

TEST(Agent, StopsCommandingWhenThePilotTakesOver) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{30.0, 0.0, 3.0}}));
  flight.Run(2.0);
  flight.vehicle.telemetry().is_in_our_mode = false;
  flight.vehicle.telemetry().mode = "LOITER";
  flight.Run(kStep_s);
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
  EXPECT_EQ(flight.phase(), VehiclePhase::kPilotInControl);
  EXPECT_EQ(flight.LastStatus(), AckStatus::kFailed);
  EXPECT_THAT(flight.LastReason(), HasSubstr("pilot took over: mode LOITER"));
  flight.Say(flight.Make(CommandKind::kHold));
  EXPECT_EQ(flight.LastStatus(), AckStatus::kRefused);
  flight.service_lives = false;
  flight.Run(200.0);  // Silence does not move it either.
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
}

TEST(Agent, HoldsWhenThePilotGivesTheVehicleBack) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.vehicle.telemetry().is_in_our_mode = false;
  flight.Run(1.0);
  flight.vehicle.telemetry().position_in_map_m = {5.0, 5.0, 4.0};
  flight.vehicle.telemetry().is_in_our_mode = true;
  flight.Run(3.0);
  EXPECT_EQ(flight.phase(), VehiclePhase::kHolding);
  EXPECT_LT((flight.agent.intent().position_in_map_m - Eigen::Vector3d(5.0, 5.0, 4.0)).norm(), 0.5);
  EXPECT_EQ(flight.Do(CommandKind::kGoTo, {{6.0, 5.0, 4.0}}), AckStatus::kDone);
}

TEST(Agent, FailsTheCommandWhenTheAutopilotFallsSilent) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{30.0, 0.0, 3.0}}));
  flight.Run(1.0);
  flight.vehicle.telemetry().is_connected = false;
  flight.vehicle.telemetry().not_ready = "the autopilot is silent";
  flight.Run(0.2);
  EXPECT_THAT(flight.LastReason(), HasSubstr("autopilot fell silent"));
  EXPECT_EQ(flight.phase(), VehiclePhase::kNotReady);
}

TEST(Agent, FailsTheCommandWhenThePositionIsLost) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{30.0, 0.0, 3.0}}));
  flight.Run(1.0);
  flight.vehicle.telemetry().has_position = false;
  flight.Run(4.0);
  EXPECT_EQ(flight.LastStatus(), AckStatus::kFailed);
  EXPECT_THAT(flight.LastReason(), HasSubstr("no position"));
}

TEST(Agent, FailsTheTakeoffWithTheAutopilotsReason) {
  Flight flight;
  flight.Say(flight.Make(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}));
  flight.vehicle.telemetry().intent_problem = "the autopilot does not arm: Arm: Compass not calibrated";
  flight.Say(flight.vehicle.telemetry());
  flight.Say(Beat{});
  EXPECT_EQ(flight.LastStatus(), AckStatus::kFailed);
  EXPECT_THAT(flight.LastReason(), HasSubstr("Compass not calibrated"));
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
}

// ---- The corridor ----

TEST(Agent, PassesACorridorStraight) {
  Flight flight;
  flight.FlyToEntry();
  flight.Say(flight.Make(CommandKind::kFlyCorridor, {{4.0, 0.0, 1.0}, {10.0, 0.0, 1.0}}));
  double off_m = 0.0;
  double fastest_mps = 0.0;
  while (flight.LastStatus() != AckStatus::kDone && flight.LastStatus() != AckStatus::kFailed) {
    flight.Run(kStep_s);
    if (flight.phase() != VehiclePhase::kInCorridor) continue;
    off_m = std::max(off_m, flight.position().tail<2>().cwiseAbs().maxCoeff() - 1.0);
    fastest_mps = std::max(fastest_mps, flight.vehicle.telemetry().velocity_in_map_mps.norm());
  }
  EXPECT_EQ(flight.LastStatus(), AckStatus::kDone);
  EXPECT_LT(off_m, 0.1);
  EXPECT_LT(fastest_mps, 0.7);
}

TEST(Agent, BacksOutTheWayItCameWhenBlownOffTheCorridorsLine) {
  Flight flight;
  flight.FlyIntoCorridor(6.0);
  flight.gust_m = {0.0, 0.06, 0.0};
  flight.Run(2.0);
  flight.gust_m.setZero();
  EXPECT_EQ(flight.LastStatus(), AckStatus::kFailed);
  EXPECT_THAT(flight.LastReason(), AllOf(HasSubstr("beside the corridor's line"), HasSubstr("backing out")));
  flight.Run(20.0);
  EXPECT_NEAR(flight.position().x(), 4.0, 0.4);
  EXPECT_EQ(flight.phase(), VehiclePhase::kHolding);
  EXPECT_LT(flight.highest_m, 1.2);
}

TEST(Agent, BacksOutOfACorridorOnAbort) {
  Flight flight;
  flight.FlyIntoCorridor(6.0);
  flight.Say(flight.Make(CommandKind::kAbort));
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
  EXPECT_NEAR(flight.position().x(), 4.0, 0.4);
  EXPECT_LT(flight.highest_m, 1.2);
}

TEST(Agent, GoesOnWithACorridorAfterAHoldInsideOfIt) {
  Flight flight;
  flight.FlyIntoCorridor(6.0);
  ASSERT_EQ(flight.Do(CommandKind::kHold), AckStatus::kDone);
  EXPECT_THAT(flight.message(), HasSubstr("inside a corridor"));
  EXPECT_EQ(flight.Do(CommandKind::kFlyCorridor, {{4.0, 0.0, 1.0}, {10.0, 0.0, 1.0}}), AckStatus::kDone);
  EXPECT_NEAR(flight.position().x(), 10.0, 0.4);
  EXPECT_LT(flight.highest_m, 1.2);
}

TEST(Agent, DoesNotEnterACorridorWhosePermitExpiredWhileItLinedUp) {
  Flight flight;
  flight.FlyToEntry();
  FlightCommand command = flight.Make(CommandKind::kFlyCorridor, {{4.0, 0.0, 1.0}, {10.0, 0.0, 1.0}});
  command.permit->valid_until_utc_ns = flight.now.utc_ns + 100'000'000;
  flight.Say(command);
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kFailed);
  EXPECT_THAT(flight.LastReason(), HasSubstr("permit expired"));
  EXPECT_LT(flight.position().x(), 4.3);
  EXPECT_EQ(flight.phase(), VehiclePhase::kHolding);
}

TEST(Agent, ReturnsToTheCorridorsLineBeforeItBacksOut) {
  Flight flight;
  flight.FlyIntoCorridor(7.0);
  flight.gust_m = {0.0, 0.06, 0.0};
  while (flight.LastStatus() != AckStatus::kFailed) flight.Run(kStep_s);
  flight.gust_m.setZero();
  flight.vehicle.telemetry().position_in_map_m.y() = 1.0;
  double beside_m = 1.0;
  while (flight.position().x() > 6.0) {
    flight.Run(kStep_s);
    beside_m = std::abs(flight.position().y());
  }
  EXPECT_LT(beside_m, 0.2);
  EXPECT_LT(flight.highest_m, 1.2);
}

TEST(Agent, NeitherClimbsNorLandsInsideACorridor) {
  Flight flight;
  flight.FlyIntoCorridor(6.0);
  ASSERT_EQ(flight.Do(CommandKind::kHold), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{7.0, 0.0, 5.0}}));
  EXPECT_EQ(flight.LastStatus(), AckStatus::kRefused);
  EXPECT_THAT(flight.LastReason(), HasSubstr("inside a corridor"));
  flight.Say(flight.Make(CommandKind::kLand));
  EXPECT_EQ(flight.LastStatus(), AckStatus::kRefused);
}

// ---- Silence of the service: the table in vehicle_agent/README.md ----

TEST(InSilence, AVehicleOnTheGroundStaysThere) {
  Flight flight;
  flight.service_lives = false;
  flight.Run(100.0);
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
}

TEST(InSilence, AClimbIsFinishedAndTheHeightHeld) {
  Flight flight;
  flight.Say(flight.Make(CommandKind::kTakeOff, {{0.0, 0.0, 12.0}}));
  flight.service_lives = false;
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
  flight.Run(5.0);
  EXPECT_NEAR(flight.position().z(), 12.0, 0.5);
}

TEST(InSilence, TransitWaitsAndGoesOnWhenTheServiceIsBack) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{30.0, 0.0, 3.0}}));
  flight.service_lives = false;
  flight.Run(10.0);
  const double x_m = flight.position().x();
  EXPECT_LT(x_m, 12.0);
  flight.Run(10.0);
  EXPECT_NEAR(flight.position().x(), x_m, 0.3);
  EXPECT_THAT(flight.message(), HasSubstr("service is silent"));
  flight.service_lives = true;
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
  EXPECT_NEAR(flight.position().x(), 30.0, 0.5);
}

TEST(InSilence, TheVehicleReturnsHomeAtTheHeightThatItFlewAndLands) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 9.0}}), AckStatus::kDone);
  ASSERT_EQ(flight.Do(CommandKind::kGoTo, {{8.0, 0.0, 9.0}, {8.0, 0.0, 1.5}}), AckStatus::kDone);
  flight.service_lives = false;
  double low_over_ground_m = 100.0;
  for (int i = 0; i < 3000 && flight.vehicle.telemetry().is_armed; ++i) {
    flight.Run(kStep_s);
    const double x_m = flight.position().x();
    if (x_m > 1.0 && x_m < 7.0) low_over_ground_m = std::min(low_over_ground_m, flight.position().z());
  }
  EXPECT_FALSE(flight.vehicle.telemetry().is_armed);
  EXPECT_LT(flight.position().head<2>().norm(), 0.5);
  EXPECT_GT(low_over_ground_m, 8.5);
}

TEST(InSilence, APictureIsStillTaken) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.answers_pictures = false;
  flight.Say(flight.Make(CommandKind::kLook, {{0.5, 0.0, 3.0}}));
  while (flight.exposures.empty()) flight.Run(kStep_s);
  flight.service_lives = false;
  flight.Run(5.0);
  flight.Say(PictureOutcome{flight.exposures[0].request_id, ""});
  EXPECT_EQ(flight.RunToEnd(5.0), AckStatus::kDone);
}

TEST(InSilence, ACorridorIsFlownToItsEndByDefault) {
  Flight flight;
  flight.FlyIntoCorridor(6.0);
  flight.service_lives = false;
  EXPECT_EQ(flight.RunToEnd(), AckStatus::kDone);
  EXPECT_NEAR(flight.position().x(), 10.0, 0.4);
}

TEST(InSilence, ACorridorIsLeftBackwardsWhenSoConfigured) {
  AgentOptions options;
  options.on_failure.service_silent.in_corridor = "back_out";
  Flight flight(options);
  flight.FlyIntoCorridor(6.0);
  flight.service_lives = false;
  flight.Run(30.0);
  EXPECT_EQ(flight.LastStatus(), AckStatus::kFailed);
  EXPECT_NEAR(flight.position().x(), 4.0, 0.4);
  EXPECT_LT(flight.highest_m, 1.2);
}

TEST(InSilence, AVehicleThatRestsInACorridorBacksOutBeforeItClimbsHome) {
  Flight flight;
  flight.FlyIntoCorridor(6.0);
  ASSERT_EQ(flight.Do(CommandKind::kHold), AckStatus::kDone);
  flight.service_lives = false;
  double highest_inside_m = 0.0;
  for (int i = 0; i < 4000 && flight.vehicle.telemetry().is_armed; ++i) {
    flight.Run(kStep_s);
    if (flight.position().x() > 4.5) highest_inside_m = std::max(highest_inside_m, flight.position().z());
  }
  EXPECT_FALSE(flight.vehicle.telemetry().is_armed);
  EXPECT_LT(highest_inside_m, 1.2);
  EXPECT_LT(flight.position().head<2>().norm(), 0.5);
}

TEST(Agent, ReturnsHomeOnLowBattery) {
  Flight flight;
  ASSERT_EQ(flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}}), AckStatus::kDone);
  flight.Say(flight.Make(CommandKind::kGoTo, {{10.0, 0.0, 3.0}}));
  flight.Run(3.0);
  flight.vehicle.telemetry().battery_ratio = 0.1;
  flight.Run(0.2);
  EXPECT_EQ(flight.LastStatus(), AckStatus::kFailed);
  EXPECT_THAT(flight.LastReason(), HasSubstr("battery is at 10.00 %"));
  flight.Run(60.0);
  EXPECT_FALSE(flight.vehicle.telemetry().is_armed);
}

// ---- Two agents for one vehicle ----

TEST(Agent, GivesWayToAnAgentThatWasThereFirst) {
  Flight flight;
  flight.Say(RivalHeard{50, "other"});
  flight.Say(flight.Make(CommandKind::kTakeOff, {{0, 0, 9}}));
  flight.Run(1.0);
  EXPECT_THAT(flight.acks, IsEmpty());
  EXPECT_EQ(flight.agent.intent().kind, Intent::Kind::kNone);
  EXPECT_EQ(flight.phase(), VehiclePhase::kNotReady);
  EXPECT_THAT(flight.message(), HasSubstr("another agent ('other') flies vehicle 7"));
  flight.Run(3.0);  // The other one is gone.
  EXPECT_EQ(flight.phase(), VehiclePhase::kOnGround);
}

TEST(Agent, GoesOnWhenALaterAgentClaimsItsVehicleAndSaysSo) {
  Flight flight;
  flight.Say(RivalHeard{200, "late"});
  EXPECT_THAT(flight.message(), HasSubstr("second agent ('late')"));
  EXPECT_EQ(flight.Do(CommandKind::kTakeOff, {{0, 0, 9}}), AckStatus::kDone);
}

TEST(Agent, TakesChargeOfAVehicleThatItFindsInTheAirAndReturnsWhenNobodySpeaks) {
  Flight flight;
  flight.service_lives = false;
  flight.vehicle.telemetry().is_armed = flight.vehicle.telemetry().is_in_air = true;
  flight.vehicle.telemetry().position_in_map_m = {3.0, 0.0, 5.0};
  flight.Run(5.0);
  EXPECT_EQ(flight.phase(), VehiclePhase::kHolding);
  flight.Run(120.0);
  EXPECT_FALSE(flight.vehicle.telemetry().is_armed);
}

TEST(Agent, GivesTheSameOutputsForTheSameEvents) {
  const auto fly = [] {
    Flight flight;
    flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}});
    flight.Do(CommandKind::kLook, {{4.0, 3.0, 5.0}});
    return std::pair(flight.notes, flight.position());
  };
  EXPECT_EQ(fly(), fly());
}

TEST(AnswersOfTheAgent, AreRepeatedForAWhileWhenTheServiceIsFoundAgain) {
  Flight flight;
  flight.Do(CommandKind::kTakeOff, {{0.0, 0.0, 3.0}});
  flight.Say(flight.Make(CommandKind::kGoTo, {{0.5, 0.0, 3.0}}));
  flight.service_lives = false;
  flight.Run(20.0);
  ASSERT_EQ(flight.LastStatus(), AckStatus::kDone);
  const std::size_t unheard = flight.acks.size();
  flight.service_lives = true;
  flight.Run(60.0);
  EXPECT_NEAR(static_cast<double>(flight.acks.size() - unheard), 5.0, 1.0);
  for (std::size_t i = unheard; i < flight.acks.size(); ++i) {
    EXPECT_EQ(flight.acks[i].sequence, flight.sequence);
    EXPECT_EQ(flight.acks[i].status, AckStatus::kDone);
    EXPECT_GT(flight.acks[i].stamp_utc_ns, flight.acks[unheard - 1].stamp_utc_ns);
  }
}

}  // namespace
}  // namespace soffit
