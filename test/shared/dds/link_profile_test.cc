#include "shared/dds/link_profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/dds/participant.h"

namespace soffit {
namespace {

DdsOptions With(const std::string& profile, int flow_bytes_per_ms = 0) {
  DdsOptions options;
  options.profile = profile;
  options.flow_bytes_per_ms = flow_bytes_per_ms;
  return options;
}

TEST(FindLinkProfile, UsesMostOfEachLinkAndNotMore) {
  EXPECT_NEAR(FindLinkProfile(With("wired")).value().Rate_Bps() * 8e-6, 80.0, 1.0);
  EXPECT_NEAR(FindLinkProfile(With("wifi")).value().Rate_Bps() * 8e-6, 16.0, 1.0);
  EXPECT_NEAR(FindLinkProfile(With("lte")).value().Rate_Bps() * 8e-6, 4.8, 0.1);
  EXPECT_NEAR(FindLinkProfile(With("telemetry")).value().Rate_Bps() * 8e-6, 0.16, 0.01);
}

TEST(FindLinkProfile, LimitsNothingOnOneMachine) {
  EXPECT_EQ(FindLinkProfile(With("local")).value().flow_bytes, 0);
}

TEST(FindLinkProfile, TakesAFlowOfItsOwn) {
  const LinkProfile profile = FindLinkProfile(With("telemetry", 2800)).value();
  EXPECT_DOUBLE_EQ(profile.Rate_Bps(), 2.8e6);
  EXPECT_EQ(profile.heartbeat_s, FindLinkProfile(With("telemetry")).value().heartbeat_s);
}

TEST(FindLinkProfile, NamesAllWhenItKnowsNone) {
  const auto profile = FindLinkProfile(With("carrier-pigeon"));
  ASSERT_FALSE(profile.ok());
  EXPECT_THAT(profile.error().message, testing::HasSubstr("carrier-pigeon"));
  EXPECT_THAT(profile.error().message, testing::HasSubstr("wired, wifi, lte or telemetry"));
  EXPECT_FALSE(Participant::Join("test", With("carrier-pigeon"), {}).ok());
}

}  // namespace
}  // namespace soffit
