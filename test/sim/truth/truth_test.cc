#include "test/sim/truth/truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "test/sim/world/space.h"

namespace soffit::sim {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

constexpr char kHead[] = R"(
camera: {width_px: 640, height_px: 480, fx_px: 400}
vehicle: {radius_m: 0.35, height_m: 0.3, safety_margin_m: 0.25}
mission: {wanted: [a]}
)";

Truth TruthOf(const std::string& text) {
  const Result<World> world = ParseWorld(kHead + text, "test.yaml", ".");
  EXPECT_TRUE(world.ok()) << world.error().message;
  return FindTruth(world.value());
}

/// An arch 4 m wide and 1.5 m thick with an opening in the middle, turned by 30 degrees.
std::string Arch(double width_m, double height_m) {
  const std::string half = std::to_string(width_m / 2), top = std::to_string(height_m);
  return "buildings:\n- {id: a, position: [1, 2], yaw_deg: 30, parts: [{axis: [0, 1], depth: [-0.75, 0.75], "
         "profile: "
         "[[-2, 0], [-" +
         half + ", 0], [-" + half + ", " + top + "], [" + half + ", " + top + "], [" + half +
         ", 0], [2, 0], [2, 2.4], [-2, 2.4]]}]}\n";
}

TEST(FindTruth, MeasuresAPlainArchExactly) {
  const Truth truth = TruthOf(Arch(1.7, 1.5));
  EXPECT_EQ(truth.expected, Outcome::kFlown);
  ASSERT_THAT(truth.objects, SizeIs(1));
  EXPECT_NEAR(truth.objects[0].height_m, 2.4, 1e-9);
  ASSERT_THAT(truth.objects[0].footprint_in_map_m, SizeIs(1));
  EXPECT_THAT(truth.objects[0].footprint_in_map_m[0].outer, SizeIs(4));
  EXPECT_NEAR(Area(truth.objects[0].footprint_in_map_m[0]), 6.0, 1e-5);
  const Passage& passage = truth.objects[0].passages.at(0);
  EXPECT_NEAR(passage.free_width_m, 1.7, 1e-6);
  EXPECT_NEAR(passage.free_height_m, 1.5, 1e-6);
  const Eigen::Vector3d along = (passage.exit_m - passage.entry_m).normalized();
  EXPECT_NEAR(std::abs(along.dot(Eigen::Vector3d(-0.5, std::sqrt(0.75), 0))), 1.0, 1e-6);
}

TEST(FindTruth, RefusesWhatIsAHairTooTight) {
  EXPECT_EQ(TruthOf(Arch(1.205, 1.5)).expected, Outcome::kFlown);
  EXPECT_EQ(TruthOf(Arch(1.195, 1.5)).expected, Outcome::kNotFlown);
  EXPECT_EQ(TruthOf(Arch(1.7, 0.805)).expected, Outcome::kFlown);
  const Truth low = TruthOf(Arch(1.7, 0.795));
  EXPECT_EQ(low.expected, Outcome::kNotFlown);
  EXPECT_NEAR(low.objects[0].passages.at(0).spare_m, -0.005, 1e-6);
}

/// A block 5.2 m wide and 1.6 m deep, turned by 31 degrees, with a passage that is slanted to its walls by 30
/// degrees.
std::string SlantedPassage(double free_m) {
  const double slant = std::numbers::pi / 6, mouth = free_m / std::cos(slant), shift = 1.6 * std::tan(slant);
  const auto at = [](double x, double y) { return "[" + std::to_string(x) + ", " + std::to_string(y) + "]"; };
  const double left = -(mouth + shift) / 2, right = left + mouth;
  return "buildings:\n- {id: a, position: [1, 2], yaw_deg: 31, parts: [{polygon: [[-2.6, -0.8], " +
         at(left, -0.8) + ", " + at(left + shift, 0.8) + ", [-2.6, 0.8]], z: [0, 1.5]}, {polygon: [" +
         at(right, -0.8) + ", [2.6, -0.8], [2.6, 0.8], " + at(right + shift, 0.8) +
         "], z: [0, 1.5]}, {box: {center: [0, 0], size: [5.2, 1.6]}, z: [1.5, 2.3]}]}\n";
}

TEST(FindTruth, MeasuresASlantedPassageAlongItsWalls) {
  const Truth truth = TruthOf(SlantedPassage(1.205));
  EXPECT_EQ(truth.expected, Outcome::kFlown);
  const Passage& passage = truth.objects[0].passages.at(0);
  EXPECT_NEAR(passage.free_width_m, 1.205, 1e-5);
  EXPECT_EQ(TruthOf(SlantedPassage(1.195)).expected, Outcome::kNotFlown);
}

TEST(FindTruth, SeesARecessAsNoPassage) {
  EXPECT_EQ(TruthOf(Arch(1.7, 1.5) + "obstacles: [{id: back, position: [1, 2], yaw_deg: 30, parts: "
                                     "[{box: {center: [0, 0.7], size: [1.8, 0.1]}, z: [0, 1.6]}]}]")
                .expected,
            Outcome::kNotFlown);
}

TEST(FindTruth, SeesAPoleInTheApproach) {
  const Truth truth = TruthOf(Arch(1.7, 1.5) +
                              "obstacles: [{id: pole, position: [1.6, 0.96], parts: "
                              "[{cylinder: {radius: 0.06}, z: [0, 2]}]}]");
  EXPECT_EQ(truth.expected, Outcome::kNotFlown);
  EXPECT_LT(truth.objects[0].passages.at(0).free_width_m, 1.0);
}

