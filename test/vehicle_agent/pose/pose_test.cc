#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "vehicle_agent/pose/camera_mount.h"
#include "vehicle_agent/pose/clock_offset.h"
#include "vehicle_agent/pose/pose_buffer.h"

namespace soffit {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kOffset_ns = 1'700'000'000'000'000'000;

Eigen::Quaterniond Turn(double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitZ()));
}

TEST(PoseBuffer, InterpolatesPositionsAndAttitudesThatComeAtDifferentTimes) {
  PoseBuffer buffer;
  buffer.AddPosition(100 * kMs, {0.0, 0.0, 0.0});
  buffer.AddPosition(200 * kMs, {1.0, 2.0, -3.0});
  buffer.AddAttitude(90 * kMs, Turn(0.0));
  buffer.AddAttitude(190 * kMs, Turn(1.0));
  const auto pose = buffer.FindBody(140 * kMs);
  ASSERT_TRUE(pose.has_value());
  EXPECT_TRUE(pose->translation_m.isApprox(Eigen::Vector3d(0.4, 0.8, -1.2)));
  EXPECT_NEAR(pose->rotation.angularDistance(Turn(0.5)), 0.0, 1e-9);
}

TEST(PoseBuffer, TurnsTheShortWay) {
  PoseBuffer buffer;
  const Eigen::Quaterniond to = Turn(0.2);
  for (const std::int64_t t : {0, 100}) buffer.AddPosition((t + 1) * kMs, Eigen::Vector3d::Zero());
  buffer.AddAttitude(1 * kMs, Turn(0.0));
  buffer.AddAttitude(101 * kMs, Eigen::Quaterniond(-to.w(), -to.x(), -to.y(), -to.z()));
  EXPECT_NEAR(buffer.FindBody(51 * kMs)->rotation.angularDistance(Turn(0.1)), 0.0, 1e-9);
}

TEST(PoseBuffer, NeitherExtrapolatesNorBridgesGaps) {
  PoseBuffer buffer;
  EXPECT_FALSE(buffer.FindBody(0).has_value());
  for (const std::int64_t t : {100, 200, 900, 1000}) {
    buffer.AddPosition(t * kMs, Eigen::Vector3d::Zero());
    buffer.AddAttitude(t * kMs, Turn(0.0));
  }
  EXPECT_FALSE(buffer.FindBody(99 * kMs).has_value());
  EXPECT_TRUE(buffer.FindBody(150 * kMs).has_value());
  EXPECT_FALSE(buffer.FindBody(500 * kMs).has_value());
  EXPECT_FALSE(buffer.FindBody(1001 * kMs).has_value());
  EXPECT_EQ(buffer.newest_utc_ns(), 1000 * kMs);
}

TEST(PoseBuffer, BeginsAnewWhenTheClockIsSetBack) {
  PoseBuffer buffer;
  buffer.AddPosition(5000 * kMs, {9.0, 9.0, 9.0});
  for (const std::int64_t t : {100, 200}) {
    buffer.AddPosition(t * kMs, {1.0, 0.0, 0.0});
    buffer.AddAttitude(t * kMs, Turn(0.0));
  }
  ASSERT_TRUE(buffer.FindBody(150 * kMs).has_value());
  EXPECT_EQ(buffer.FindBody(150 * kMs)->translation_m.x(), 1.0);
}

TEST(PoseBuffer, KeepsWhatIsOlderWhenTheClockIsSetBackALittle) {
  PoseBuffer buffer;
  for (const std::int64_t t : {100, 200, 300, 400, 250, 350}) {
    buffer.AddPosition(t * kMs, {1e-3 * static_cast<double>(t), 0.0, 0.0});
    buffer.AddAttitude(t * kMs, Turn(0.0));
  }
  ASSERT_TRUE(buffer.FindBody(150 * kMs).has_value());
  EXPECT_NEAR(buffer.FindBody(150 * kMs)->translation_m.x(), 0.15, 1e-9);
  EXPECT_EQ(buffer.newest_utc_ns(), 350 * kMs);
}

TEST(ClockOffset, IsUnknownAtFirst) {
  EXPECT_FALSE(ClockOffset().ToUtc(5).has_value());
  EXPECT_FALSE(ClockOffset().Uncertainty_ns().has_value());
}

