#include "shared/flight/flight.h"

#include <gtest/gtest.h>

#include <limits>

namespace soffit {
namespace {

TEST(VehicleEnvelope, IsNotValidByDefaultNorWithNaN) {
  EXPECT_FALSE(IsValid(VehicleEnvelope{}));
  EXPECT_TRUE(IsValid(VehicleEnvelope{0.35, 0.30, 0.0}));
  EXPECT_FALSE(IsValid(VehicleEnvelope{0.35, 0.30, std::numeric_limits<double>::quiet_NaN()}));
}

TEST(VehicleEnvelope, NeedsItsMarginOnBothSides) {
  const VehicleEnvelope envelope{0.35, 0.30, 0.25};
  EXPECT_DOUBLE_EQ(envelope.NeededWidth_m(), 1.2);
  EXPECT_DOUBLE_EQ(envelope.NeededHeight_m(), 0.8);
}

TEST(FlightCommand, HoldsByDefault) {
  EXPECT_EQ(FlightCommand{}.kind, CommandKind::kHold);
  EXPECT_EQ(CommandAck{}.status, AckStatus::kUnknown);
  EXPECT_EQ(VehicleState{}.phase, VehiclePhase::kNotReady);
}

}  // namespace
}  // namespace soffit
