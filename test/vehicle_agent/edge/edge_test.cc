#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>

#include "shared/options/yaml.h"
#include "vehicle_agent/edge/agent_config.h"
#include "vehicle_agent/edge/develop.h"

namespace soffit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

struct Finished {
  int code = 0;
  std::string output;
};

Finished RunAgent(const std::string& arguments) {
  Finished run;
  FILE* pipe = popen((std::string(SOFFIT_AGENT_PROGRAM) + " " + arguments + " 2>&1").c_str(), "r");
  std::array<char, 4096> part{};
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe))
    run.output.append(part.data(), size);
  run.code = pclose(pipe);
  return run;
}

std::string WriteConfig(const std::string& text) {
  static int count = 0;
  const std::string path =
      ::testing::TempDir() + "agent_" + std::to_string(getpid()) + "_" + std::to_string(count++) + ".yaml";
  std::ofstream(path) << text;
  return path;
}

TEST(SoffitAgent, LinksNoVisionAndNoGplLibrary) {
  FILE* pipe = popen(("ldd " + std::string(SOFFIT_AGENT_PROGRAM)).c_str(), "r");
  std::string libraries;
  std::array<char, 4096> part{};
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe))
    libraries.append(part.data(), size);
  ASSERT_EQ(pclose(pipe), 0);
  ASSERT_THAT(libraries, HasSubstr("libfastrtps"));
  for (const char* name : {"opencv", "CGAL", "octomap", "octomath", "gdal", "gmp", "ceres"}) {
    EXPECT_THAT(libraries, Not(HasSubstr(name)));
  }
}

TEST(SoffitAgent, PrintsAConfigurationThatItTakes) {
  const Finished first = RunAgent("--print-config");
  ASSERT_EQ(first.code, 0) << first.output;
  const Finished second = RunAgent("--print-config --config " + WriteConfig(first.output));
  EXPECT_EQ(second.code, 0);
  EXPECT_EQ(second.output, first.output);
}

TEST(SoffitAgent, TakesTheExampleConfiguration) {
  const auto config = ReadOptionsFile<AgentConfig>(SOFFIT_AGENT_EXAMPLE);
  ASSERT_TRUE(config.ok()) << config.error().message;
  EXPECT_THAT(FindConfigProblem(config.value()), IsEmpty());
  EXPECT_EQ(ListCameras(config.value()).size(), 2U);
}

struct BadConfig {
  const char* text;
  const char* said;
};
class SoffitAgentRefuses : public ::testing::TestWithParam<BadConfig> {};
TEST_P(SoffitAgentRefuses, ToStartSayingWhy) {
  const Finished run = RunAgent("--config " + WriteConfig(GetParam().text));
  EXPECT_NE(run.code, 0);
  EXPECT_THAT(run.output, HasSubstr(GetParam().said));
}
INSTANTIATE_TEST_SUITE_P(
    Malformed, SoffitAgentRefuses,
    ::testing::Values(
        BadConfig{"guard:\n  max_sped_mps: 3\n", ":2: guard.max_sped_mps: unknown key"},
        BadConfig{"guard: {max_speed_mps: .nan}\n", "guard.max_speed_mps: is .nan"},
        BadConfig{"vehicle: {radius_m: -1}\n", "vehicle.radius_m: is -1, must be a number, 0.01 to 50 m"},
        BadConfig{"guard: {fence: [{east_m: 0, north_m: 0}, {east_m: 1, north_m: 1}]}\n",
                  "guard.fence: must have three corners"},
        BadConfig{
            "guard: {fence: [{east_m: 5, north_m: 0}, {east_m: 9, north_m: 0}, {east_m: 9, north_m: 9}]}\n",
            "guard.fence: home"},
        BadConfig{"cameras: {down: {pipeline: a, folder: b}}\n",
                  "cameras.down: pipeline and folder are both set"},
        BadConfig{"cameras: {down: {pipeline: a, distortion: [1, 2]}}\n",
                  "cameras.down.distortion has 2 numbers"},
        BadConfig{"agent: {return_after_silence_s: 2}\n", "must be longer than hold_after_silence_s"},
        BadConfig{"mavlink: carrier-pigeon\n", "carrier-pigeon"},
        BadConfig{"- nonsense\n", "must be a list of 'key: value' lines"}));

TEST(SoffitAgent, RefusesAMissingConfiguration) {
  const Finished run = RunAgent("--config /nowhere/agent.yaml");
  EXPECT_NE(run.code, 0);
  EXPECT_THAT(run.output, HasSubstr("/nowhere/agent.yaml"));
}

TEST(SoffitAgent, ChecksAVehicleThatIsNotThereInPlainWords) {
  const Finished run = RunAgent("--check --timeout 0.5 --config " +
                                WriteConfig("mavlink: udpin:127.0.0.1:0\n"
                                            "cameras: {down: {pipeline: filesrc location=/nowhere.jpg}}\n"));
  EXPECT_NE(run.code, 0);
  EXPECT_THAT(run.output, HasSubstr("PROBLEM autopilot        no autopilot was heard"));
  EXPECT_THAT(run.output, HasSubstr("PROBLEM down camera"));
  EXPECT_THAT(run.output, HasSubstr("/nowhere.jpg"));
}

