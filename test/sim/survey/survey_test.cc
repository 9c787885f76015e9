#include "test/sim/survey/survey.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "test/sim/survey/frames.h"
#include "test/sim/survey/reference.h"

namespace soffit::sim {
namespace {

World ArchWorld() {
  World world = LoadWorld(SOFFIT_SCENARIOS "/arch.yaml").value();
  world.camera.intrinsics = {160, 120, 106, 106, 79.5, 59.5, {}};
  return world;
}

nlohmann::json ReadJson(const std::filesystem::path& file) {
  std::ifstream in(file);
  return nlohmann::json::parse(in);
}

std::string ReadBytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class SurveyTest : public testing::Test {
 protected:
  SurveyTest() { std::filesystem::remove_all(folder_); }
  ~SurveyTest() override { std::filesystem::remove_all(folder_); }
  const std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                        ("soffit-survey-" + std::to_string(::getpid()) +
                                         testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST(DrawReference, TurnsTheBuildingBackByTheRotation) {
  World world;
  Structure bar;
  bar.id = "bar";
  Prism prism;
  prism.section.outer = {{-2, -0.5}, {2, -0.5}, {2, 0.5}, {-2, 0.5}};
  prism.high_m = 1.0;
  bar.parts = {Part{prism, {}}};
  world.buildings = {bar};
  world.mission = {{"bar"}, 0.05, 0.0, {0, 0}, 9.0};
  EXPECT_EQ(DrawReference(world).size(), cv::Size(80 + 40, 20 + 40));
  EXPECT_NEAR(cv::countNonZero(DrawReference(world) == 0), 80 * 20, 120);
  world.mission.reference_rotation_cw_rad = std::acos(0.0);
  EXPECT_NEAR(DrawReference(world).cols, 60, 1);
  world.mission.reference_rotation_cw_rad =
      0.5;  // Turned clockwise it lies east-west, so it points to the north-east.
  const cv::Mat1b slanted = DrawReference(world);
  EXPECT_EQ(slanted(slanted.rows / 2 - 15, slanted.cols / 2 + 27), 0);
  EXPECT_EQ(slanted(slanted.rows / 2 + 15, slanted.cols / 2 + 27), 255);
}

TEST(PlanFrames, LooksIntoAWayThroughLengthwiseFromBothEnds) {
  const Result<World> world = ParseWorld(
      "camera: {width_px: 64, height_px: 48, fx_px: 40}\nvehicle: {radius_m: 0.3, height_m: 0.3, "
      "safety_margin_m: 0.2}\nmission: {wanted: [a]}\nbuildings: [{id: a, parts: [{axis: [0, 1], depth: [-3, "
      "3], "
      "profile: [[-1.6, 0], [-0.9, 0], [-0.9, 1.5], [0.9, 1.5], [0.9, 0], [1.6, 0], [1.6, 2.4], [-1.6, "
      "2.4]]}]}]",
      "test.yaml", ".");
  ASSERT_TRUE(world.ok()) << world.error().message;
  const Truth truth = FindTruth(world.value());
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Dice dice(seed);
    const std::vector<SurveyFrame> frames = PlanFrames(world.value(), truth, dice);
    for (const double outward_y : {-1.0, 1.0}) {
      const bool is_seen = std::any_of(frames.begin(), frames.end(), [&](const SurveyFrame& frame) {
        return frame.purpose == Purpose::kWall && std::sin(frame.wall_yaw_rad) * outward_y > 0.9;
      });
      EXPECT_TRUE(is_seen) << "seed " << seed << ", end " << outward_y;
    }
  }
}

TEST_F(SurveyTest, HasPicturesPosesAndTruth) {
  ASSERT_TRUE(WriteSurvey(ArchWorld(), 3, folder_).ok());
  const auto survey = ReadJson(folder_ / "survey.json"), truth = ReadJson(folder_ / "truth.json");
  int walls = 0;
  for (const auto& frame : survey["frames"]) {
    EXPECT_EQ(cv::imread((folder_ / frame["file"].get<std::string>()).string()).size(), cv::Size(160, 120));
    EXPECT_GT(frame["position_std_m"].get<double>(), 0.0);
    walls += frame["purpose"] == "wall" ? 1 : 0;
  }
  EXPECT_GE(walls, 3);
  EXPECT_NE(survey["frames"][0]["position"], truth["frames"][0]["position"]);
  EXPECT_EQ(truth["expected_outcome"], "flown");
  EXPECT_EQ(truth["objects"][0]["expected"], "CLEAR");
  EXPECT_EQ(truth["objects"][0]["match"]["symmetry_deg"].size(), 2U);
  EXPECT_NEAR(truth["objects"][0]["volume_m3"].get<double>(), 3.9 * 1.5 * 2.3 - 1.65 * 1.5 * 1.5, 1e-9);
  EXPECT_NEAR(truth["objects"][0]["passages"][0]["length_m"].get<double>(), 1.5, 0.01);
}

TEST_F(SurveyTest, TellsTheVolumeOfAMeshOnlyWhenItEnclosesOne) {
  for (const auto& [more, is_closed] :
       {std::pair("}", true), std::pair(", without: [RoofSurface]}", false)}) {
    const Result<World> house = ParseWorld(
        "camera: {width_px: 64, height_px: 48, fx_px: 40}\nvehicle: {radius_m: 0.3, height_m: 0.3, "
        "safety_margin_m: "
        "0.2}\nmission: {wanted: [a]}\nbuildings: [{id: a, parts: [{mesh: {file: " SOFFIT_SIM_TESTDATA
        "/gatehouse.gml" +
            std::string(more) + "}]}]",
        "test.yaml", ".");
    ASSERT_TRUE(house.ok()) << house.error().message;
    ASSERT_TRUE(WriteSurvey(house.value(), 3, folder_).ok());
    const nlohmann::json told = ReadJson(folder_ / "truth.json")["objects"][0]["volume_m3"];
    EXPECT_EQ(told.is_number(), is_closed);
    EXPECT_NEAR(told.is_number() ? told.get<double>() : 306.0, 306.0, 1e-4);
  }
}

TEST_F(SurveyTest, IsTheSameForTheSameSeed) {
  ASSERT_TRUE(WriteSurvey(ArchWorld(), 3, folder_ / "a").ok());
  ASSERT_TRUE(WriteSurvey(ArchWorld(), 3, folder_ / "b", 2).ok());
  for (const char* file : {"overview.jpg", "wall_0.jpg", "survey.json", "truth.json", "reference.png"}) {
    EXPECT_EQ(ReadBytes(folder_ / "a" / file), ReadBytes(folder_ / "b" / file)) << file;
  }
}

TEST_F(SurveyTest, SaysWhereItCannotWrite) {
  std::ofstream(folder_) << "a file";
  const Status status = WriteSurvey(ArchWorld(), 3, folder_ / "x");
  ASSERT_FALSE(status.ok());
  EXPECT_THAT(status.error().message, testing::HasSubstr(folder_.string()));
}

}  // namespace
}  // namespace soffit::sim