TEST(FindTruth, FindsBothWaysUnderATable) {
  const std::string leg = "{box: {size: [0.3, 0.3], center: ";
  const Truth truth =
      TruthOf("buildings: [{id: a, parts: [{box: {center: [0, 0], size: [3.2, 2.8]}, z: [1.6, 1.9]}, " + leg +
              "[1.45, 1.25]}, z: [0, 1.6]}, " + leg + "[-1.45, 1.25]}, z: [0, 1.6]}, " + leg +
              "[1.45, -1.25]}, z: [0, 1.6]}, " + leg + "[-1.45, -1.25]}, z: [0, 1.6]}]}]");
  ASSERT_GE(truth.objects[0].passages.size(), 2U);
  EXPECT_TRUE(truth.objects[0].passages[0].is_passable && truth.objects[0].passages[1].is_passable);
}

TEST(FindTruth, DoesNotTakeFlyingOverOrBesideForFlyingUnder) {
  const Truth truth = TruthOf(
      "buildings: [{id: a, parts: [{box: {center: [0, 0], size: [4, 2]}, z: [0, 2]}, "
      "{box: {center: [1.5, 0], size: [1, 2]}, z: [2, 5]}]}]");
  EXPECT_EQ(truth.expected, Outcome::kNotFlown);
  EXPECT_THAT(truth.objects[0].passages, SizeIs(0));
}

std::string House(const std::string& more) {
  return "buildings: [{id: a, yaw_deg: 20, parts: [{mesh: {file: " SOFFIT_SIM_TESTDATA "/gatehouse.gml" +
         more + "}}]}]";
}

TEST(FindTruth, SeesThatAMeshHasNoPassageUntilItsGateIsGone) {
  EXPECT_EQ(TruthOf(House("")).expected, Outcome::kNotFlown);
  const std::string hole =
      ", cut: [{profile: [[-1, 0], [1, 0], [1, 2.5], [-1, 2.5]], axis: [0, 1], depth: [-4, 4]}]";
  for (const auto& [more, width_m, height_m] :
       {std::tuple(std::string(", without: [gate]"), 3.0, 3.0), std::tuple(hole, 2.0, 2.5)}) {
    const Truth truth = TruthOf(House(more));
    EXPECT_EQ(truth.expected, Outcome::kFlown);
    EXPECT_NEAR(truth.objects.at(0).height_m, 7.0, 1e-6);
    EXPECT_THAT(truth.objects[0].footprint_in_map_m.at(0).outer, SizeIs(4));
    EXPECT_NEAR(Area(truth.objects[0].footprint_in_map_m[0]), 60.0, 1e-3);
    EXPECT_NEAR(truth.objects[0].passages.at(0).free_width_m, width_m, 1e-5);
    EXPECT_NEAR(truth.objects[0].passages[0].free_height_m, height_m, 1e-5);
  }
}

TEST(FindTruth, ExpectsNoMatchWhenTheWantedBuildingIsAbsent) {
  const Truth truth = TruthOf(
      "buildings: [{id: a, absent: true, parts: [{box: {center: [0, 0], size: [4, 2]}, z: [0, 2]}]}]");
  EXPECT_EQ(truth.expected, Outcome::kNoMatch);
  EXPECT_THAT(truth.reason, HasSubstr("not there"));
}

struct Expectation {
  const char* name;
  Outcome outcome;
};
class Scenarios : public testing::TestWithParam<Expectation> {};

TEST_P(Scenarios, EndAsTheirDescriptionSaysWithAClearMargin) {
  std::string name = GetParam().name;
  std::replace(name.begin(), name.end(), '_', '-');  // Test names have no hyphens.
  const Result<World> world = LoadWorld(std::string(SOFFIT_SCENARIOS) + "/" + name + ".yaml");
  ASSERT_TRUE(world.ok()) << world.error().message;
  const Truth truth = FindTruth(world.value());
  EXPECT_EQ(truth.expected, GetParam().outcome) << truth.reason;
  for (const ObjectTruth& object : truth.objects) {
    if (!object.is_wanted || object.passages.empty()) continue;
    EXPECT_GE(std::abs(object.passages[0].spare_m), 0.08);
  }
  const VehicleEnvelope& vehicle = world.value().vehicle;
  const Cylinder at_home{{0, 0, 2.0 * vehicle.height_m}, vehicle.radius_m, vehicle.height_m};
  EXPECT_GE(Space(world.value()).DistanceToBodies(at_home).distance_m, 2.0 * vehicle.safety_margin_m);
}

INSTANTIATE_TEST_SUITE_P(
    All, Scenarios,
    testing::Values(Expectation{"arch", Outcome::kFlown}, Expectation{"low_arch", Outcome::kNotFlown},
                    Expectation{"narrow_arch", Outcome::kNotFlown}, Expectation{"recess", Outcome::kNotFlown},
                    Expectation{"painted_door", Outcome::kNotFlown}, Expectation{"pole", Outcome::kNotFlown},
                    Expectation{"beam", Outcome::kNotFlown}, Expectation{"box_behind", Outcome::kNotFlown},
                    Expectation{"look_alikes", Outcome::kFlown}, Expectation{"group", Outcome::kFlown},
                    Expectation{"round_arch", Outcome::kFlown}, Expectation{"table", Outcome::kFlown},
                    Expectation{"l_passage", Outcome::kFlown}, Expectation{"high_window", Outcome::kFlown},
                    Expectation{"gusty", Outcome::kFlown}, Expectation{"tall", Outcome::kFlown},
                    Expectation{"slanted", Outcome::kFlown}, Expectation{"bent", Outcome::kNotFlown},
                    Expectation{"absent", Outcome::kNoMatch}),
    [](const auto& scenario) { return std::string(scenario.param.name); });

}  // namespace
}  // namespace soffit::sim
