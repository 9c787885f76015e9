#include "test/sim/draw/draw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "test/sim/draw/plan.h"
#include "test/sim/draw/shapes.h"
#include "test/sim/truth/truth.h"

namespace soffit::sim {
namespace {

TEST(DrawWorld, GivesTheSameWorldForASeedAndAnotherForAnother) {
  EXPECT_EQ(FormatWorld(DrawWorld(5)), FormatWorld(DrawWorld(5)));
  EXPECT_NE(FormatWorld(DrawWorld(5)), FormatWorld(DrawWorld(6)));
}

TEST(DrawWorld, GivesWorldsThatCanBeReadBack) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const std::string text = FormatWorld(DrawWorld(seed));
    const Result<World> world = ParseWorld(text, "seed-" + std::to_string(seed), ".");
    ASSERT_TRUE(world.ok()) << world.error().message << "\n" << text;
    EXPECT_EQ(FormatWorld(world.value()), text);
  }
}

TEST(DrawWorld, GivesClearCasesOfEveryOutcome) {
  std::map<Outcome, int> count;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Truth truth = FindTruth(DrawWorld(seed));
    ++count[truth.expected];
    for (const ObjectTruth& object : truth.objects) {
      if (object.passages.empty()) continue;
      EXPECT_GE(std::abs(object.passages[0].spare_m), 0.08) << seed;
    }
  }
  EXPECT_GE(count[Outcome::kFlown], 3);
  EXPECT_GE(count[Outcome::kNotFlown], 2);
}

TEST(DrawNastyWorld, GivesTheSameWorldForASeedThatCanBeReadBack) {
  for (const std::uint64_t seed : {23, 40}) {
    const std::string text = FormatWorld(DrawNastyWorld(seed));
    EXPECT_EQ(FormatWorld(DrawNastyWorld(seed)), text);
    const Result<World> world = ParseWorld(text, "nasty-" + std::to_string(seed), ".");
    ASSERT_TRUE(world.ok()) << world.error().message << "\n" << text;
    EXPECT_EQ(FormatWorld(world.value()), text);
  }
}

TEST(DrawNastyWorld, TakesTheKindsInTurns) {
  const std::uint64_t kinds = NastyPlans().size();
  const auto kind_of = [](const World& world) { return world.title.substr(0, world.title.find(',')); };
  EXPECT_EQ(kind_of(DrawNastyWorld(3)), NastyPlans()[3].kind);
  EXPECT_EQ(kind_of(DrawNastyWorld(kinds + 3)), NastyPlans()[3].kind);
  EXPECT_NE(FormatWorld(DrawNastyWorld(3)), FormatWorld(DrawNastyWorld(kinds + 3)));
}

TEST(DrawNastyWorld, HangsARopeIntoAPassageThatWouldBeLargeEnough) {
  const auto& plans = NastyPlans();
  const auto rope = std::find_if(plans.begin(), plans.end(),
                                 [](const Plan& plan) { return plan.order.trouble == Trouble::kRope; });
  ASSERT_NE(rope, plans.end());
  World world = DrawNastyWorld(static_cast<std::uint64_t>(rope - plans.begin()));
  const double spare_m = FindTruth(world).objects.at(0).passages.at(0).spare_m;
  world.obstacles.clear();
  EXPECT_LT(spare_m, FindTruth(world).objects.at(0).passages.at(0).spare_m - 0.1);
  EXPECT_EQ(FindTruth(world).expected, Outcome::kFlown);
}

TEST(SlantedParts, LeaveAPassageAsWideAsTheOpeningAcrossItself) {
  constexpr double kSlant_rad = 0.35, kFree_m = 1.5;
  World world;
  world.vehicle = {0.3, 0.2, 0.2};
  Structure building;
  building.id = "slanted";
  building.parts = SlantedParts({4.0, 1.5}, kSlant_rad, {-0.75, 0.75, 0.0, kFree_m, false}, 2.0);
  building.yaw_rad = kSlant_rad;  // The passage runs north: a direction that FindTruth tries.
  world.buildings = {building};
  const Passage best = FindTruth(world).objects.at(0).passages.at(0);
  EXPECT_TRUE(best.is_passable);
  EXPECT_NEAR(best.free_width_m, 1.5, 1e-3);
  EXPECT_NEAR(best.free_height_m, kFree_m, 1e-3);
  EXPECT_NEAR(best.entry_m.x(), best.exit_m.x(), 1e-3);
}

}  // namespace
}  // namespace soffit::sim
