#include <gmock/gmock.h>

#include <cmath>

#include "test/sim/autopilot/test_flight.h"

namespace soffit::sim {
namespace {

using namespace mavlink;
using ::testing::Eq;
using ::testing::Optional;

TestFlight Ready() {
  TestFlight flight(MakePx4({GeodeticOrigin{47.4, 8.5, 488.0}, true}));
  flight.Run(3.5);
  return flight;
}

/// Streams a setpoint at 10 Hz.
void Stream(TestFlight& flight, double seconds, float down_m) {
  for (double t = 0.0; t < seconds; t += 0.1) {
    flight.GoTo(0, 0, down_m);
    flight.Run(0.1);
  }
}

TestFlight InOffboard(float height_m) {
  TestFlight flight = Ready();
  Stream(flight, 1.0, -height_m);
  EXPECT_THAT(flight.Command(kCmdDoSetMode, {1, kPx4Offboard}), Optional(Eq(kResultAccepted)));
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultAccepted)));
  Stream(flight, 10.0, -height_m);
  return flight;
}

TEST(Px4, TellsItsStateWithoutBeingAsked) {
  TestFlight flight = Ready();
  flight.Run(2.0);
  EXPECT_EQ(flight.Last<Heartbeat>()->autopilot, kAutopilotPx4);
  EXPECT_GT(flight.Count<LocalPositionNed>(), 30u);
  EXPECT_GT(flight.Count<EstimatorStatus>(), 0u);
  EXPECT_EQ(flight.Count<EkfStatusReport>(), 0u);
}

TEST(Px4, RefusesOffboardWithoutAStreamOfSetpoints) {
  TestFlight flight = Ready();
  EXPECT_THAT(flight.Command(kCmdDoSetMode, {1, kPx4Offboard}), Optional(Eq(kResultTemporarilyRejected)));
  flight.GoTo(0, 0, -3);
  flight.Run(0.7);
  flight.GoTo(0, 0, -3);  // Slower than 2 Hz.
  EXPECT_THAT(flight.Command(kCmdDoSetMode, {1, kPx4Offboard}), Optional(Eq(kResultTemporarilyRejected)));
}

TEST(Px4, FliesWhatIsStreamedInOffboard) {
  TestFlight flight = InOffboard(3.0F);
  EXPECT_EQ(flight.autopilot->ModeName(), "OFFBOARD");
  EXPECT_NEAR(flight.height_m(), 3.0, 0.15);
}

TEST(Px4, HoldsWhenTheStreamStops) {
  TestFlight flight = InOffboard(3.0F);
  flight.Run(0.8);
  EXPECT_EQ(flight.autopilot->ModeName(), "OFFBOARD");
  flight.Run(0.5);
  EXPECT_EQ(flight.autopilot->ModeName(), "AUTO.LOITER");
  flight.Run(5.0);
  EXPECT_NEAR(flight.height_m(), 3.0, 0.15);
  EXPECT_EQ(flight.Last<Heartbeat>()->system_status, kStateCritical);
}

TEST(Px4, TakesOffToAHeightAboveTheSeaAndLands) {
  TestFlight flight = Ready();
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultAccepted)));
  EXPECT_THAT(flight.Command(kCmdNavTakeoff, {0, 0, 0, NAN, NAN, NAN, 492}), Optional(Eq(kResultAccepted)));
  flight.Run(12.0);
  EXPECT_NEAR(flight.height_m(), 4.0, 0.2);
  EXPECT_EQ(flight.autopilot->ModeName(), "AUTO.LOITER");
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {0}), Optional(Eq(kResultDenied)));
  EXPECT_THAT(flight.Command(kCmdNavLand), Optional(Eq(kResultAccepted)));
  EXPECT_TRUE(flight.RunUntil([&] { return !flight.autopilot->is_armed(); }, 20.0).has_value());
}

TEST(Px4, DisarmsAfterTenSecondsOnTheGround) {
  TestFlight flight = Ready();
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultAccepted)));
  flight.Run(9.0);
  EXPECT_TRUE(flight.autopilot->is_armed());
  flight.Run(2.0);
  EXPECT_FALSE(flight.autopilot->is_armed());
}

TEST(Px4, RefusesToArmBeforeItKnowsWhereItIs) {
  TestFlight flight(MakePx4({GeodeticOrigin{47.4, 8.5, 488.0}}));
  flight.Run(5.0);
  EXPECT_THAT(flight.Command(kCmdComponentArmDisarm, {1}), Optional(Eq(kResultTemporarilyRejected)));
  EXPECT_TRUE(flight.Heard("Arming denied"));
}

}  // namespace
}  // namespace soffit::sim
