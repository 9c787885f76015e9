#include "vehicle_agent/autopilot/autopilot_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <tuple>

#include "test/support/fake_autopilot.h"
#include "vehicle_agent/autopilot/status_text.h"

namespace soffit {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Client and autopilot with a perfect link between them.
class Talk {
 public:
  explicit Talk(mavlink::Autopilot make = mavlink::kAutopilotArduPilot, bool has_gimbal = false)
      : autopilot(make), client({}, has_gimbal) {}

  void Run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 50.0); ++i) {
      now.steady_ns += 20'000'000;
      now.utc_ns += 20'000'000;
      for (const auto& bytes : autopilot.Live(20)) {
        for (const auto& frame : down_.Feed(bytes)) client.Receive(frame, now);
      }
      for (const auto& bytes : client.Pursue(intent, now)) {
        for (const auto& frame : up_.Feed(bytes)) autopilot.Receive(frame);
      }
      for (std::string& note : client.TakeNotes()) notes.push_back(std::move(note));
    }
  }
  Telemetry Report() const { return client.Report(now); }

  void TakeOff(double height_m) {
    intent.kind = Intent::Kind::kTakeOff;
    intent.position_in_map_m = {0.0, 0.0, height_m};
    Run(15.0);
  }
  void FlyTo(const Eigen::Vector3d& in_map_m, double yaw_rad) {
    intent.kind = Intent::Kind::kFlyTo;
    intent.position_in_map_m = in_map_m;
    intent.yaw_rad = yaw_rad;
    Run(10.0);
  }
  int CountCommands(std::uint16_t command) const {
    int count = 0;
    for (const auto& it : autopilot.commands) count += it.command == command;
    return count;
  }

  Instant now{1'000'000'000, 1'700'000'000'000'000'000};
  FakeAutopilot autopilot;
  AutopilotClient client;
  Intent intent;
  std::vector<std::string> notes;

 private:
  mavlink::FrameParser up_;
  mavlink::FrameParser down_;
};

TEST(AutopilotClient, KnowsNothingBeforeAnythingIsHeard) {
  Talk talk;
  talk.autopilot.is_silent = true;
  talk.Run(5.0);
  EXPECT_FALSE(talk.Report().is_connected);
  EXPECT_EQ(talk.Report().not_ready, "no autopilot was heard");
  EXPECT_THAT(talk.autopilot.commands, IsEmpty());
}

TEST(AutopilotClient, AsksASilentAutopilotForWhatItNeeds) {
  Talk talk;
  talk.Run(4.0);
  const Telemetry telemetry = talk.Report();
  EXPECT_TRUE(telemetry.is_connected);
  EXPECT_EQ(telemetry.autopilot, "ArduPilot");
  EXPECT_EQ(telemetry.mode, "STABILIZE");
  EXPECT_THAT(telemetry.not_ready, IsEmpty());
  EXPECT_TRUE(telemetry.has_position);
  EXPECT_NEAR(telemetry.battery_ratio, 0.77, 1e-9);
  ASSERT_TRUE(telemetry.origin.has_value());
  EXPECT_NEAR(telemetry.origin->latitude_deg, 50.0, 1e-9);
  EXPECT_TRUE(talk.client.TrustsPoses(talk.now));
}

TEST(AutopilotClient, SendsNoFlightCommandWithoutAnIntent) {
  Talk talk;
  talk.Run(5.0);
  for (const auto& command : talk.autopilot.commands) {
    EXPECT_TRUE(command.command == mavlink::kCmdSetMessageInterval ||
                command.command == mavlink::kCmdRequestMessage);
  }
  EXPECT_THAT(talk.autopilot.setpoints, IsEmpty());
}

TEST(AutopilotClient, DoesNotAskAgainForWhatComes) {
  Talk talk;
  talk.Run(5.0);
  const std::size_t asked = talk.autopilot.commands.size();
  talk.Run(20.0);
  EXPECT_EQ(talk.autopilot.commands.size(), asked);
}

TEST(AutopilotClient, AsksAgainAfterAReboot) {
  Talk talk;
  talk.Run(5.0);
  talk.autopilot.Reboot();
  talk.Run(5.0);
  EXPECT_TRUE(talk.Report().has_position);
  EXPECT_THAT(talk.notes, Contains(HasSubstr("restarted")));
  EXPECT_TRUE(talk.client.TrustsPoses(talk.now));
}

