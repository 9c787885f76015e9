#include <gmock/gmock.h>

#include <cmath>

#include "test/sim/vehicle/estimator.h"
#include "test/sim/vehicle/multicopter.h"
#include "test/sim/vehicle/noise.h"

namespace soffit::sim {
namespace {

constexpr double kStep_s = 0.005;

BodyState InTheAir(double height_m) {
  BodyState state;
  state.position_m.z() = height_m;
  state.is_on_ground = false;
  return state;
}

MotorCommand Hover() { return {true, kGravity_mps2, Eigen::Quaterniond::Identity()}; }

TEST(Multicopter, StaysOnTheGroundUntilThrustExceedsItsWeight) {
  Multicopter vehicle{BodyState{}};
  for (int i = 0; i < 200; ++i)
    vehicle.Step({true, 0.9 * kGravity_mps2, {1, 0, 0, 0}}, {5.0, 0.0, 0.0}, kStep_s);
  EXPECT_TRUE(vehicle.state().is_on_ground);
  EXPECT_EQ(vehicle.state().position_m, Eigen::Vector3d::Zero());
  for (int i = 0; i < 200; ++i)
    vehicle.Step({true, 1.2 * kGravity_mps2, {1, 0, 0, 0}}, {0.0, 0.0, 0.0}, kStep_s);
  EXPECT_GT(vehicle.state().position_m.z(), 0.5);
}

TEST(Multicopter, TurnsToItsAttitudeWithALagAndWithoutOvershooting) {
  Multicopter vehicle(InTheAir(50.0));
  MotorCommand command = Hover();
  command.map_from_body = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
  double angle_after_tenth_s = 0.0;
  double greatest = 0.0;
  for (int i = 0; i < 300; ++i) {
    vehicle.Step(command, Eigen::Vector3d::Zero(), kStep_s);
    const double angle = Eigen::AngleAxisd(vehicle.state().map_from_body).angle();
    if (i == 20) angle_after_tenth_s = angle;
    greatest = std::max(greatest, angle);
  }
  EXPECT_LT(angle_after_tenth_s, 0.15);
  EXPECT_NEAR(greatest, 0.3, 0.01);
  EXPECT_GT(vehicle.state().velocity_mps.x(), 1.0);  // Nose down: forward.
}

TEST(Multicopter, IsCarriedAlongByTheWind) {
  Multicopter vehicle(InTheAir(50.0));
  for (int i = 0; i < 8000; ++i) vehicle.Step(Hover(), {3.0, -1.0, 0.0}, kStep_s);
  EXPECT_NEAR(vehicle.state().velocity_mps.x(), 3.0, 0.05);
  EXPECT_NEAR(vehicle.state().velocity_mps.y(), -1.0, 0.05);
}

TEST(Multicopter, FallsWhenBrokenOrEmpty) {
  for (const bool is_empty : {false, true}) {
    Multicopter vehicle(InTheAir(5.0));
    if (is_empty) {
      vehicle.SetBattery(0.0);
    } else {
      vehicle.Break();
    }
    for (int i = 0; i < 600; ++i) vehicle.Step(Hover(), Eigen::Vector3d::Zero(), kStep_s);
    EXPECT_TRUE(vehicle.state().is_on_ground);
    EXPECT_GT(vehicle.state().touchdown_speed_mps, 5.0);
  }
}

TEST(Multicopter, EmptiesItsBatteryInTwentyMinutesOfHovering) {
  Multicopter vehicle(InTheAir(50.0));
  for (int i = 0; i < 200 * 60; ++i) vehicle.Step(Hover(), Eigen::Vector3d::Zero(), kStep_s);
  EXPECT_NEAR(vehicle.state().battery_ratio, 1.0 - 1.0 / 20.0, 0.002);
}

TEST(MovingAir, HasTheMeanAndTheGustsOfTheWorld) {
  MovingAir air({{2.0, 1.0}, 0.8}, 5);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  constexpr int kCount = 400'000;
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector3d wind = air.Step(kStep_s);
    sum += wind;
    squares += wind.cwiseAbs2();
  }
  const Eigen::Vector3d mean = sum / kCount;
  const Eigen::Vector3d deviation = (squares / kCount - mean.cwiseAbs2()).cwiseSqrt();
  EXPECT_NEAR(mean.x(), 2.0, 0.1);
  EXPECT_NEAR(mean.y(), 1.0, 0.1);
  EXPECT_NEAR(deviation.x(), 0.8, 0.08);
  EXPECT_NEAR(deviation.z(), 0.4, 0.05);
}

TEST(Estimator, IsWrongByThePoseNoiseAndSlowly) {
  constexpr int kCount = 2'000'000;
  const PoseNoise noise{0.08, 0.01};
  Estimator estimator(noise, 3);
  const BodyState truth = InTheAir(4.0);
  double squares = 0.0;
  double turn_squares = 0.0;
  double greatest_step_m = 0.0;
  Eigen::Vector3d last = estimator.Step(truth, kStep_s).position_m;
  for (int i = 0; i < kCount; ++i) {
    const Estimate estimate = estimator.Step(truth, kStep_s);
    squares += (estimate.position_m - truth.position_m).squaredNorm() / 3.0;
    turn_squares += std::pow(Eigen::AngleAxisd(estimate.map_from_body).angle(), 2) / 3.0;
    greatest_step_m = std::max(greatest_step_m, (estimate.position_m - last).norm());
    last = estimate.position_m;
  }
  EXPECT_NEAR(std::sqrt(squares / kCount), 0.08, 0.008);
  EXPECT_NEAR(std::sqrt(turn_squares / kCount), 0.01, 0.001);
  EXPECT_LT(greatest_step_m, 0.03);
}

TEST(Estimator, GivesTheAttitudeThatIsTakenWhenAnotherIsBelieved) {
  Estimator estimator({0.0, 0.05}, 4);
  const BodyState truth = InTheAir(4.0);
  const Estimate estimate = estimator.Step(truth, kStep_s);
  EXPECT_LT(estimator.ToTruth(estimate.map_from_body).angularDistance(truth.map_from_body), 1e-9);
}

TEST(Estimator, GivesTheSameErrorsForTheSameSeed) {
  const PoseNoise noise{0.08, 0.01};
  Estimator one(noise, 7);
  Estimator two(noise, 7);
  Estimator other(noise, 8);
  const BodyState truth = InTheAir(4.0);
  const Eigen::Vector3d first = one.Step(truth, kStep_s).position_m;
  EXPECT_EQ(first, two.Step(truth, kStep_s).position_m);
  EXPECT_NE(first, other.Step(truth, kStep_s).position_m);
}

}  // namespace
}  // namespace soffit::sim
