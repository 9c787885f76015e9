/// The simulated ArduPilot against what was measured on a real Copter 4.5.6.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "test/sim/autopilot/test_flight.h"

namespace soffit::sim {
namespace {

using namespace mavlink;
using ::testing::Eq;
using ::testing::Optional;

TestFlight ColdStart() { return TestFlight(MakeArduPilot({GeodeticOrigin{47.4, 8.5, 488.0}})); }

/// Three seconds after a quick start, everything is ready.
TestFlight Ready() {
  TestFlight flight(MakeArduPilot({GeodeticOrigin{47.4, 8.5, 488.0}, true}));
  flight.Run(3.5);
  return flight;
}

void Arm(TestFlight& flight) {
  ASSERT_THAT(flight.Command(kCmdDoSetMode, {1, kCopterGuided}), Optional(Eq(kResultAccepted)));
  ASSERT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultAccepted)));
}

/// In the air at a height, holding.
TestFlight Airborne(float height_m) {
  TestFlight flight = Ready();
  Arm(flight);
  EXPECT_THAT(flight.Command(kCmdNavTakeoff, {0, 0, 0, 0, 0, 0, height_m}), Optional(Eq(kResultAccepted)));
  flight.Run(15.0);
  EXPECT_NEAR(flight.height_m(), height_m, 0.1);
  return flight;
}

void FlyNorthAt(TestFlight& flight, float speed_mps) {
  SetPositionTargetLocalNed m;
  m.target_system = 1;
  m.coordinate_frame = kFrameLocalNed;
  m.type_mask = kIgnorePosition | kIgnoreAcceleration | kIgnoreYaw | kIgnoreYawRate;
  m.vx = speed_mps;
  flight.Send(m);
}

TEST(ArduPilotStart, NeedsFortyOneSecondsUntilItArms) {
  TestFlight flight = ColdStart();
  flight.Command(kCmdSetMessageInterval, {EkfStatusReport::kId, 100'000});
  flight.Command(kCmdSetMessageInterval, {LocalPositionNed::kId, 100'000});
  flight.Command(kCmdSetMessageInterval, {SysStatus::kId, 100'000});
  flight.Run(5.0);
  EXPECT_EQ(flight.Last<EkfStatusReport>()->flags, 0x400);
  EXPECT_THAT(flight.Command(kCmdGetHomePosition), Optional(Eq(kResultFailed)));
  EXPECT_THAT(flight.Command(kCmdDoSetHome, {1}), Optional(Eq(kResultFailed)));
  flight.Run(15.5);
  EXPECT_TRUE(flight.Last<HomePosition>().has_value());
  EXPECT_THAT(flight.Command(kCmdGetHomePosition), Optional(Eq(kResultAccepted)));
  flight.Run(15.0);
  EXPECT_EQ(flight.Last<EkfStatusReport>()->flags, 0xa7);
  EXPECT_EQ(flight.Count<LocalPositionNed>(), 0u);
  EXPECT_EQ(flight.Last<SysStatus>()->onboard_control_sensors_health & kSensorPrearmCheck, 0u);
  flight.Command(kCmdDoSetMode, {1, kCopterGuided});
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultFailed)));
  EXPECT_TRUE(flight.Heard("Arm: Need Position Estimate"));
  flight.Run(6.5);
  EXPECT_EQ(flight.Last<EkfStatusReport>()->flags, 0x33f);
  EXPECT_NE(flight.Last<SysStatus>()->onboard_control_sensors_health & kSensorPrearmCheck, 0u);
  EXPECT_GT(flight.Count<LocalPositionNed>(), 0u);
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultAccepted)));
}

TEST(ArduPilotStart, PutsTheLocalOriginSomeCentimetresBesideHome) {
  TestFlight flight = Ready();
  const auto home = flight.Last<HomePosition>();
  const auto origin = flight.Last<GpsGlobalOrigin>();
  ASSERT_TRUE(home && origin);
  EXPECT_NEAR(origin->altitude - home->altitude, 30, 11);
  EXPECT_EQ(home->z, 0.0F);  // It never tells home's place in the local frame.
}