TEST(AutopilotClient, SaysWhatItWaitsFor) {
  Talk talk;
  talk.autopilot.is_ready = false;
  talk.Run(4.0);
  EXPECT_THAT(talk.Report().not_ready, HasSubstr("no 3D fix"));
  EXPECT_FALSE(talk.Report().has_position);
  talk.autopilot.is_ready = true;
  talk.Run(5.0);
  EXPECT_THAT(talk.Report().not_ready, IsEmpty());
}

TEST(AutopilotClient, NoticesThatTheAutopilotIsSilent) {
  Talk talk;
  talk.Run(4.0);
  talk.autopilot.is_silent = true;
  talk.Run(4.0);
  EXPECT_FALSE(talk.Report().is_connected);
  EXPECT_EQ(talk.Report().not_ready, "the autopilot is silent");
}

TEST(AutopilotClient, ArmsInTheRightOrderAndWaitsForTheHeight) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(9.0);
  EXPECT_TRUE(talk.Report().is_armed);
  EXPECT_TRUE(talk.Report().is_in_our_mode);
  EXPECT_NEAR(talk.Report().position_in_map_m.z(), 9.0, 0.3);
  EXPECT_THAT(talk.autopilot.setpoints, IsEmpty());
  std::vector<std::uint16_t> order;
  for (const auto& command : talk.autopilot.commands) {
    const bool is_stream =
        command.command == mavlink::kCmdSetMessageInterval || command.command == mavlink::kCmdRequestMessage;
    if (!is_stream && (order.empty() || order.back() != command.command)) order.push_back(command.command);
  }
  EXPECT_EQ(order, (std::vector<std::uint16_t>{mavlink::kCmdDoSetMode, mavlink::kCmdComponentArmDisarm,
                                               mavlink::kCmdNavTakeoff}));
}

TEST(AutopilotClient, RepeatsACommandUntilTheAutopilotDoesIt) {
  Talk talk;
  talk.Run(4.0);
  talk.autopilot.is_deaf = true;
  talk.TakeOff(5.0);
  EXPECT_NEAR(talk.CountCommands(mavlink::kCmdDoSetMode), 15, 1);  // Once a second.
  talk.autopilot.is_deaf = false;
  talk.Run(15.0);
  EXPECT_NEAR(talk.Report().position_in_map_m.z(), 5.0, 0.3);
  talk.autopilot.is_deaf = true;
  const int asked = talk.CountCommands(mavlink::kCmdDoSetMode);
  talk.intent.kind = Intent::Kind::kLand;
  talk.Run(5.0);
  EXPECT_NEAR(talk.CountCommands(mavlink::kCmdDoSetMode) - asked, 5, 1);
}

TEST(AutopilotClient, SaysWhichCommandAPlainlyDeafAutopilotDoesNotDo) {
  Talk talk;
  talk.Run(4.0);
  talk.autopilot.is_deaf = true;
  talk.TakeOff(5.0);
  talk.Run(16.0);
  EXPECT_EQ(talk.Report().intent_problem, "the autopilot does not enter its command mode");
}

TEST(AutopilotClient, TellsWhyTheAutopilotDoesNotArm) {
  Talk talk;
  talk.autopilot.arming_complaint = "Arm: Compass not calibrated";
  talk.Run(4.0);
  talk.TakeOff(9.0);
  EXPECT_THAT(talk.Report().intent_problem, IsEmpty());  // It may still do it.
  talk.TakeOff(9.0);
  talk.Run(5.0);
  EXPECT_THAT(talk.Report().intent_problem, HasSubstr("does not arm (failed): Arm: Compass not calibrated"));
}

TEST(AutopilotClient, FliesToPointsOfTheMap) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(5.0);
  talk.FlyTo({3.0, 1.0, 4.0}, 0.5 * std::numbers::pi);
  EXPECT_NEAR(talk.autopilot.position_ned_m.x(), 1.0, 0.1);   // North.
  EXPECT_NEAR(talk.autopilot.position_ned_m.y(), 3.0, 0.1);   // East.
  EXPECT_NEAR(talk.autopilot.position_ned_m.z(), -4.0, 0.1);  // Down.
  EXPECT_NEAR(talk.autopilot.yaw_ned_rad, 0.0, 1e-6);         // Facing north.
  EXPECT_NEAR(talk.Report().yaw_rad, 0.5 * std::numbers::pi, 1e-3);
  ASSERT_FALSE(talk.autopilot.setpoints.empty());
  EXPECT_EQ(talk.autopilot.setpoints.back().type_mask, 0x9f8);
  EXPECT_EQ(talk.autopilot.setpoints.back().coordinate_frame, 1);
}

