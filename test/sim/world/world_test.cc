#include "test/sim/world/world.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace soffit::sim {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

constexpr char kHead[] = R"(
camera: {width_px: 640, height_px: 480, fx_px: 400}
vehicle: {radius_m: 0.35, height_m: 0.3, safety_margin_m: 0.25}
mission: {wanted: [a]}
)";
constexpr char kBox[] = "buildings: [{id: a, parts: [{box: {center: [0, 0], size: [2, 1]}, z: [0, 2]}]}]\n";

Result<World> Parse(const std::string& text) { return ParseWorld(text, "test.yaml", "."); }

std::string Problem(const std::string& text) {
  const Result<World> world = Parse(text);
  return world.ok() ? "no problem" : world.error().message;
}

TEST(ParseWorld, ReadsAMinimalWorld) {
  const Result<World> world = Parse(std::string(kHead) + kBox);
  ASSERT_TRUE(world.ok()) << world.error().message;
  EXPECT_THAT(world.value().buildings, SizeIs(1));
  EXPECT_EQ(world.value().camera.intrinsics.width_px, 640);
  EXPECT_DOUBLE_EQ(world.value().camera.intrinsics.cx_px, 319.5);
}

TEST(ParseWorld, NamesFileLineAndKeyOfAnUnknownKey) {
  EXPECT_THAT(Problem(std::string(kHead) + kBox + "clouds: 3\n"),
              HasSubstr("test.yaml: line 6: the file: unknown key 'clouds'"));
}

TEST(ParseWorld, RefusesWhatCannotBe) {
  const std::string head = kHead;
  EXPECT_THAT(Problem(""), HasSubstr("must be a mapping"));
  EXPECT_THAT(Problem("a: [1, 2"), HasSubstr("not YAML"));
  EXPECT_THAT(Problem(kBox), HasSubstr("needs the key 'camera'"));
  EXPECT_THAT(Problem(head), HasSubstr("there is no building 'a'"));
  EXPECT_THAT(Problem(head + kBox + "sun: {elevation_deg: .nan}"), HasSubstr("sun.elevation_deg: is nan"));
  EXPECT_THAT(Problem(head + kBox + "sun: {elevation_deg: high}"), HasSubstr("must be a number"));
  EXPECT_THAT(Problem(head + kBox + "sun: {elevation_deg: 100}"), HasSubstr("must be from 3 to 90"));
  EXPECT_THAT(Problem(head + "buildings: [{id: a, parts: [{polygon: [[0,0],[1,1],[1,0],[0,1]], z: [0,1]}]}]"),
              HasSubstr("sides cross"));
  EXPECT_THAT(Problem(head + "buildings: [{id: a, parts: [{box: {center: [0,0], size: [1,1]}, z: [1,1]}]}]"),
              HasSubstr("buildings[0].parts[0].z: the first number must be smaller"));
  const std::string triangle = "buildings: [{id: a, parts: [{polygon: [[0,0],[1,0],[1,1]], z: [0,1], ";
  EXPECT_THAT(Problem(head + triangle + "top: [[0,0],[1,0],[1,1],[0,1]]}]}]"), HasSubstr("as many corners"));
  EXPECT_THAT(
      Problem(head + triangle + "top: [[0,0],[1,0],[1,1]], holes: [[[0.5,0.2],[0.6,0.2],[0.6,0.3]]]}]}]"),
      HasSubstr("with holes keeps its outline"));
  EXPECT_THAT(Problem(head + "buildings: [{id: a, color: mauve, parts: []}]"),
              HasSubstr("unknown colour 'mauve'"));
  EXPECT_THAT(Problem(head + "buildings: [{id: a, parts: [{mesh: {file: a.gml, origin: [1, 2]}}]}]"),
              HasSubstr("origin"));
  EXPECT_THAT(Problem(head + "buildings: [{id: a, parts: [{mesh: {file: a.gml, cut: [{mesh: b.obj}]}}]}]"),
              HasSubstr("unknown key 'mesh'"));
  EXPECT_THAT(Problem(head + "buildings: [{id: a, parts: [{mesh: nowhere.obj}]}]"),
              HasSubstr("nowhere.obj: cannot be read"));
  EXPECT_THAT(Problem(head + kBox + "obstacles: [{id: a, parts: [{cylinder: {radius: 1}, z: [0, 1]}]}]"),
              HasSubstr("given twice"));
}

TEST(LoadWorld, SaysWhichFileIsMissing) {
  const Result<World> world = LoadWorld("/nowhere/at/all.yaml");
  ASSERT_FALSE(world.ok());
  EXPECT_THAT(world.error().message, HasSubstr("/nowhere/at/all.yaml"));
}

TEST(FormatWorld, RoundTripsEveryScenario) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SOFFIT_SCENARIOS)) {
    if (entry.path().extension() != ".yaml") continue;
    ++count;
    const Result<World> world = LoadWorld(entry.path());
    ASSERT_TRUE(world.ok()) << world.error().message;
    const std::string text = FormatWorld(world.value());
    const Result<World> again = ParseWorld(text, world.value().name, SOFFIT_SCENARIOS);
    ASSERT_TRUE(again.ok()) << again.error().message;
    EXPECT_EQ(FormatWorld(again.value()), text);
  }
  EXPECT_GE(count, 1);
}

TEST(FormatWorld, KeepsWhatWasAskedOfAMesh) {
  const std::string text =
      FormatWorld(Parse(std::string(kHead) + "buildings: [{id: a, parts: [{mesh: {file: " SOFFIT_SIM_TESTDATA
                                             "/gatehouse.gml, origin: [690005.125, 5335003.5, 512.125], "
                                             "only: [WallSurface], without: [gate], cut: "
                                             "[{box: {center: [0, 0], size: [1, 9]}, z: [1, 2]}]}}]}]")
                      .value());
  const Result<World> again = Parse(text);
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(FormatWorld(again.value()), text);
  const auto& mesh = std::get<MeshFile>(again.value().buildings[0].parts[0].shape);
  EXPECT_EQ(mesh.origin, Eigen::Vector3d(690005.125, 5335003.5, 512.125));
  EXPECT_THAT(mesh.only, testing::ElementsAre("WallSurface"));
  EXPECT_THAT(mesh.without, testing::ElementsAre("gate"));
  EXPECT_THAT(mesh.cuts, SizeIs(1));
}

}  // namespace
}  // namespace soffit::sim
