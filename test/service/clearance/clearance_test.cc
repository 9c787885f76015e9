#include "service/clearance/clearance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/support/painted_world.h"

namespace soffit {
namespace {

using test::Arch;
using test::Thing;
using ::testing::HasSubstr;
using ::testing::Not;

const VehicleEnvelope kVehicle{0.35, 0.30, 0.25};
const Eigen::Vector3d kMapOrigin_m(690000.0, 5335000.0, 510.0);
const std::vector<View> kAllSides = {test::FromSouth(), test::FromNorth(), test::FromEast(),
                                     test::FromWest()};

/// From painted pictures to decisions, with the stages as they are chained in the service; `other` is the
/// outline of another building of the map.
std::vector<ClearanceDecision> JudgeThings(const Footprint& footprint, const std::vector<View>& views,
                                           const std::vector<Thing>& things, const Ring& other = {},
                                           const ClearanceOptions& options = {}) {
  const auto seeing = test::Look(views, things);
  const Alignment aligned = AlignSights(footprint, seeing.masks, seeing.sights, {});
  const auto facades = ReadFacades(aligned.footprint, seeing.images, seeing.masks, aligned.sights, {});
  const Solid solid = RaiseSolid(aligned.footprint, facades).value();
  SceneObject object;
  object.footprint = solid.footprint;
  object.is_matched = true;
  std::vector<SceneObject> objects = {object};
  if (!other.empty()) {
    objects.emplace_back();
    objects.back().footprint.object_id = 2;
    objects.back().footprint.polygon_in_map_m.outer = other;
  }
  Scene scene = BuildScene(1, objects, {solid}, aligned.sights, {});
  scene.map_origin_m = kMapOrigin_m;
  return JudgeClearance(scene, 1, PlanCorridors(scene, 1, kVehicle, {}), aligned.sights, kVehicle, options);
}

std::vector<ClearanceDecision> Judge(const Arch& arch, const std::vector<View>& views,
                                     const std::vector<Thing>& more = {}, const Ring& other = {},
                                     const ClearanceOptions& options = {}) {
  std::vector<Thing> things = {arch.thing()};
  things.insert(things.end(), more.begin(), more.end());
  return JudgeThings(arch.footprint(), views, things, other, options);
}

/// A block with a passage of this plan, 1.5 high.
std::vector<ClearanceDecision> JudgePassage(const Footprint& block, const Ring& plan,
                                            const std::vector<View>& views) {
  const Mesh mesh =
      Subtract(test::Upright(block.polygon_in_map_m.outer, 0.0, 2.3), {test::Upright(plan, -0.1, 1.5)})
          .value();
  return JudgeThings(block, views, {{mesh, test::kBlueWall}});
}

TEST(JudgeClearance, IsClearForAnOpenArch) {
  const auto decisions = Judge({}, kAllSides);
  ASSERT_FALSE(decisions.empty());
  EXPECT_EQ(decisions[0].verdict, Verdict::kClear) << decisions[0].reason;
  ASSERT_TRUE(decisions[0].corridor.has_value());
  EXPECT_NEAR(decisions[0].corridor->free_width_m, 1.6, 0.04);
  EXPECT_NEAR(decisions[0].corridor->free_height_m, 1.5, 0.04);
  EXPECT_EQ(decisions[0].seen_ratio, 1.0);
}

TEST(JudgeClearance, DecidesForBothEnds) {
  const auto decisions = Judge({}, kAllSides);
  ASSERT_EQ(decisions.size(), 2u);
  EXPECT_EQ(decisions[0].side, 0);
  EXPECT_EQ(decisions[1].side, 2);
  EXPECT_EQ(decisions[0].corridor->entry_in_map_m, decisions[1].corridor->exit_in_map_m);
}

TEST(JudgeClearance, MeasuresASlantedPassageAcrossItsOwnWalls) {
  const double slant = M_PI / 6.0, mouth = 1.45 / std::cos(slant), shift = std::tan(slant);
  const Ring plan = {{-mouth / 2 - shift, -1.0},
                     {mouth / 2 - shift, -1.0},
                     {mouth / 2 + shift, 1.0},
                     {-mouth / 2 + shift, 1.0}};
  std::vector<View> views = kAllSides;
  for (const double end : {-4.5, 4.5}) {
    views.push_back(test::LevelView({end * std::sin(slant), end * std::cos(slant), 1.1},
                                    M_PI_2 - slant + (end > 0.0 ? M_PI : 0.0)));
  }
  const auto decisions = JudgePassage(Arch{}.footprint(), plan, views);
  ASSERT_FALSE(decisions.empty());
  EXPECT_EQ(decisions[0].verdict, Verdict::kClear) << decisions[0].reason;
  ASSERT_TRUE(decisions[0].corridor.has_value());
  EXPECT_NEAR(decisions[0].corridor->free_width_m, 1.45, 0.05);
  const Eigen::Vector3d way =
      (decisions[0].corridor->exit_in_map_m - decisions[0].corridor->entry_in_map_m).normalized();
  EXPECT_NEAR(way.x(), std::sin(slant), 0.03);
}

TEST(JudgeClearance, TellsTheWidthOfAWaist) {
  const Ring plan = {{-1.2, -1.0}, {1.2, -1.0}, {0.45, 0.0}, {1.2, 1.0}, {-1.2, 1.0}, {-0.45, 0.0}};
  const auto decisions = JudgePassage(Arch{}.footprint(), plan, kAllSides);
  ASSERT_FALSE(decisions.empty());
  EXPECT_EQ(decisions[0].verdict, Verdict::kBlocked);
  EXPECT_THAT(decisions[0].reason, HasSubstr("too narrow by"));
  EXPECT_NEAR(decisions[0].corridor->free_width_m, 0.9, 0.04);
}

TEST(JudgeClearance, IsNeverClearForABend) {
  Footprint block = Arch{}.footprint();
  block.polygon_in_map_m.outer = test::Box(-3.0, -1.5, 3.0, 1.5);
  // Straight in, then on to the right at 45 degrees.
  const Ring plan = {{-1.5, -2.0}, {0.1, -2.0}, {0.1, -0.3}, {2.4, 2.0}, {0.1, 2.0}, {-1.5, 0.4}};
  const auto decisions = JudgePassage(block, plan, kAllSides);
  ASSERT_FALSE(decisions.empty());
  for (const ClearanceDecision& decision : decisions)
    EXPECT_NE(decision.verdict, Verdict::kClear) << decision.reason;
}

TEST(JudgeClearance, NamesTheMarginThatBinds) {
  const auto decisions = Judge({}, kAllSides);
  ASSERT_EQ(decisions[0].verdict, Verdict::kClear) << decisions[0].reason;
  const double least = std::min({decisions[0].margin_left_m, decisions[0].margin_right_m,
                                 decisions[0].margin_up_m, decisions[0].margin_down_m});
  const double bound =
      decisions[0].binding == Bound::kLeft ? decisions[0].margin_left_m : decisions[0].margin_right_m;
  EXPECT_TRUE(decisions[0].binding == Bound::kLeft || decisions[0].binding == Bound::kRight);
  EXPECT_EQ(bound, least);
  EXPECT_THAT(decisions[0].reason, HasSubstr(ToString(decisions[0].binding)));
  EXPECT_NE(decisions[0].binding, decisions[1].binding);  // Left is right on the way back.
}

TEST(JudgeClearance, GivesNegativeMarginsToWhatIsTooTight) {
  const auto low = Judge({1.6, 0.70, 1.5}, kAllSides);
  EXPECT_LT(std::min(low[0].margin_up_m, low[0].margin_down_m), 0.0);
  EXPECT_TRUE(low[0].binding == Bound::kRoof || low[0].binding == Bound::kGround) << ToString(low[0].binding);
  const auto narrow = Judge({1.10, 1.5, 1.5}, kAllSides);
  EXPECT_LT(std::min(narrow[0].margin_left_m, narrow[0].margin_right_m), 0.0);
}

TEST(JudgeClearance, TellsThreeDistancesApart) {
  const auto decisions = Judge({}, kAllSides);
  ASSERT_EQ(decisions[0].verdict, Verdict::kClear) << decisions[0].reason;
  const Distances& distances = decisions[0].distances;
  // From the body to a jamb, by half the passage's width less the radius.
  EXPECT_NEAR(distances.to_surface_m, 0.8 - kVehicle.radius_m, 0.05);
  EXPECT_NEAR(distances.to_occupied_m, distances.to_surface_m, 0.06);
  EXPECT_LE(distances.to_occupied_m, distances.to_surface_m + 0.001);
  EXPECT_GE(distances.to_unknown_m, kVehicle.safety_margin_m - 0.05);
}

TEST(JudgeClearance, AsksForMoreRoomWithMoreSigmas) {
  ClearanceOptions careful;
  careful.sigmas = 10.0;
  ClearanceOptions careless;
  careless.sigmas = 0.0;
  const auto strict = Judge({}, kAllSides, {}, {}, careful), loose = Judge({}, kAllSides, {}, {}, careless);
  const double std_m = std::hypot(loose[0].corridor->std_m, loose[0].corridor->place_std_m);
  EXPECT_GT(std_m, 0.0);
  EXPECT_NEAR(loose[0].margin_left_m - strict[0].margin_left_m, 10.0 * std_m, 1e-9);
  EXPECT_NEAR(loose[0].margin_up_m - strict[0].margin_up_m, 10.0 * loose[0].corridor->std_m, 1e-9);
}

TEST(JudgeClearance, DoesNotBlockAsTooLowWhatItSawFromOneSideOnly) {
  const Thing behind = test::Block(test::Box(-3.0, 3.0, 3.0, 3.4), 0.0, 3.0, test::kBlueWall);
  const auto decisions = Judge({}, {test::FromSouth()}, {behind});
  EXPECT_EQ(decisions[0].verdict, Verdict::kInsufficientData) << decisions[0].reason;
  EXPECT_THAT(decisions[0].reason, HasSubstr("seen from one side only"));
}

TEST(JudgeClearance, BlocksWhatIsTooLow) {
  const auto decisions = Judge({1.6, 0.70, 1.5}, kAllSides);
  EXPECT_EQ(decisions[0].verdict, Verdict::kBlocked);
  EXPECT_THAT(decisions[0].reason, HasSubstr("too low"));
}

TEST(JudgeClearance, BlocksWhatIsTooNarrow) {
  const auto decisions = Judge({1.10, 1.5, 1.5}, kAllSides);
  EXPECT_EQ(decisions[0].verdict, Verdict::kBlocked);
  EXPECT_THAT(decisions[0].reason, HasSubstr("too narrow"));
}

TEST(JudgeClearance, BlocksARecessWhoseOtherSideIsClosed) {
  const Thing dark = test::Block(test::Box(-0.8, -0.1, 0.8, -0.05), 0.0, 1.5, {8, 8, 8});
  const auto decisions = Judge({1.6, 1.5, 0.7}, kAllSides, {dark});
  EXPECT_EQ(decisions[0].verdict, Verdict::kBlocked) << decisions[0].reason;
}

TEST(JudgeClearance, DoesNotBlockAnArchBeforeAThingThatHidesTheSky) {
  const Thing behind = test::Block(test::Box(-9.0, 3.0, 9.0, 4.0), 0.0, 4.0, {30, 60, 30});
  const auto decisions = Judge({}, {test::FromSouth(), test::FromNorth()}, {behind});
  EXPECT_EQ(decisions[0].verdict, Verdict::kInsufficientData) << decisions[0].reason;
}

TEST(JudgeClearance, AsksForAnotherDirectionWhenAllWasSeenFromOne) {
  const auto decisions = Judge({}, {test::FromSouth()});
  EXPECT_EQ(decisions[0].verdict, Verdict::kInsufficientData) << decisions[0].reason;
  ASSERT_TRUE(decisions[0].wanted.has_value());
  const Eigen::Vector3d from = test::FromSouth().map_from_camera.translation_m;
  EXPECT_GT((decisions[0].wanted->position_in_map_m - from).norm(), 1.0);
}

TEST(JudgeClearance, KnowsNothingWithoutPictures) {
  EXPECT_EQ(Judge({}, {})[0].verdict, Verdict::kInsufficientData);
}

TEST(JudgeClearance, BlocksAPoleInFront) {
  const Thing pole = test::Block(test::Box(-0.05, -1.3, 0.05, -1.2), 0.0, 2.5, {30, 60, 30});
  const auto decisions = Judge({}, kAllSides, {pole});
  EXPECT_EQ(decisions[0].verdict, Verdict::kBlocked) << decisions[0].reason;
  EXPECT_THAT(decisions[0].reason, HasSubstr("obstacle at (690"));
}

TEST(JudgeClearance, BlocksABuildingRightBehindTheExit) {
  const auto decisions = Judge({}, kAllSides, {}, test::Box(-1.0, 1.5, 1.0, 3.0));
  EXPECT_EQ(decisions[0].verdict, Verdict::kBlocked);
  EXPECT_THAT(decisions[0].reason, HasSubstr("building 2 stands in the way"));
}

TEST(JudgeClearance, DoesNotTakeAnotherOutlineOfTheBuildingForANeighbour) {
  const auto decisions = Judge({}, kAllSides, {}, test::Box(-1.5, -0.4, 2.9, 1.4));
  EXPECT_EQ(decisions[0].verdict, Verdict::kClear) << decisions[0].reason;
}

TEST(JudgeClearance, TakesAMarkOnTheGroundForGround) {
  const Thing mark = test::Block(test::Box(-0.3, -1.3, 0.3, -1.15), -0.01, 0.0005, {30, 60, 30});
  const auto decisions = Judge({},
                               {test::FromSouth(), test::FromNorth(), test::FromEast(), test::FromWest(),
                                test::LevelView({-3.5, -4.0, 1.3}, 0.9)},
                               {mark});
  EXPECT_EQ(decisions[0].verdict, Verdict::kClear) << decisions[0].reason;
}

class Hidden : public ::testing::TestWithParam<Thing> {};

TEST_P(Hidden, IsNeverClear) {
  for (const auto& decision : Judge({}, {test::FromSouth(), test::FromNorth()}, {GetParam()})) {
    EXPECT_NE(decision.verdict, Verdict::kClear) << decision.reason;
    EXPECT_THAT(decision.reason, Not(HasSubstr("free:")));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Obstacles, Hidden,
    ::testing::Values(
        test::Block(test::Box(-0.8, -0.1, 0.8, 0.1), 0.6, 0.9, {20, 90, 140}),       // A wooden beam.
        test::Block(test::Box(-0.8, -0.1, 0.8, 0.1), 0.5, 0.8, test::kBlueWall),     // Painted as the walls.
        test::Block(test::Box(-0.4, -0.3, 0.4, 0.3), 0.0, 0.9, {40, 80, 120}),       // A box inside.
        test::Block(test::Box(-0.4, -0.3, 0.4, 0.3), 0.0, 0.6, {70, 71, 72}),        // As grey as shade.
        test::Block(test::Box(-0.8, 0.0, 0.8, 0.02), 0.0, 1.5, {90, 90, 90}),        // A pane.
        test::Block(test::Box(-0.06, -0.06, 0.06, 0.06), 0.0, 1.5, {60, 90, 90})));  // A post.

}  // namespace
}  // namespace soffit