TEST(AutopilotClient, StreamsSetpointsAtTheConfiguredRate) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(5.0);
  talk.intent.kind = Intent::Kind::kFlyTo;
  talk.Run(10.0);
  EXPECT_NEAR(static_cast<double>(talk.autopilot.setpoints.size()), 100.0, 3.0);
}

TEST(AutopilotClient, SaysANewOrderAtOnce) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(5.0);
  talk.intent.kind = Intent::Kind::kFlyTo;
  for (int i = 0; i < 20; ++i) {
    talk.Run(0.1 + 0.02 * (i % 5));
    const std::size_t said = talk.autopilot.setpoints.size();
    ++talk.intent.order;
    talk.Run(0.02);
    EXPECT_EQ(talk.autopilot.setpoints.size(), said + 1);
  }
}

TEST(AutopilotClient, KeepsHoldingAVehicleWhoseAutopilotFellSilent) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(5.0);
  talk.FlyTo({3.0, 1.0, 4.0}, 0.0);
  talk.autopilot.is_silent = true;
  talk.Run(5.0);
  EXPECT_FALSE(talk.Report().is_connected);
  const std::size_t said = talk.autopilot.setpoints.size();
  talk.Run(1.0);
  EXPECT_GE(talk.autopilot.setpoints.size(), said + 9);
}

TEST(AutopilotClient, SaysWhyItsPositionIsDoubtful) {
  Talk talk;
  talk.Run(4.0);
  EXPECT_THAT(talk.Report().position_doubt, IsEmpty());
  talk.autopilot.is_ready = false;
  talk.Run(1.0);
  EXPECT_THAT(talk.Report().position_doubt, HasSubstr("no 3D fix"));
}

TEST(AutopilotClient, PutsTheMapsOriginAtHomeWhereverTheLocalFrameBegins) {
  Talk talk;
  talk.autopilot.origin_latitude_e7 -= 1000;  // The local frame begins 11.1 m south of home.
  talk.autopilot.position_ned_m.x() = 11.124;
  talk.Run(4.0);
  EXPECT_LT(talk.Report().position_in_map_m.norm(), 0.02);
  talk.TakeOff(5.0);
  talk.FlyTo({2.0, 0.0, 5.0}, 0.0);
  EXPECT_NEAR(talk.autopilot.position_ned_m.x(), 11.124, 0.1);
  EXPECT_NEAR(talk.autopilot.position_ned_m.y(), 2.0, 0.1);
}

TEST(AutopilotClient, DoesNotMoveTheMapWhenHomeIsSetAnew) {
  Talk talk;
  talk.Run(4.0);
  talk.autopilot.home_latitude_e7 += 10000;
  talk.autopilot.Reboot();
  talk.Run(5.0);
  EXPECT_LT(talk.Report().position_in_map_m.norm(), 0.02);
}

TEST(AutopilotClient, TakesNoPlaceForHomeThatIsNotOnEarth) {
  Talk talk;
  talk.autopilot.home_latitude_e7 = 1'900'000'000;
  talk.Run(3.0);
  EXPECT_FALSE(talk.Report().has_position);
}

TEST(AutopilotClient, CountsTheTakeoffsHeightFromTheHomeThatTheAutopilotHasNow) {
  Talk talk;
  talk.Run(4.0);
  mavlink::HomePosition home;  // ArduPilot sets it anew when it arms; its barometer has drifted meanwhile.
  home.latitude = talk.autopilot.home_latitude_e7;
  home.altitude = static_cast<std::int32_t>(talk.Report().origin->altitude_amsl_m * 1e3) + 500;
  mavlink::Encoder encoder(1, mavlink::kComponentAutopilot);
  mavlink::FrameParser parser;
  for (const auto& frame : parser.Feed(encoder.Encode(home))) talk.client.Receive(frame, talk.now);
  talk.TakeOff(9.0);
  ASSERT_EQ(talk.autopilot.commands.back().command, mavlink::kCmdNavTakeoff);
  EXPECT_NEAR(talk.autopilot.commands.back().param7, 8.5, 1e-3);
}

