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
const std::vector<View> kAllSides = {test::FromSouth(), test::FromNorth(), test::FromEast(),
                                     test::FromWest()};

/// From painted pictures to decisions, with the stages as they are chained in the service; `other` is the
/// outline of another building of the map.
std::vector<ClearanceDecision> Judge(const Arch& arch, const std::vector<View>& views,
                                     const std::vector<Thing>& more = {}, const Ring& other = {}) {
  std::vector<Thing> things = {arch.thing()};
  things.insert(things.end(), more.begin(), more.end());
  const auto seeing = test::Look(views, things);
  const Alignment aligned = AlignSights(arch.footprint(), seeing.masks, seeing.sights, {});
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
  const Scene scene = BuildScene(1, objects, {solid}, aligned.sights, {});
  return JudgeClearance(scene, 1, PlanCorridors(scene, 1, kVehicle, {}), aligned.sights, kVehicle, {});
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
  EXPECT_THAT(decisions[0].reason, HasSubstr("obstacle at"));
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