TEST(ArduPilotStreams, AreSilentByDefault) {
  TestFlight flight = Ready();
  flight.Run(26.5);
  for (const Frame& frame : flight.frames) {
    EXPECT_THAT(frame.message_id, ::testing::AnyOf(Heartbeat::kId, Statustext::kId, Timesync::kId,
                                                   HomePosition::kId, GpsGlobalOrigin::kId));
  }
  EXPECT_NEAR(static_cast<double>(flight.Count<Heartbeat>()), 30.0, 1.0);
  EXPECT_EQ(flight.Count<Timesync>(), 3u);
}

TEST(ArduPilotStreams, ComeAsOftenAsAskedFor) {
  TestFlight flight = Ready();
  EXPECT_THAT(flight.Command(kCmdSetMessageInterval, {LocalPositionNed::kId, 20'000}),
              Optional(Eq(kResultAccepted)));
  flight.Run(10.0);
  EXPECT_NEAR(static_cast<double>(flight.Count<LocalPositionNed>()), 500.0, 5.0);
  flight.Command(kCmdSetMessageInterval, {LocalPositionNed::kId, -1});
  const std::size_t count = flight.Count<LocalPositionNed>();
  flight.Run(1.0);
  EXPECT_EQ(flight.Count<LocalPositionNed>(), count);
}

TEST(ArduPilotStreams, ComeInGroupsByRequestDataStream) {
  TestFlight flight = Ready();
  flight.Send(RequestDataStream{4, 1, 1, kStreamPosition, 1});
  flight.Run(5.0);
  EXPECT_NEAR(static_cast<double>(flight.Count<GlobalPositionInt>()), 20.0, 2.0);
  EXPECT_EQ(flight.Count<Attitude>(), 0u);
}

TEST(ArduPilotStreams, AreLostWhenItReboots) {
  TestFlight flight = Ready();
  flight.Command(kCmdSetMessageInterval, {Attitude::kId, 100'000});
  flight.Run(1.0);
  EXPECT_THAT(flight.Command(kCmdPreflightRebootShutdown, {1}), Optional(Eq(kResultAccepted)));
  const std::size_t count = flight.Count<Attitude>();
  flight.Run(5.0);
  EXPECT_EQ(flight.Count<Attitude>(), count);
  EXPECT_GT(flight.Count<Heartbeat>(), 4u);
}

TEST(ArduPilotStreams, DenyWhatItDoesNotHave) {
  TestFlight flight = Ready();
  EXPECT_THAT(flight.Command(kCmdSetMessageInterval, {331, 100'000}), Optional(Eq(kResultDenied)));
  EXPECT_THAT(flight.Command(kCmdSetMessageInterval, {NAN, NAN}), Optional(Eq(kResultDenied)));
  EXPECT_THAT(flight.Command(kCmdRequestMessage, {331}), Optional(Eq(kResultFailed)));
  EXPECT_THAT(flight.Command(kCmdRequestMessage, {GpsGlobalOrigin::kId}), Optional(Eq(kResultAccepted)));
  EXPECT_NEAR(flight.Last<GpsGlobalOrigin>()->latitude * 1e-7, 47.4, 1e-6);
}

TEST(ArduPilotCommands, AreAcknowledgedAsByTheRealOne) {
  TestFlight flight = Ready();
  EXPECT_THAT(flight.Command(31000), Optional(Eq(kResultUnsupported)));
  EXPECT_EQ(flight.Command(kCmdDoSetMode, {1, kCopterGuided}, 2), std::nullopt);  // Another system.
  EXPECT_THAT(flight.Command(kCmdDoSetMode, {1, 99}), Optional(Eq(kResultFailed)));
  CommandInt m;
  m.target_system = 1;  // Component 0: all.
  m.command = kCmdDoSetMode;
  m.param1 = 1;
  m.param2 = kCopterGuided;
  flight.Send(m);
  EXPECT_EQ(flight.Last<mavlink::CommandAck>()->result, kResultAccepted);
  EXPECT_EQ(flight.autopilot->ModeName(), "GUIDED");
}

TEST(ArduPilotArming, ShowsUpToASecondLater) {
  TestFlight flight = Ready();
  Arm(flight);
  EXPECT_EQ(flight.Last<Heartbeat>()->base_mode & kModeFlagSafetyArmed, 0);
  flight.Run(1.0);
  EXPECT_NE(flight.Last<Heartbeat>()->base_mode & kModeFlagSafetyArmed, 0);
  EXPECT_EQ(flight.Last<Heartbeat>()->system_status, kStateStandby);
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultAccepted)));
}

TEST(ArduPilotArming, EndsByItselfAfterTenSecondsOnTheGround) {
  TestFlight flight = Ready();
  Arm(flight);
  const auto seconds = flight.RunUntil([&] { return !flight.autopilot->is_armed(); });
  EXPECT_NEAR(seconds.value_or(0.0), 10.0, 0.5);
}

TEST(ArduPilotArming, CannotBeEndedInTheAirWithoutForce) {
  TestFlight flight = Airborne(3.0F);
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {0}), Optional(Eq(kResultFailed)));
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {0, kForceArmDisarm}), Optional(Eq(kResultAccepted)));
}

