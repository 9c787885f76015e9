#include "vehicle_agent/autopilot/parameter_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>

#include "vehicle_agent/mavlink/codec.h"
#include "vehicle_agent/mavlink/constants.h"

namespace soffit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const ParameterValues kSafeArduPilot = {{"FS_EKF_ACTION", 1}, {"FS_THR_ENABLE", 3},   {"FS_OPTIONS", 0},
                                        {"FS_GCS_ENABLE", 0}, {"BATT_FS_LOW_ACT", 1}, {"FENCE_ACTION", 2},
                                        {"FENCE_ENABLE", 1}};
const ParameterValues kSafePx4 = {{"COM_OBL_RC_ACT", 5}, {"COM_OF_LOSS_T", 1}, {"NAV_RCL_ACT", 1},
                                  {"COM_RCL_EXCEPT", 0}, {"NAV_DLL_ACT", 0},   {"COM_LOW_BAT_ACT", 2}};

ParameterValues With(ParameterValues values, const char* name, double value) {
  values[name] = value;
  return values;
}

TEST(FindUnsafeParameters, FindsNothingWrongWithSafeOnes) {
  EXPECT_THAT(FindUnsafeParameters(Dialect::kArduPilot, kSafeArduPilot), IsEmpty());
  EXPECT_THAT(FindUnsafeParameters(Dialect::kPx4, kSafePx4), IsEmpty());
}

struct Unsafe {
  Dialect dialect;
  const char* name;
  double value;
};
void PrintTo(const Unsafe& it, std::ostream* out) { *out << it.name; }

class UnsafeParameter : public ::testing::TestWithParam<Unsafe> {};

TEST_P(UnsafeParameter, IsFoundWithWhatToSet) {
  const Unsafe& it = GetParam();
  const ParameterValues& safe = it.dialect == Dialect::kPx4 ? kSafePx4 : kSafeArduPilot;
  EXPECT_THAT(FindUnsafeParameters(it.dialect, With(safe, it.name, it.value)),
              ElementsAre(::testing::AllOf(HasSubstr(it.name), HasSubstr("set "))));
}

INSTANTIATE_TEST_SUITE_P(Each, UnsafeParameter,
                         ::testing::Values(Unsafe{Dialect::kArduPilot, "FS_EKF_ACTION", 2},
                                           Unsafe{Dialect::kArduPilot, "FS_THR_ENABLE", 1},
                                           Unsafe{Dialect::kArduPilot, "FS_GCS_ENABLE", 1},
                                           Unsafe{Dialect::kArduPilot, "BATT_FS_LOW_ACT", 2},
                                           Unsafe{Dialect::kArduPilot, "FENCE_ACTION", 1},
                                           Unsafe{Dialect::kPx4, "COM_OBL_RC_ACT", 3},
                                           Unsafe{Dialect::kPx4, "COM_OF_LOSS_T", 10},
                                           Unsafe{Dialect::kPx4, "NAV_RCL_ACT", 2},
                                           Unsafe{Dialect::kPx4, "NAV_DLL_ACT", 2},
                                           Unsafe{Dialect::kPx4, "COM_LOW_BAT_ACT", 3}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(FindUnsafeParameters, LetsExceptionsMakeAFailsafeSafe) {
  EXPECT_THAT(FindUnsafeParameters(Dialect::kArduPilot,
                                   With(With(kSafeArduPilot, "FS_THR_ENABLE", 1), "FS_OPTIONS", 4)),
              IsEmpty());
  EXPECT_THAT(FindUnsafeParameters(Dialect::kArduPilot,
                                   With(With(kSafeArduPilot, "FENCE_ACTION", 1), "FENCE_ENABLE", 0)),
              IsEmpty());
  EXPECT_THAT(
      FindUnsafeParameters(Dialect::kPx4, With(With(kSafePx4, "NAV_RCL_ACT", 2), "COM_RCL_EXCEPT", 4)),
      IsEmpty());
}

TEST(FindUnsafeParameters, NamesWhatCouldNotBeRead) {
  EXPECT_THAT(FindUnsafeParameters(Dialect::kPx4, {}), SizeIs(5));
  EXPECT_THAT(FindUnsafeParameters(Dialect::kPx4, {}).front(), HasSubstr("could not be read"));
  EXPECT_THAT(FindUnsafeParameters(Dialect::kUnknown, {}), IsEmpty());
}

mavlink::ParamValue Tell(const std::string& name, float value, std::uint8_t type) {
  mavlink::ParamValue message;
  message.param_id = mavlink::ToTextField<16>(name);
  message.param_value = value;
  message.param_type = type;
  return message;
}

TEST(ParameterWatch, AsksForEachUntilItIsToldOrAskedForInVain) {
  ParameterWatch watch;
  EXPECT_TRUE(watch.IsDone());
  watch.Begin(Dialect::kPx4);
  Instant now{1, 1};
  int asks = 0;
  for (; !watch.IsDone() && asks < 1000; now.steady_ns += 100'000'000) {
    const auto name = watch.FindNextToAsk(now);
    if (!name) continue;
    ++asks;
    if (*name != "NAV_DLL_ACT") watch.Take(Tell(*name, 2.0F, mavlink::kParamReal32));
  }
  EXPECT_EQ(asks, 5 + 5);
  EXPECT_THAT(watch.values(), SizeIs(5));
}

TEST(ParameterWatch, ReadsWholeNumbersAsEachAutopilotSendsThem) {
  ParameterWatch watch;
  watch.Begin(Dialect::kPx4);
  watch.Take(Tell("COM_OBL_RC_ACT", std::bit_cast<float>(std::int32_t{5}), mavlink::kParamInt32));
  EXPECT_EQ(watch.values().at("COM_OBL_RC_ACT"), 5.0);
  watch.Begin(Dialect::kArduPilot);
  watch.Take(Tell("FS_THR_ENABLE", 3.0F, mavlink::kParamInt8));
  watch.Take(Tell("NOT_ASKED_FOR", 3.0F, mavlink::kParamInt8));
  EXPECT_THAT(watch.values(), ElementsAre(std::pair<const std::string, double>("FS_THR_ENABLE", 3.0)));
}

}  // namespace
}  // namespace soffit
