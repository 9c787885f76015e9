#include "test/sim/draw/draw.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

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

}  // namespace
}  // namespace soffit::sim
