#include "shared/wire/topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace soffit {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Capture SomeCapture() {
  Capture capture;
  capture.vehicle_id = 3;
  capture.mission_id = 1234567890123;
  capture.capture_id = 7;
  capture.name = "wall_2.jpg";
  capture.purpose = Purpose::kWall;
  capture.exposure_utc_ns = 1'700'000'000'123'456'789;
  capture.intrinsics = {1280, 960, 850.0, 851.0, 640.5, 479.5, {0.1, -0.05, 0.001, 0.002, 0.003}};
  capture.map_from_camera = {CameraAttitude(0.4, -0.2), {1.0, 2.0, 3.0}};
  capture.has_trusted_pose = true;
  capture.position_std_m = 0.05;
  capture.orientation_std_rad = 0.01;
  capture.bytes = {0xff, 0xd8, 0xff, 0x00};
  return capture;
}

FlightCommand SomeCommand() {
  FlightCommand command;
  command.vehicle_id = 3;
  command.mission_id = 9;
  command.sequence = 4;
  command.issued_utc_ns = 100;
  command.valid_until_utc_ns = 200;
  command.kind = CommandKind::kFlyCorridor;
  command.path_in_map_m = {{1, 2, 3}, {4, 5, 6}};
  command.yaw_rad = 0.5;
  command.speed_mps = 1.5;
  command.permit = CorridorPermit{11, 2, 33, 400, {0.35, 0.3, 0.25}, 1.7, 1.4};
  return command;
}

TEST(CaptureTopic, KeepsEverythingThroughTheWire) {
  const Capture sent = SomeCapture();
  const auto received = CaptureTopic::FromWire(CaptureTopic::ToWire(sent));
  ASSERT_TRUE(received.ok()) << received.error().message;
  const Capture& got = received.value();
  EXPECT_EQ(got.vehicle_id, sent.vehicle_id);
  EXPECT_EQ(got.mission_id, sent.mission_id);
  EXPECT_EQ(got.capture_id, sent.capture_id);
  EXPECT_EQ(got.name, sent.name);
  EXPECT_EQ(got.purpose, sent.purpose);
  EXPECT_EQ(got.exposure_utc_ns, sent.exposure_utc_ns);
  EXPECT_EQ(got.intrinsics.distortion, sent.intrinsics.distortion);
  EXPECT_EQ(got.intrinsics.width_px, sent.intrinsics.width_px);
  EXPECT_TRUE(got.map_from_camera.rotation.isApprox(sent.map_from_camera.rotation, 1e-15));
  EXPECT_EQ(got.map_from_camera.translation_m, sent.map_from_camera.translation_m);
  EXPECT_TRUE(got.has_trusted_pose);
  EXPECT_NEAR(got.position_std_m, 0.05, 1e-12);
  EXPECT_NEAR(got.orientation_std_rad, 0.01, 1e-12);
  EXPECT_EQ(got.bytes, sent.bytes);
}

TEST(CaptureTopic, TakesTheWorstDirectionOfACovariance) {
  wire::Capture message = CaptureTopic::ToWire(SomeCapture());
  message.pose_covariance()[0] = 0.04;
  message.pose_covariance()[1] = message.pose_covariance()[6] = 0.02;
  message.pose_covariance()[7] = 0.04;
  const auto received = CaptureTopic::FromWire(message);
  ASSERT_TRUE(received.ok());
  EXPECT_NEAR(received.value().position_std_m, std::sqrt(0.06), 1e-9);
}

