#include "service/edge/files/survey.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "service/edge/files/file.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;

/// A folder of its own for each test.
class ReadSurveyTest : public ::testing::Test {
 protected:
  ReadSurveyTest() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(::testing::TempDir()) /
              ("soffit_survey_" + std::string(info->name()) + std::to_string(getpid()));
    fs::create_directories(folder_);
    Write("overview.jpg", "not read here");
  }
  ~ReadSurveyTest() override { fs::remove_all(folder_); }

  void Write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }

  static json GoodSurvey() {
    return {{"format", "soffit-survey/1"},
            {"camera",
             {{"width", 1280},
              {"height", 960},
              {"fx", 850},
              {"fy", 851},
              {"cx", 631.2},
              {"cy", 482.8},
              {"distortion_model", "plumb_bob"},
              {"d", {-0.1, 0.01, 0.001, 0.002, 0.0}}}},
            {"vehicle", {{"radius_m", 0.35}, {"height_m", 0.3}, {"safety_margin_m", 0.25}}},
            {"reference", {{"image", "reference.png"}}},
            {"colors", {"red", "blue"}},
            {"frames",
             {{{"file", "overview.jpg"},
               {"purpose", "overview"},
               {"stamp_s", 2.5},
               {"position", {1, 2, 9}},
               {"orientation", {1, 0, 0, 0}},
               {"position_std_m", 0.08},
               {"orientation_std_rad", 0.014}}}}};
  }

  std::string ErrorFor(const json& survey) const { return ErrorForText(survey.dump()); }
  std::string ErrorForText(const std::string& text) const {
    Write("survey.json", text);
    const Result<Survey> read = ReadSurvey(folder_);
    return read.ok() ? "no error" : read.error().message;
  }

  fs::path folder_;
};