TEST(ArduPilotTakeoff, TakesNineSecondsToNineMetres) {
  TestFlight flight = Ready();
  flight.Command(kCmdSetMessageInterval, {ExtendedSysState::kId, 100'000});
  Arm(flight);
  ASSERT_THAT(flight.Command(kCmdNavTakeoff, {0, 0, 0, 0, 0, 0, 9}), Optional(Eq(kResultAccepted)));
  const double lift_off_s = flight.RunUntil([&] { return flight.height_m() > 0.05; }).value_or(99.0);
  EXPECT_NEAR(lift_off_s, 4.0, 0.6);
  flight.Run(0.5);
  EXPECT_EQ(flight.Last<ExtendedSysState>()->landed_state, kLandedTakeoff);
  const double climb_s = flight.RunUntil([&] { return flight.height_m() > 8.9; }).value_or(99.0);
  EXPECT_NEAR(lift_off_s + 0.5 + climb_s, 9.0, 1.0);
  flight.Run(2.0);
  EXPECT_EQ(flight.Last<ExtendedSysState>()->landed_state, kLandedInAir);
  EXPECT_EQ(flight.Last<Heartbeat>()->system_status, kStateActive);
  EXPECT_THAT(flight.Command(kCmdNavTakeoff, {0, 0, 0, 0, 0, 0, 9}), Optional(Eq(kResultFailed)));
}

TEST(ArduPilotTakeoff, IsRefusedUnarmedOrOutsideGuided) {
  TestFlight flight = Ready();
  flight.Command(kCmdDoSetMode, {1, kCopterGuided});
  EXPECT_THAT(flight.Command(kCmdNavTakeoff, {0, 0, 0, 0, 0, 0, 5}), Optional(Eq(kResultFailed)));
  Arm(flight);
  flight.Command(kCmdDoSetMode, {1, kCopterBrake});
  EXPECT_THAT(flight.Command(kCmdNavTakeoff, {0, 0, 0, 0, 0, 0, 5}), Optional(Eq(kResultFailed)));
}

TEST(ArduPilotTakeoff, IsCancelledByASetpoint) {
  TestFlight flight = Ready();
  Arm(flight);
  flight.Command(kCmdNavTakeoff, {0, 0, 0, 0, 0, 0, 9});
  flight.RunUntil([&] { return flight.height_m() > 2.0; });
  flight.GoTo(5, 0, -3);
  flight.Run(10.0);
  EXPECT_NEAR(flight.height_m(), 3.0, 0.15);
  EXPECT_NEAR(flight.position_m().y(), 5.0, 0.15);
}

TEST(ArduPilotSetpoints, DoNothingOnTheGroundOrOutsideGuided) {
  TestFlight flight = Ready();
  Arm(flight);
  flight.GoTo(5, 5, -5);
  flight.Run(5.0);
  EXPECT_NEAR(flight.position_m().norm(), 0.0, 1e-6);

  TestFlight other = Airborne(3.0F);
  other.Command(kCmdDoSetMode, {1, kCopterBrake});
  other.Run(2.0);
  other.GoTo(5, 5, -5);
  other.Run(5.0);
  EXPECT_NEAR(other.position_m().head<2>().norm(), 0.0, 0.1);
}

TEST(ArduPilotSetpoints, FlyElevenMetresInFourAndAHalfSeconds) {
  TestFlight flight = Airborne(5.0F);
  flight.GoTo(11, 0, -5, 1.0F);
  const double seconds = flight.RunUntil([&] { return flight.position_m().y() > 10.5; }).value_or(99.0);
  EXPECT_NEAR(seconds, 4.5, 0.8);
  double farthest_m = 0.0;
  for (int i = 0; i < 100; ++i) {
    flight.Run(0.05);
    farthest_m = std::max(farthest_m, flight.position_m().y());
  }
  EXPECT_LT(farthest_m, 11.1);
  EXPECT_NEAR(YawOf(flight.vehicle.state().map_from_body), M_PI / 2.0 - 1.0, 0.01);
}

TEST(ArduPilotSetpoints, AreHeldForEverWhenTheyArePositions) {
  TestFlight flight = Airborne(5.0F);
  flight.GoTo(3, 0, -5);  // Once.
  flight.Run(120.0);
  EXPECT_EQ(flight.autopilot->ModeName(), "GUIDED");
  EXPECT_NEAR(flight.position_m().y(), 3.0, 0.3);
  EXPECT_NEAR(flight.height_m(), 5.0, 0.2);
}

TEST(ArduPilotSetpoints, AreFollowedTwoMetresBehindWhenTheyMove) {
  TestFlight flight = Airborne(5.0F);
  float north_m = 0.0F;
  for (int i = 0; i < 120; ++i) {
    north_m += 0.2F;
    flight.GoTo(north_m, 0, -5);
    flight.Run(0.1);
  }
  EXPECT_NEAR(static_cast<double>(north_m) - flight.position_m().y(), 2.2, 0.4);
}

TEST(ArduPilotSetpoints, TurnTheNoseToTheTargetWhenYawIsIgnored) {
  TestFlight flight = Airborne(5.0F);
  SetPositionTargetLocalNed m;
  m.target_system = 1;
  m.coordinate_frame = kFrameLocalNed;
  m.type_mask = 0xdf8;
  m.y = 8;
  m.z = -5;
  flight.Send(m);
  flight.Run(6.0);
  EXPECT_NEAR(flight.position_m().x(), 8.0, 0.2);
  EXPECT_NEAR(YawOf(flight.vehicle.state().map_from_body), 0.0, 0.02);  // East.
}

TEST(ArduPilotSetpoints, StopItWhenTheyAreYawOnlyOrInAnUnknownFrame) {
  for (const auto& [mask, frame] : {std::pair{0x9ff, 1}, std::pair{0x9f8, 12}}) {
    TestFlight flight = Airborne(5.0F);
    flight.GoTo(30, 0, -5);
    flight.Run(3.0);
    SetPositionTargetLocalNed m;
    m.target_system = 1;
    m.coordinate_frame = static_cast<std::uint8_t>(frame);
    m.type_mask = static_cast<std::uint16_t>(mask);
    m.x = 100;
    flight.Send(m);
    flight.Run(5.0);
    EXPECT_LT(flight.speed_mps(), 0.1);
    EXPECT_LT(flight.position_m().y(), 25.0);
  }
}

TEST(ArduPilotSetpoints, WorkRelativeToTheNose) {
  TestFlight flight = Airborne(5.0F);
  flight.Command(kCmdConditionYaw, {90, 0, 1, 0});  // East.
  flight.Run(4.0);
  SetPositionTargetLocalNed m;
  m.target_system = 1;
  m.coordinate_frame = kFrameBodyOffsetNed;
  m.type_mask = kPositionAndYaw;
  m.x = 4;  // Forward.
  m.y = 1;  // Right.
  flight.Send(m);
  flight.Run(8.0);
  EXPECT_NEAR(flight.position_m().x(), 4.0, 0.2);
  EXPECT_NEAR(flight.position_m().y(), -1.0, 0.2);
  EXPECT_NEAR(flight.height_m(), 5.0, 0.2);
}

TEST(ArduPilotSetpoints, CoastThreeSecondsWhenAVelocityStreamStops) {
  TestFlight flight = Airborne(5.0F);
  for (int i = 0; i < 40; ++i) {
    FlyNorthAt(flight, 2.0F);
    flight.Run(0.1);
  }
  EXPECT_NEAR(flight.speed_mps(), 2.0, 0.1);
  flight.Run(2.7);
  EXPECT_NEAR(flight.speed_mps(), 2.0, 0.1);
  flight.Run(3.0);
  EXPECT_LT(flight.speed_mps(), 0.1);
}

TEST(ArduPilotStopping, BrakesFromFourMetresPerSecondInSevenMetres) {
  TestFlight flight = Airborne(5.0F);
  for (int i = 0; i < 60; ++i) {
    FlyNorthAt(flight, 4.0F);
    flight.Run(0.1);
  }
  const double start_m = flight.position_m().y();
  EXPECT_THAT(flight.Command(kCmdDoSetMode, {1, kCopterBrake}), Optional(Eq(kResultAccepted)));
  const double seconds = flight.RunUntil([&] { return flight.speed_mps() < 0.05; }).value_or(99.0);
  EXPECT_NEAR(flight.position_m().y() - start_m, 7.0, 0.7);
  EXPECT_LT(seconds, 5.5);
}

TEST(ArduPilotStopping, SinksInLoiterWithoutARadio) {
  TestFlight flight = Airborne(5.0F);
  flight.Command(kCmdDoSetMode, {1, kCopterLoiter});
  EXPECT_TRUE(flight.RunUntil([&] { return flight.autopilot->is_landed(); }, 10.0).has_value());
}

TEST(ArduPilotStopping, LandsFromFiveMetresAndDisarmsASecondLater) {
  TestFlight flight = Airborne(5.0F);
  flight.Command(kCmdDoSetMode, {1, kCopterLand});
  const double seconds = flight.RunUntil([&] { return flight.vehicle.state().is_on_ground; }).value_or(99.0);
  EXPECT_NEAR(seconds, 11.5, 1.5);
  EXPECT_NEAR(flight.RunUntil([&] { return !flight.autopilot->is_armed(); }).value_or(99.0), 1.0, 0.5);
  EXPECT_EQ(flight.autopilot->ModeName(), "LAND");
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultFailed)));
  EXPECT_THAT(flight.Command(kCmdDoSetMode, {1, kCopterGuided}), Optional(Eq(kResultAccepted)));
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultAccepted)));
}

