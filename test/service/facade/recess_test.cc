#include "service/facade/recess.h"

#include <gmock/gmock.h>

#include "test/support/painted_world.h"

namespace soffit {
namespace {

using test::Arch;
using test::Block;
using test::Box;
using ::testing::SizeIs;

const Arch kRecess{1.6, 1.5, 0.6};

/// What is made of the south wall, with its niche painted by `paint`.
Facade ReadSouthWall(const Arch& arch, const std::vector<test::Thing>& paint) {
  std::vector<test::Thing> things = {arch.thing()};
  things.insert(things.end(), paint.begin(), paint.end());
  const auto seeing = test::Look({test::FromSouth()}, things);
  return ReadFacades(arch.footprint(), seeing.images, seeing.masks, seeing.sights, {})[0];
}

TEST(ReadFacades, TellsTheDepthOfARecessFromHowMuchNarrowerItsBackIs) {
  const Facade facade = ReadSouthWall(kRecess, {Block(Box(-0.8, -0.16, 0.8, -0.15), 0.0, 1.5, {60, 60, 60})});
  ASSERT_THAT(facade.openings, SizeIs(1));
  ASSERT_TRUE(facade.openings[0].recess);
  EXPECT_NEAR(facade.openings[0].recess->depth_m, 0.59, 0.1);  // A pixel is a centimetre.
}

TEST(ReadFacades, TellsTheDepthOfARecessWithDarkSidesFromTheEdgesOfItsBack) {
  const Facade facade =
      ReadSouthWall(kRecess, {Block(Box(-0.8, -0.16, 0.8, -0.15), 0.0, 1.5, {75, 75, 75}),
                              Block(Box(-0.8, -0.745, -0.79, -0.15), 0.0, 1.5, {45, 45, 45}),
                              Block(Box(0.79, -0.745, 0.8, -0.15), 0.0, 1.5, {45, 45, 45}),
                              Block(Box(-0.8, -0.745, 0.8, -0.15), 1.49, 1.5, {45, 45, 45})});
  ASSERT_THAT(facade.openings, SizeIs(1));
  ASSERT_TRUE(facade.openings[0].recess);
  EXPECT_NEAR(facade.openings[0].recess->depth_m, 0.59, 0.1);  // A pixel is a centimetre.
  EXPECT_LT(facade.openings[0].recess->std_m, 0.1);
}

TEST(ReadFacades, TellsNoDepthOfAPaintedDoor) {
  const Facade facade =
      ReadSouthWall({0.01, 0.01, 0.01}, {Block(Box(-0.6, -0.76, 0.6, -0.75), 0.0, 1.5, {60, 60, 60})});
  ASSERT_THAT(facade.openings, SizeIs(1));
  EXPECT_FALSE(facade.openings[0].recess);
}

}  // namespace
}  // namespace soffit