TEST_F(ReadSurveyTest, ReadsAllFields) {
  Write("survey.json", GoodSurvey().dump());
  const Result<Survey> read = ReadSurvey(folder_);
  ASSERT_TRUE(read.ok()) << read.error().message;
  const Survey& survey = read.value();
  EXPECT_DOUBLE_EQ(survey.vehicle.radius_m, 0.35);
  EXPECT_EQ(survey.reference_file, "reference.png");
  EXPECT_THAT(survey.colors, testing::ElementsAre("red", "blue"));
  ASSERT_EQ(survey.captures.size(), 1U);
  const Capture& capture = survey.captures.front();
  EXPECT_EQ(capture.capture_id, 1U);
  EXPECT_EQ(capture.purpose, Purpose::kOverview);
  EXPECT_EQ(capture.exposure_utc_ns, 2'500'000'000);
  EXPECT_DOUBLE_EQ(capture.intrinsics.fy_px, 851.0);
  EXPECT_DOUBLE_EQ(capture.intrinsics.distortion[3], 0.002);
  EXPECT_EQ(capture.map_from_camera.translation_m, Eigen::Vector3d(1, 2, 9));
  EXPECT_DOUBLE_EQ(capture.map_from_camera.rotation.x(), 1.0);
  EXPECT_TRUE(capture.has_trusted_pose);
}

TEST_F(ReadSurveyTest, ReadsBackWhatWasWritten) {
  Write("survey.json", GoodSurvey().dump());
  Survey survey = ReadSurvey(folder_).value();
  survey.captures[0].has_trusted_pose = false;
  survey.captures[0].name = "pictures/overview.jpg";
  survey.captures[0].bytes = {1, 2, 3};
  survey.origin = GeodeticOrigin{50.06, 19.94, 210.0};
  const fs::path copy = folder_ / "copy";
  ASSERT_TRUE(WriteSurvey(copy, survey).ok());
  const Result<Survey> again = ReadSurvey(copy);
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(ReadFile(copy / again.value().captures[0].name, 10).value(), survey.captures[0].bytes);
  EXPECT_EQ(again.value().captures[0].exposure_utc_ns, survey.captures[0].exposure_utc_ns);
  EXPECT_FALSE(again.value().captures[0].has_trusted_pose);
  EXPECT_DOUBLE_EQ(again.value().captures[0].position_std_m, 0.08);
  EXPECT_EQ(again.value().captures[0].intrinsics.distortion, survey.captures[0].intrinsics.distortion);
  EXPECT_DOUBLE_EQ(again.value().origin->longitude_deg, 19.94);
}

TEST_F(ReadSurveyTest, TakesProjectedPositionsRelativeToAMapOriginNearby) {
  json document = GoodSurvey();
  document["frames"][0]["position"] = {690001.25, 5335002.125, 9.5};
  Write("survey.json", document.dump());
  Survey survey = ReadSurvey(folder_).value();
  EXPECT_EQ(survey.map_origin_m, Eigen::Vector3d(690001, 5335002, 0));
  EXPECT_EQ(survey.captures[0].map_from_camera.translation_m, Eigen::Vector3d(0.25, 0.125, 9.5));
  survey.captures[0].bytes = {1, 2, 3};
  ASSERT_TRUE(WriteSurvey(folder_ / "copy", survey).ok());
  const Survey again = ReadSurvey(folder_ / "copy").value();
  EXPECT_EQ(again.map_origin_m, survey.map_origin_m);
  EXPECT_EQ(again.captures[0].map_from_camera.translation_m, Eigen::Vector3d(0.25, 0.125, 9.5));
}

TEST_F(ReadSurveyTest, NamesTheMissingFile) {
  const Result<Survey> read = ReadSurvey(folder_);
  ASSERT_FALSE(read.ok());
  EXPECT_THAT(read.error().message, HasSubstr("survey.json: no such file"));
  json survey = GoodSurvey();
  survey["frames"][0]["file"] = "gone.jpg";
  EXPECT_THAT(ErrorFor(survey), HasSubstr("gone.jpg: no such file"));
  survey["frames"][0]["file"] = std::string(5000, 'a');
  EXPECT_THAT(ErrorFor(survey), HasSubstr("no such file"));
  survey["frames"][0]["file"] = ".";
  EXPECT_THAT(ErrorFor(survey), HasSubstr("not a regular file"));
}

TEST_F(ReadSurveyTest, RefusesWhatIsNotJson) {
  for (const char* text : {"", "{", "[1,2", "\xff\xfe", "{\"format\": NaN}"}) {
    EXPECT_THAT(ErrorForText(text), HasSubstr("not JSON")) << text;
  }
  EXPECT_THAT(ErrorForText(std::string(100000, '[')), HasSubstr("not JSON"));
  EXPECT_THAT(ErrorForText("[]"), HasSubstr("must be an object"));
}

TEST_F(ReadSurveyTest, NamesThePlaceOfWhatIsWrong) {
  const auto with = [](const json::json_pointer& place, const json& value) {
    json survey = GoodSurvey();
    survey[place] = value;
    return survey;
  };
  const auto at = [](const char* place) { return json::json_pointer(place); };
  EXPECT_THAT(ErrorFor(with(at("/format"), "soffit-survey/9")), HasSubstr("format"));
  EXPECT_THAT(ErrorFor(with(at("/camera/fx"), nullptr)), HasSubstr("camera.fx: is null"));
  EXPECT_THAT(ErrorFor(with(at("/camera/fx"), 0)), HasSubstr("camera.fx"));
  EXPECT_THAT(ErrorFor(with(at("/camera/width"), 1280.7)), HasSubstr("camera.width"));
  EXPECT_THAT(ErrorFor(with(at("/camera/d"), json(std::vector<int>(8)))), HasSubstr("camera.d"));
  EXPECT_THAT(ErrorFor(with(at("/camera"), "wide")), HasSubstr("camera"));
  EXPECT_THAT(ErrorFor(with(at("/camera/distortion_model"), "fisheye")), HasSubstr("plumb_bob"));
  EXPECT_THAT(ErrorFor(with(at("/vehicle/radius_m"), "big")), HasSubstr("vehicle.radius_m"));
  EXPECT_THAT(ErrorFor(with(at("/frames"), json::array())), HasSubstr("frames"));
  EXPECT_THAT(ErrorFor(with(at("/frames"), json::object())), HasSubstr("frames"));
  EXPECT_THAT(ErrorFor(with(at("/frames/0/purpose"), "selfie")), HasSubstr("frames[0].purpose"));
  EXPECT_THAT(ErrorFor(with(at("/frames/0/position"), {1, 2})), HasSubstr("frames[0].position"));
  EXPECT_THAT(ErrorFor(with(at("/frames/0/position/2"), nullptr)), HasSubstr("frames[0].position[2]"));
  EXPECT_THAT(ErrorFor(with(at("/frames/0/position/0"), 1e300)), HasSubstr("frames[0].position[0]"));
  EXPECT_THAT(ErrorFor(with(at("/frames/0/orientation"), {0, 0, 0, 0})), HasSubstr("unit quaternion"));
  EXPECT_THAT(ErrorFor(with(at("/frames/0/orientation"), {1.1, 0, 0, 0})), HasSubstr("unit quaternion"));
  EXPECT_THAT(ErrorFor(with(at("/frames/0/position_std_m"), -1)), HasSubstr("frames[0].position_std_m"));
  EXPECT_THAT(ErrorFor(with(at("/origin"), {{"latitude_deg", 91}})), HasSubstr("origin.latitude_deg"));
}

TEST_F(ReadSurveyTest, NamesTheMissingKey) {
  json survey = GoodSurvey();
  survey["frames"][0].erase("orientation");
  EXPECT_THAT(ErrorFor(survey), HasSubstr("frames[0].orientation: is missing"));
}

TEST_F(ReadSurveyTest, RefusesAPictureThatIsListedTwice) {
  json survey = GoodSurvey();
  survey["frames"].push_back(survey["frames"][0]);
  for (const char* name : {"overview.jpg", "./overview.jpg", "a/../overview.jpg"}) {
    survey["frames"][1]["file"] = name;
    EXPECT_THAT(ErrorFor(survey), HasSubstr("frames[1].file")) << name;
  }
}

TEST_F(ReadSurveyTest, RefusesFilesOutsideOfTheFolder) {
  for (const char* name : {"../secret.jpg", "/etc/passwd", "a/../../b.jpg"}) {
    json survey = GoodSurvey();
    survey["frames"][0]["file"] = name;
    EXPECT_THAT(ErrorFor(survey), HasSubstr("inside the survey's folder")) << name;
  }
}

}  // namespace
}  // namespace soffit