TEST(ClockOffset, TakesTheQuickestExchange) {
  ClockOffset clock;
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int64_t> delay_ns(1 * kMs, 80 * kMs);
  for (int i = 1; i <= 40; ++i) {
    const std::int64_t remote_ns = i * 200 * kMs;
    clock.AddExchange(kOffset_ns + remote_ns - delay_ns(random), remote_ns,
                      kOffset_ns + remote_ns + delay_ns(random));
  }
  const std::int64_t error_ns = *clock.ToUtc(0) - kOffset_ns;
  EXPECT_LE(std::abs(error_ns), *clock.Uncertainty_ns());
  EXPECT_LT(*clock.Uncertainty_ns(), 20 * kMs);
}

TEST(ClockOffset, FallsBackToTheQuickestArrivalWithoutClaimingToKnowItsError) {
  ClockOffset clock;
  for (const std::int64_t delay_ms : {9, 3, 7})
    clock.AddArrival(delay_ms * 100 * kMs, kOffset_ns + delay_ms * 101 * kMs);
  EXPECT_EQ(*clock.ToUtc(0), kOffset_ns + 3 * kMs);
  EXPECT_FALSE(clock.Uncertainty_ns().has_value());
}

TEST(ClockOffset, FollowsAClockThatDrifts) {
  ClockOffset clock;
  std::int64_t truth_ns = kOffset_ns;
  for (int i = 1; i <= 120; ++i) {
    truth_ns = kOffset_ns + i * 20'000;  // 20 us per second.
    const std::int64_t remote_ns = i * 1000 * kMs;
    clock.AddExchange(truth_ns + remote_ns - kMs, remote_ns, truth_ns + remote_ns + kMs);
  }
  EXPECT_LT(std::abs(*clock.ToUtc(0) - truth_ns), kMs / 2);
}

TEST(ClockOffset, FollowsAClockThatFallsBehind) {
  ClockOffset clock;  // Of a simulator on a machine that is too slow: 50 ms are lost each second.
  std::int64_t truth_ns = 0;
  for (int i = 1; i <= 60; ++i) {
    truth_ns = kOffset_ns + i * 50 * kMs;
    const std::int64_t remote_ns = i * 950 * kMs;
    clock.AddExchange(truth_ns + remote_ns - kMs, remote_ns, truth_ns + remote_ns + kMs);
  }
  EXPECT_LT(truth_ns - *clock.ToUtc(0), 200 * kMs);
}

TEST(ClockOffset, IgnoresImpossibleExchanges) {
  ClockOffset clock;
  clock.AddExchange(100 * kMs, 1, 50 * kMs);
  EXPECT_FALSE(clock.ToUtc(0).has_value());
}

TEST(BodyFromCamera, LooksForwardUprightByDefault) {
  const auto mount = BodyFromCamera({});
  EXPECT_TRUE(
      (mount.rotation * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitX()));  // View: forward.
  EXPECT_TRUE((mount.rotation * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY()));  // Right.
  EXPECT_TRUE((mount.rotation * Eigen::Vector3d::UnitY()).isApprox(-Eigen::Vector3d::UnitZ()));  // Down.
}

TEST(BodyFromCamera, PointsADownwardCamerasUpperEdgeForward) {
  CameraMount down;
  down.pitch_deg = -90.0;
  down.up_m = -0.1;
  const auto mount = BodyFromCamera(down);
  EXPECT_TRUE((mount.rotation * Eigen::Vector3d::UnitZ()).isApprox(-Eigen::Vector3d::UnitZ()));
  EXPECT_LT((mount.rotation * -Eigen::Vector3d::UnitY() - Eigen::Vector3d::UnitX()).norm(), 1e-9);
  EXPECT_EQ(mount.translation_m.z(), -0.1);
}

TEST(BodyFromCamera, YawsLeftAndRollsClockwise) {
  CameraMount left;
  left.yaw_deg = 90.0;
  EXPECT_LT((BodyFromCamera(left).rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(),
            1e-9);
  CameraMount rolled;
  rolled.roll_deg = 90.0;  // The camera's right side turns down.
  EXPECT_LT((BodyFromCamera(rolled).rotation * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitZ()).norm(),
            1e-9);
}

}  // namespace
}  // namespace soffit