TEST(CaptureTopic, RefusesWhatIsNoPictureOfAnyCamera) {
  const auto refuses = [](auto spoil) {
    wire::Capture message = CaptureTopic::ToWire(SomeCapture());
    spoil(message);
    return !CaptureTopic::FromWire(message).ok();
  };
  EXPECT_TRUE(refuses([](auto& m) { m.bytes().clear(); }));
  EXPECT_TRUE(refuses([](auto& m) { m.purpose(static_cast<wire::Purpose>(99)); }));
  EXPECT_TRUE(refuses([](auto& m) { m.map_from_camera().orientation().w(kNan); }));
  EXPECT_TRUE(refuses([](auto& m) { m.map_from_camera().orientation(wire::Quaternion()); }));
  EXPECT_TRUE(refuses([](auto& m) { m.map_from_camera().position_m().x(kNan); }));
  EXPECT_TRUE(refuses([](auto& m) { m.intrinsics().fx_px(0.0); }));
  EXPECT_TRUE(refuses([](auto& m) { m.intrinsics().width_px(4'000'000'000u); }));
  EXPECT_TRUE(refuses([](auto& m) { m.pose_covariance()[0] = -1.0; }));
  EXPECT_TRUE(refuses([](auto& m) { m.pose_covariance()[22] = kNan; }));
}

TEST(FlightCommandTopic, KeepsEverythingThroughTheWire) {
  const FlightCommand sent = SomeCommand();
  const auto received = FlightCommandTopic::FromWire(FlightCommandTopic::ToWire(sent));
  ASSERT_TRUE(received.ok()) << received.error().message;
  const FlightCommand& got = received.value();
  EXPECT_EQ(got.sequence, sent.sequence);
  EXPECT_EQ(got.valid_until_utc_ns, sent.valid_until_utc_ns);
  EXPECT_EQ(got.kind, sent.kind);
  EXPECT_EQ(got.path_in_map_m, sent.path_in_map_m);
  EXPECT_EQ(got.speed_mps, sent.speed_mps);
  ASSERT_TRUE(got.permit.has_value());
  EXPECT_EQ(got.permit->decision_id, 11u);
  EXPECT_EQ(got.permit->scene_revision, 33u);
  EXPECT_EQ(got.permit->envelope.radius_m, 0.35);
}

TEST(FlightCommandTopic, AnEmptyMessageIsToHoldWithoutAPermit) {
  const auto received = FlightCommandTopic::FromWire(wire::FlightCommand());
  ASSERT_TRUE(received.ok()) << received.error().message;
  EXPECT_EQ(received.value().kind, CommandKind::kHold);
  EXPECT_FALSE(received.value().permit.has_value());
}

TEST(FlightCommandTopic, RefusesNumbersThatAreNone) {
  const auto refuses = [](auto spoil) {
    wire::FlightCommand message = FlightCommandTopic::ToWire(SomeCommand());
    spoil(message);
    return !FlightCommandTopic::FromWire(message).ok();
  };
  EXPECT_TRUE(refuses([](auto& m) { m.path_in_map_m()[1].y(kNan); }));
  EXPECT_TRUE(refuses([](auto& m) { m.path_in_map_m().resize(257); }));
  EXPECT_TRUE(refuses([](auto& m) { m.speed_mps(-1.0); }));
  EXPECT_TRUE(refuses([](auto& m) { m.kind(static_cast<wire::CommandKind>(7)); }));
  EXPECT_TRUE(refuses([](auto& m) { m.permit().envelope().radius_m(kNan); }));
  EXPECT_TRUE(refuses([](auto& m) { m.permit().free_width_m(kNan); }));
}

TEST(VehicleStateTopic, KeepsTheOriginOnlyWhenThereIsOne) {
  VehicleState state;
  state.vehicle_id = 5;
  state.name = "drone";
  state.phase = VehiclePhase::kPilotInControl;
  state.envelope = {0.35, 0.3, 0.25};
  const auto without = VehicleStateTopic::FromWire(VehicleStateTopic::ToWire(state));
  ASSERT_TRUE(without.ok()) << without.error().message;
  EXPECT_FALSE(without.value().origin.has_value());
  EXPECT_EQ(without.value().phase, VehiclePhase::kPilotInControl);
  EXPECT_EQ(without.value().battery_ratio, -1.0);

  state.origin = GeodeticOrigin{50.0, 20.0, 230.0};
  const auto with = VehicleStateTopic::FromWire(VehicleStateTopic::ToWire(state));
  ASSERT_TRUE(with.ok());
  ASSERT_TRUE(with.value().origin.has_value());
  EXPECT_EQ(with.value().origin->longitude_deg, 20.0);
}

TEST(VehicleStateTopic, SaysWhatIsWrongWithAMessage) {
  wire::VehicleState message;
  message.yaw_rad(kNan);
  const auto received = VehicleStateTopic::FromWire(message);
  ASSERT_FALSE(received.ok());
  EXPECT_THAT(received.error().message, HasSubstr("yaw_rad"));
}

TEST(VehicleStateTopic, NamesTheWayToAWrongPart) {
  wire::VehicleState message;
  message.camera().plumb_bob()[4] = kNan;
  const auto received = VehicleStateTopic::FromWire(message);
  ASSERT_FALSE(received.ok());
  EXPECT_THAT(received.error().message, HasSubstr("camera.plumb_bob is not a finite number"));
}

TEST(CommandAckTopic, RefusesAnUnknownStatus) {
  wire::CommandAck message;
  message.status(static_cast<wire::AckStatus>(wire::ACK_FAILED + 1));
  const auto received = CommandAckTopic::FromWire(message);
  ASSERT_FALSE(received.ok());
  EXPECT_THAT(received.error().message, HasSubstr("status has an unknown value"));
}

TEST(CommandAckTopic, CutsAReasonThatIsTooLong) {
  CommandAck ack;
  ack.status = AckStatus::kRefused;
  ack.reason = std::string(2000, 'x');
  const auto received = CommandAckTopic::FromWire(CommandAckTopic::ToWire(ack));
  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received.value().reason, std::string(512, 'x'));
  EXPECT_EQ(received.value().status, AckStatus::kRefused);
}

}  // namespace
}  // namespace soffit