TEST(ArduPilotStopping, ClimbsToFifteenMetresBeforeItReturns) {
  TestFlight flight = Airborne(5.0F);
  flight.GoTo(20, 0, -5);
  flight.Run(10.0);
  flight.Command(kCmdDoSetMode, {1, kCopterRtl});
  double highest_m = 0.0;
  flight.RunUntil([&] {
    highest_m = std::max(highest_m, flight.height_m());
    return !flight.autopilot->is_armed();
  });
  EXPECT_NEAR(highest_m, 15.0, 0.3);
  EXPECT_LT(flight.position_m().norm(), 0.3);
}

TEST(ArduPilotFailsafe, LandsWhenTheGpsIsLost) {
  TestFlight flight = Airborne(5.0F);
  flight.Command(kCmdSetMessageInterval, {EkfStatusReport::kId, 50'000});
  flight.autopilot->SetGps(false);
  flight.Run(7.2);
  EXPECT_EQ(flight.Last<EkfStatusReport>()->flags, 0x25);
  EXPECT_EQ(flight.autopilot->ModeName(), "GUIDED");
  flight.Run(0.5);
  EXPECT_EQ(flight.autopilot->ModeName(), "LAND");
  flight.Run(1.0);
  EXPECT_EQ(flight.Last<Heartbeat>()->system_status, kStateCritical);
}

TEST(ArduPilotFailsafe, ReturnsWithinHalfASecondWhenTheRadioIsLost) {
  TestFlight flight = Airborne(5.0F);
  flight.autopilot->SetRadio(true);
  flight.Run(1.0);
  flight.autopilot->SetRadio(false);
  flight.Run(0.5);
  EXPECT_EQ(flight.autopilot->ModeName(), "RTL");
}

TEST(ArduPilotFailsafe, ReturnsTenSecondsAfterTheBatteryIsLow) {
  TestFlight flight = Airborne(5.0F);
  flight.vehicle.SetBattery(0.1);
  flight.Run(9.5);
  EXPECT_EQ(flight.autopilot->ModeName(), "GUIDED");
  flight.Run(1.0);
  EXPECT_EQ(flight.autopilot->ModeName(), "RTL");
}

TEST(ArduPilotFailsafe, WatchesOnlyItsOwnGroundStationAndOnlyWhenTold) {
  TestFlight companion = Airborne(5.0F);
  companion.Send(Heartbeat{});
  companion.Run(10.0);
  EXPECT_EQ(companion.autopilot->ModeName(), "GUIDED");

  TestFlight flight(MakeArduPilot({GeodeticOrigin{47.4, 8.5, 488.0}, true}), 255);
  flight.Run(3.5);
  ParamSet set;
  set.target_system = 1;
  set.param_id = ToTextField<16>("FS_GCS_ENABLE");
  set.param_value = 1;
  flight.Send(set);
  EXPECT_EQ(flight.Last<ParamValue>()->param_value, 1.0F);
  Arm(flight);
  flight.Command(kCmdNavTakeoff, {0, 0, 0, 0, 0, 0, 5});
  flight.Run(10.0);
  flight.Send(Heartbeat{});
  flight.Run(4.5);
  EXPECT_EQ(flight.autopilot->ModeName(), "GUIDED");
  flight.Run(1.0);
  EXPECT_EQ(flight.autopilot->ModeName(), "RTL");
}

TEST(ArduPilotPilot, TakesOverAndSetpointsAreIgnored) {
  TestFlight flight = Airborne(5.0F);
  EXPECT_FALSE(flight.autopilot->PilotSelects("DANCE"));
  EXPECT_TRUE(flight.autopilot->PilotSelects("LOITER"));
  flight.GoTo(10, 0, -5);
  flight.Run(5.0);
  EXPECT_NEAR(flight.position_m().head<2>().norm(), 0.0, 0.1);
  EXPECT_NEAR(flight.height_m(), 5.0, 0.2);
}

TEST(ArduPilotParameters, AnswerByNameAndIndexAndKeepSilentOtherwise) {
  TestFlight flight = Ready();
  ParamRequestRead request;
  request.target_system = 1;
  request.param_index = -1;
  request.param_id = ToTextField<16>("GUID_TIMEOUT");
  flight.Send(request);
  EXPECT_EQ(flight.Last<ParamValue>()->param_value, 3.0F);
  request.param_index = 0;
  flight.Send(request);
  EXPECT_EQ(TextOf(flight.Last<ParamValue>()->param_id), "ARMING_CHECK");
  const std::size_t count = flight.Count<ParamValue>();
  request.param_index = 30000;
  flight.Send(request);
  request.param_index = -1;
  request.param_id = ToTextField<16>("NO_SUCH_ONE");
  flight.Send(request);
  EXPECT_EQ(flight.Count<ParamValue>(), count);
}

TEST(ArduPilotTimesync, AnswersWithItsOwnClock) {
  TestFlight flight = Ready();
  flight.Send(Timesync{0, 12345, 0, 0});
  const auto answer = flight.Last<Timesync>();
  EXPECT_EQ(answer->ts1, 12345);
  EXPECT_NEAR(static_cast<double>(answer->tc1) * 1e-9, flight.time_s, 0.01);
}

TEST(ArduPilotGimbal, PointsWhereItIsTold) {
  TestFlight flight = Airborne(5.0F);
  GimbalManagerSetPitchyaw m;
  m.target_system = 1;
  m.pitch = static_cast<float>(-M_PI / 2.0);
  m.yaw = 0;
  flight.Send(m);
  flight.Run(2.0);
  EXPECT_NEAR(flight.autopilot->gimbal().pitch_rad(), -M_PI / 2.0, 1e-3);
  const Eigen::Vector3d looks_along = flight.autopilot->gimbal().MapFromCamera() * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(looks_along.z(), -1.0, 1e-3);
  flight.Command(kCmdDoGimbalManagerPitchyaw, {-30, NAN, 0, 0, 0});
  flight.Run(2.0);
  EXPECT_NEAR(flight.autopilot->gimbal().pitch_rad(), -M_PI / 6.0, 1e-3);
}

TEST(ArduPilot, SurvivesHostileMessages) {
  TestFlight flight = Airborne(3.0F);
  const std::vector<float> nasty = {NAN, INFINITY, -INFINITY, 1e30F, -1e30F, 0.0F, 65536.0F};
  for (std::uint16_t command = 0; command < 1100; ++command) {
    if (command == kCmdComponentArmDisarm) continue;
    flight.Command(command, nasty);
  }
  for (std::uint16_t mask = 0; mask < 4096; mask = static_cast<std::uint16_t>(mask + 7)) {
    SetPositionTargetLocalNed m;
    m.type_mask = mask;
    m.coordinate_frame = kFrameLocalNed;
    (mask % 3 == 0 ? m.x : mask % 3 == 1 ? m.vx : m.yaw) = NAN;
    flight.Send(m);
  }
  flight.Run(5.0);
  EXPECT_TRUE(flight.position_m().allFinite());
}

}  // namespace
}  // namespace soffit::sim