TEST(AutopilotClient, LandsAndLeavesTheLandModeSoThatItCanArmAgain) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(3.0);
  talk.intent.kind = Intent::Kind::kLand;
  talk.Run(2.0);
  EXPECT_EQ(talk.Report().mode, "LAND");
  EXPECT_TRUE(talk.Report().is_in_our_mode);
  talk.Run(6.0);
  EXPECT_FALSE(talk.Report().is_armed);
  talk.intent.kind = Intent::Kind::kNone;
  talk.Run(3.0);
  EXPECT_EQ(talk.Report().mode, "GUIDED");
  talk.TakeOff(3.0);
  EXPECT_NEAR(talk.Report().position_in_map_m.z(), 3.0, 0.3);
}

TEST(AutopilotClient, BreaksItsOwnLandingOff) {
  for (const auto make : {mavlink::kAutopilotArduPilot, mavlink::kAutopilotPx4}) {
    Talk talk(make);
    talk.Run(4.0);
    talk.TakeOff(8.0);
    talk.intent.kind = Intent::Kind::kFlyTo;
    talk.Run(1.0);
    talk.intent.kind = Intent::Kind::kLand;
    talk.Run(2.0);
    talk.FlyTo({0.0, 0.0, 6.0}, 0.0);
    EXPECT_TRUE(talk.Report().mode == "GUIDED" || talk.Report().mode == "OFFBOARD") << talk.Report().mode;
    EXPECT_TRUE(talk.Report().is_armed);
    EXPECT_NEAR(talk.Report().position_in_map_m.z(), 6.0, 0.3);
  }
}

TEST(AutopilotClient, DoesNotBreakAFailsafesLandingOff) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(8.0);
  talk.intent.kind = Intent::Kind::kLand;
  talk.Run(2.0);
  talk.autopilot.system_status = mavlink::kStateCritical;
  talk.Run(1.5);
  talk.FlyTo({0.0, 0.0, 6.0}, 0.0);
  EXPECT_FALSE(talk.Report().is_armed);
}

TEST(AutopilotClient, DoesNotTakeALandingInTheNextFlightForItsOwn) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(3.0);
  talk.intent.kind = Intent::Kind::kLand;
  talk.Run(8.0);
  EXPECT_FALSE(talk.Report().is_armed);
  talk.TakeOff(3.0);  // At once, without any rest on the ground.
  talk.autopilot.mode = mavlink::kCopterLand;
  talk.intent.kind = Intent::Kind::kFlyTo;
  talk.Run(1.5);
  EXPECT_FALSE(talk.Report().is_in_our_mode);
}

TEST(AutopilotClient, SeesThatAnotherLandingIsNotItsOwn) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(3.0);
  talk.autopilot.mode = mavlink::kCopterLand;
  talk.autopilot.system_status = mavlink::kStateCritical;
  talk.intent = {};
  talk.Run(1.5);
  EXPECT_FALSE(talk.Report().is_in_our_mode);
  EXPECT_TRUE(talk.Report().is_in_failsafe);
}

TEST(AutopilotClient, SendsNothingIntoAModeOfThePilots) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(3.0);
  talk.autopilot.mode = mavlink::kCopterLoiter;
  talk.intent.kind = Intent::Kind::kFlyTo;
  talk.Run(1.5);  // Until the heartbeat tells it.
  talk.autopilot.setpoints.clear();
  const int mode_commands = talk.CountCommands(mavlink::kCmdDoSetMode);
  talk.Run(5.0);
  EXPECT_THAT(talk.autopilot.setpoints, IsEmpty());
  EXPECT_EQ(talk.CountCommands(mavlink::kCmdDoSetMode), mode_commands);
}

TEST(AutopilotClient, AimsTheGimbalThatItHas) {
  for (const bool has_gimbal : {true, false}) {
    Talk talk(mavlink::kAutopilotArduPilot, has_gimbal);
    talk.Run(4.0);
    talk.TakeOff(3.0);
    talk.intent.kind = Intent::Kind::kFlyTo;
    talk.intent.camera_pitch_rad = -0.5;
    talk.Run(0.1);
    ASSERT_EQ(talk.autopilot.gimbal_aims.size(), has_gimbal ? 1U : 0U);
    for (const auto& aim : talk.autopilot.gimbal_aims) EXPECT_NEAR(aim.pitch, -0.5, 1e-6);
  }
}