// ---- MakeCapture ----

constexpr std::int64_t kExposure_ns = 50'000'000'000;

PoseBuffer SteadyFlight() {
  PoseBuffer poses;
  for (int i = -5; i <= 5; ++i) {
    const std::int64_t t = kExposure_ns + i * 20'000'000;
    poses.AddPosition(t, {0.1 * i, 0.0, 2.0});
    poses.AddAttitude(t, Eigen::Quaterniond(Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitZ())));
  }
  return poses;
}

ExposureContext GoodContext() {
  ExposureContext context;
  context.vehicle_id = 7;
  context.telemetry.position_in_map_m = {9.0, 9.0, 9.0};
  context.telemetry.velocity_in_map_mps = {2.0, 0.0, 0.0};
  context.telemetry.position_std_m = 0.03;
  context.telemetry.orientation_std_rad = 0.01;
  context.trusts_poses = true;
  context.clock_uncertainty_s = 0.02;
  return context;
}

TEST(MakeCapture, TakesThePoseOfTheExposureAndTheMount) {
  CameraOptions options;
  options.mount.forward_m = 0.2;
  const ExposureRequest request{1, CameraId::kForward, 3, 12, Purpose::kWall};
  const Capture capture = MakeCapture(request, {{1, 2, 3}, kExposure_ns + 10'000'000, 0.01, true}, options,
                                      SteadyFlight(), GoodContext());
  EXPECT_TRUE(capture.has_trusted_pose);
  EXPECT_LT((capture.map_from_camera.translation_m - Eigen::Vector3d(0.05, 0.2, 2.0)).norm(),
            1e-9);  // Facing north.
  EXPECT_LT((capture.map_from_camera.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(),
            1e-9);
  EXPECT_EQ(capture.name, "012_wall.jpg");
  EXPECT_EQ(capture.mission_id, 3U);
  EXPECT_EQ(capture.bytes.size(), 3U);
  EXPECT_TRUE(IsValid(capture.intrinsics));
}

TEST(MakeCapture, AddsWhatTheClocksErrorMeansAtThisSpeed) {
  const Capture capture = MakeCapture({}, {{}, kExposure_ns, 0.01, true}, {}, SteadyFlight(), GoodContext());
  EXPECT_NEAR(capture.position_std_m, 0.05, 1e-9);  // 3 cm, and 2 m/s for 20 ms.
  EXPECT_NEAR(capture.orientation_std_rad, 0.01, 1e-9);
}

TEST(MakeCapture, DoesNotTrustAPoseThatIsNotThereOrThatTheEstimatorDoubts) {
  const Capture late =
      MakeCapture({}, {{}, kExposure_ns + 1'000'000'000, 0.01, true}, {}, SteadyFlight(), GoodContext());
  EXPECT_FALSE(late.has_trusted_pose);
  EXPECT_EQ(late.map_from_camera.translation_m.x(), 9.0);
  ExposureContext doubtful = GoodContext();
  doubtful.trusts_poses = false;
  EXPECT_FALSE(
      MakeCapture({}, {{}, kExposure_ns, 0.01, true}, {}, SteadyFlight(), doubtful).has_trusted_pose);
}

TEST(MakeCapture, DoesNotTrustTheTimeOfAClockThatIsNotOurs) {
  EXPECT_FALSE(
      MakeCapture({}, {{}, kExposure_ns, 0.01, false}, {}, SteadyFlight(), GoodContext()).has_trusted_pose);
}

TEST(FindBlurProblem, SeesHowFarTheVehicleTurnedWhileTheShutterWasOpen) {
  PoseBuffer poses;
  poses.AddRate(kExposure_ns - 10'000'000, 0.2);
  poses.AddRate(kExposure_ns + 10'000'000, 0.4);
  const auto find = [&](double shutter_s) {
    return FindBlurProblem({{}, kExposure_ns, shutter_s, true}, {}, poses);
  };
  EXPECT_EQ(find(0.019), "");
  EXPECT_THAT(find(0.021), HasSubstr("turned by 5.3"));  // 0.3 rad/s, 850 px.
  EXPECT_EQ(FindBlurProblem({{}, 2 * kExposure_ns, 1.0, true}, {}, poses), "");
}

TEST(MakeCapture, TakesAGimbalsAttitudeFromTheGimbal) {
  PoseBuffer poses = SteadyFlight();
  const ExposureRequest request{1, CameraId::kGimbal, 3, 12, Purpose::kTop};
  EXPECT_FALSE(
      MakeCapture(request, {{}, kExposure_ns, 0.01, true}, {}, poses, GoodContext()).has_trusted_pose);
  for (const std::int64_t t : {-50'000'000, 50'000'000}) {
    poses.AddGimbal(kExposure_ns + t,
                    Eigen::Quaterniond(Eigen::AngleAxisd(1.5707963267948966, Eigen::Vector3d::UnitY())));
  }
  const Capture capture = MakeCapture(request, {{}, kExposure_ns, 0.01, true}, {}, poses, GoodContext());
  EXPECT_TRUE(capture.has_trusted_pose);
  EXPECT_LT((capture.map_from_camera.rotation * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitZ()).norm(),
            1e-9);
}

}  // namespace
}  // namespace soffit