TEST(AutopilotClient, TakesControlOfAGimbalBeforeItAimsIt) {
  Talk talk(mavlink::kAutopilotPx4, true);
  talk.Run(4.0);
  talk.intent.kind = Intent::Kind::kFlyTo;
  talk.intent.camera_pitch_rad = -0.7;
  talk.Run(20.0);
  ASSERT_EQ(talk.CountCommands(mavlink::kCmdDoGimbalManagerConfigure), 1);
  for (const auto& command : talk.autopilot.commands) {
    if (command.command != mavlink::kCmdDoGimbalManagerConfigure) continue;
    EXPECT_EQ(command.param1, 1.0F);
    EXPECT_EQ(command.param2, 191.0F);
  }
}

TEST(AutopilotClient, AimsAGimbalOfTheOlderProtocol) {
  Talk talk(mavlink::kAutopilotArduPilot, true);
  talk.autopilot.has_old_mount = true;
  talk.Run(4.0);
  talk.TakeOff(5.0);
  talk.intent.camera_pitch_rad = -0.5;
  talk.FlyTo({1.0, 0.0, 5.0}, 0.0);
  ASSERT_TRUE(talk.Report().gimbal_pitch_rad.has_value());
  EXPECT_NEAR(*talk.Report().gimbal_pitch_rad, -0.5, 1e-3);
  EXPECT_THAT(talk.autopilot.gimbal_aims, IsEmpty());
}

TEST(AutopilotClient, SetsAHomeThatIsMissing) {
  Talk talk;
  talk.autopilot.has_home = false;
  talk.Run(4.0);
  EXPECT_EQ(talk.CountCommands(mavlink::kCmdDoSetHome), 0);  // It may still come by itself.
  EXPECT_THAT(talk.Report().not_ready, HasSubstr("home"));
  talk.Run(8.0);
  EXPECT_EQ(talk.CountCommands(mavlink::kCmdDoSetHome), 1);
  EXPECT_THAT(talk.Report().not_ready, IsEmpty());
}

TEST(AutopilotClient, TellsThePilotsGroundStationWhatGoesOn) {
  Talk talk;
  talk.Run(2.0);
  talk.client.Announce("command 3 (fly_corridor) failed: 0.31 m beside the corridor's line");
  talk.client.Announce("short");
  talk.Run(0.1);
  ASSERT_EQ(talk.autopilot.texts.size(), 3U);
  const auto& [first, second, third] =
      std::tie(talk.autopilot.texts[0], talk.autopilot.texts[1], talk.autopilot.texts[2]);
  EXPECT_EQ(mavlink::TextOf(first.text) + mavlink::TextOf(second.text),
            "Soffit: command 3 (fly_corridor) failed: 0.31 m beside the corridor's line");
  EXPECT_EQ(first.id, second.id);
  EXPECT_NE(first.id, 0);
  EXPECT_EQ(second.chunk_seq, 1);
  EXPECT_EQ(mavlink::TextOf(third.text), "Soffit: short");
  EXPECT_EQ(third.id, 0);
}

TEST(MakeStatusTexts, EndsATextOfWholePartsWithAnEmptyOne) {
  EXPECT_EQ(MakeStatusTexts(std::string(50, 'a'), 5, 7).size(), 1U);
  const auto parts = MakeStatusTexts(std::string(100, 'a'), 5, 7);
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(mavlink::TextOf(parts[2].text), "");
  EXPECT_THAT(MakeStatusTexts("", 5, 7), IsEmpty());
}

TEST(AutopilotClient, ReportsUnsafeParametersOnce) {
  Talk talk;
  talk.autopilot.parameters = {{"FS_EKF_ACTION", 1.0F},   {"FS_THR_ENABLE", 1.0F}, {"FS_GCS_ENABLE", 0.0F},
                               {"BATT_FS_LOW_ACT", 1.0F}, {"FENCE_ACTION", 1.0F},  {"FENCE_ENABLE", 0.0F}};
  talk.Run(20.0);
  EXPECT_TRUE(talk.client.KnowsParameters());
  EXPECT_THAT(talk.client.ListUnsafeParameters(), ElementsAre(HasSubstr("FS_THR_ENABLE is 1: the pilot's")));
  EXPECT_EQ(std::ranges::count_if(
                talk.notes,
                [](const std::string& note) { return note.find("unsafe parameter") != std::string::npos; }),
            1);
}

TEST(AutopilotClient, AsksAgainWhenAnotherStationHasSlowedAStreamDown) {
  Talk talk;
  talk.Run(5.0);
  mavlink::CommandLong slow;
  slow.target_system = 1;
  slow.command = mavlink::kCmdSetMessageInterval;
  slow.param1 = mavlink::LocalPositionNed::kId;
  slow.param2 = 250'000.0F;
  mavlink::Encoder ground(255, 190);
  mavlink::FrameParser parser;
  for (const auto& frame : parser.Feed(ground.Encode(slow))) talk.autopilot.Receive(frame);
  const std::size_t asked = talk.autopilot.commands.size();
  talk.Run(5.0);
  ASSERT_GT(talk.autopilot.commands.size(), asked);
  EXPECT_EQ(talk.autopilot.commands.back().param1, slow.param1);
  EXPECT_NEAR(talk.autopilot.commands.back().param2, 20'000.0, 1.0);
}

TEST(AutopilotClient, LeavesTheOtherComponentsOfItsVehicleAlone) {
  Talk talk;
  talk.Run(4.0);
  mavlink::FrameParser parser;
  for (const std::uint8_t component :
       std::to_array<std::uint8_t>({100, 154, 156, 191})) {  // Camera, gimbal, ADS-B, a companion.
    mavlink::Encoder other(1, component);
    mavlink::Heartbeat heartbeat;
    heartbeat.custom_mode = mavlink::kCopterLand;
    heartbeat.autopilot = component == 154 ? mavlink::kAutopilotArduPilot : mavlink::kAutopilotInvalid;
    heartbeat.system_status = mavlink::kStateCritical;
    for (const auto& frame : parser.Feed(other.Encode(heartbeat))) talk.client.Receive(frame, talk.now);
    mavlink::LocalPositionNed elsewhere;
    elsewhere.x = 1000.0F;
    for (const auto& frame : parser.Feed(other.Encode(elsewhere))) talk.client.Receive(frame, talk.now);
  }
  EXPECT_EQ(talk.Report().mode, "STABILIZE");
  EXPECT_FALSE(talk.Report().is_in_failsafe);
  EXPECT_LT(talk.Report().position_in_map_m.norm(), 0.02);
}

TEST(AutopilotClient, FollowsTheGimbalsAttitude) {
  Talk talk(mavlink::kAutopilotArduPilot, true);
  talk.Run(4.0);
  talk.TakeOff(3.0);
  talk.autopilot.yaw_ned_rad = 0.5 * std::numbers::pi;  // East.
  talk.intent.kind = Intent::Kind::kFlyTo;
  talk.intent.position_in_map_m = {0.0, 0.0, 3.0};
  talk.intent.camera_pitch_rad = -0.5;
  talk.Run(2.0);
  ASSERT_TRUE(talk.Report().gimbal_pitch_rad.has_value());
  EXPECT_NEAR(*talk.Report().gimbal_pitch_rad, -0.5, 1e-4);
  const auto map_from_gimbal = talk.client.poses().FindGimbal(talk.now.utc_ns - 200'000'000);
  ASSERT_TRUE(map_from_gimbal.has_value());
  const Eigen::Vector3d view = *map_from_gimbal * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(view.x(), std::cos(0.5), 1e-3);
  EXPECT_NEAR(view.z(), -std::sin(0.5), 1e-3);
}

TEST(AutopilotClient, LeavesOtherSystemsAlone) {
  Talk talk;
  talk.Run(4.0);
  mavlink::Encoder ground(255, 190);
  mavlink::Encoder other(2, 1);
  mavlink::FrameParser parser;
  mavlink::Heartbeat heartbeat;
  heartbeat.type = mavlink::kTypeGcs;
  heartbeat.autopilot = mavlink::kAutopilotInvalid;
  for (const auto& frame : parser.Feed(ground.Encode(heartbeat))) talk.client.Receive(frame, talk.now);
  heartbeat.type = mavlink::kTypeQuadrotor;
  heartbeat.autopilot = mavlink::kAutopilotPx4;
  for (const auto& frame : parser.Feed(other.Encode(heartbeat))) talk.client.Receive(frame, talk.now);
  EXPECT_EQ(talk.Report().autopilot, "ArduPilot");
}

TEST(AutopilotClient, DoesNotTrustPosesWithoutATimeBase) {
  Talk talk;
  talk.autopilot.answers_timesync = false;
  talk.Run(5.0);
  EXPECT_FALSE(talk.client.TrustsPoses(talk.now));
  EXPECT_TRUE(talk.Report().has_position);
}

TEST(AutopilotClient, ExpectsGreaterErrorsWhenTheSensorsContradictTheEstimator) {
  for (const mavlink::Autopilot make : {mavlink::kAutopilotArduPilot, mavlink::kAutopilotPx4}) {
    Talk talk(make);
    talk.Run(4.0);
    EXPECT_NEAR(talk.Report().position_std_m, 0.05, 1e-9);
    talk.autopilot.estimator_ratio = 0.8F;
    talk.Run(1.0);
    EXPECT_NEAR(talk.Report().position_std_m, 0.10, 1e-6);
    EXPECT_NEAR(talk.Report().orientation_std_rad, 0.02, 1e-6);
    EXPECT_TRUE(talk.client.TrustsPoses(talk.now));
    talk.autopilot.estimator_ratio = 1.1F;
    talk.Run(1.0);
    EXPECT_FALSE(talk.client.TrustsPoses(talk.now));
  }
}

TEST(AutopilotClient, DoesNotTrustAnEstimatorWhoseRatiosAreNoNumbers) {
  Talk talk;
  talk.Run(3.0);
  ASSERT_TRUE(talk.client.TrustsPoses(talk.now));
  talk.autopilot.estimator_ratio = std::numeric_limits<float>::quiet_NaN();
  talk.Run(1.0);
  EXPECT_FALSE(talk.client.TrustsPoses(talk.now));
  EXPECT_GT(talk.Report().position_std_m, 1.0);
}

TEST(AutopilotClient, DoesNotTrustPosesOfWhichTheEstimatorExpectsGreatErrors) {
  Talk talk(mavlink::kAutopilotPx4);
  talk.Run(4.0);
  EXPECT_TRUE(talk.client.TrustsPoses(talk.now));
  talk.autopilot.estimator_accuracy_m = 3.1F;
  talk.Run(1.0);
  EXPECT_FALSE(talk.client.TrustsPoses(talk.now));
}

TEST(AutopilotClient, InterpolatesThePoseOfAMoment) {
  Talk talk;
  talk.Run(4.0);
  talk.TakeOff(5.0);
  talk.intent.kind = Intent::Kind::kFlyTo;
  talk.intent.position_in_map_m = {50.0, 0.0, 5.0};
  talk.Run(3.0);
  const std::int64_t moment_ns = talk.now.utc_ns;
  const double x_m = talk.autopilot.position_ned_m.y();
  talk.Run(1.0);
  const auto pose = talk.client.poses().FindBody(moment_ns);
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR(pose->translation_m.x(), x_m, 0.07);  // 20 ms at 3 m/s.
  EXPECT_FALSE(talk.client.poses().FindBody(talk.now.utc_ns + 1'000'000'000).has_value());
}

TEST(AutopilotClient, FliesPx4InOffboardWithSetpointsBeforeAndDuringIt) {
  Talk talk(mavlink::kAutopilotPx4);
  talk.Run(4.0);
  EXPECT_EQ(talk.Report().autopilot, "PX4");
  EXPECT_THAT(talk.Report().not_ready, IsEmpty());
  talk.TakeOff(4.0);
  EXPECT_EQ(talk.Report().mode, "OFFBOARD");
  EXPECT_NEAR(talk.Report().position_in_map_m.z(), 4.0, 0.3);
  EXPECT_EQ(talk.CountCommands(mavlink::kCmdNavTakeoff), 0);
  EXPECT_GT(talk.autopilot.setpoints.size(), 100U);
  talk.intent.kind = Intent::Kind::kLand;
  talk.Run(10.0);
  EXPECT_EQ(talk.Report().mode, "AUTO.LAND");
  EXPECT_FALSE(talk.Report().is_armed);
}

TEST(MapFromBody, TurnsMavlinksAttitudeIntoTheMaps) {
  const auto turned = [](double yaw_ned_rad) {
    return MapFromBody(Eigen::Quaterniond(Eigen::AngleAxisd(yaw_ned_rad, Eigen::Vector3d::UnitZ())));
  };
  EXPECT_TRUE((turned(0.0) * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));  // North.
  EXPECT_TRUE((turned(0.0) * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitZ()));  // Up stays up.
  EXPECT_TRUE((turned(0.5 * std::numbers::pi) * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond nose_up =
      MapFromBody(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY())));
  EXPECT_GT((nose_up * Eigen::Vector3d::UnitX()).z(), 0.29);
}

}  // namespace
}  // namespace soffit
