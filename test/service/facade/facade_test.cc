#include "service/facade/facade.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/facade/wall.h"
#include "test/support/painted_world.h"

namespace soffit {
namespace {

using test::Arch;
using test::Look;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<Facade> Read(const Arch& arch, const std::vector<View>& views,
                         const std::vector<test::Thing>& more = {}) {
  std::vector<test::Thing> things = {arch.thing()};
  things.insert(things.end(), more.begin(), more.end());
  const auto seeing = Look(views, things);
  return ReadFacades(arch.footprint(), seeing.images, seeing.masks, seeing.sights, {});
}

TEST(ReadFacades, MeasuresASeeThroughOpening) {
  const auto facades = Read({}, {test::FromSouth()});
  ASSERT_THAT(facades, SizeIs(4));
  EXPECT_TRUE(facades[0].was_seen);
  EXPECT_NEAR(facades[0].height_m, 2.3, 0.02);
  ASSERT_THAT(facades[0].openings, SizeIs(1));
  const Opening& opening = facades[0].openings[0];
  EXPECT_TRUE(opening.is_through) << opening.evidence;
  ASSERT_THAT(opening.ring_in_wall_m, SizeIs(4));
  EXPECT_NEAR(opening.ring_in_wall_m[0].x(), 1.2, 0.02);
  EXPECT_NEAR(opening.ring_in_wall_m[1].x(), 2.8, 0.02);
  EXPECT_NEAR(opening.ring_in_wall_m[2].y(), 1.5, 0.02);
}

TEST(ReadFacades, TakesALandscapePaintedOnTheWallForNoOpening) {
  const test::Thing wall = test::Block(test::Box(-2.0, -0.75, 2.0, 0.75), 0.0, 2.3, test::kBlueWall);
  const auto paint = [](double low, double high, const cv::Vec3b& bgr) {
    return test::Block(test::Box(-0.8, -0.76, 0.8, -0.75), low, high, bgr);
  };
  const auto seeing = Look({test::FromSouth()},
                           {wall, paint(0.0, 1.1, test::kGreyGround), paint(1.1, 1.5, test::kBrightSky)});
  const auto facades = ReadFacades(Arch{}.footprint(), seeing.images, seeing.masks, seeing.sights, {});
  for (const Opening& opening : facades[0].openings) {
    EXPECT_FALSE(opening.is_through);
    EXPECT_FALSE(opening.shows_background);
  }
}

/// A passage that leads to the east by as much as to the north, standing on the ground.
test::Thing Slanted() {
  const Ring opening = {{-1.45, -0.85}, {-0.25, -0.85}, {1.45, 0.85}, {0.25, 0.85}};
  return {Subtract(test::Upright(Arch{}.footprint().polygon_in_map_m.outer, 0.0, 2.3),
                   {test::Upright(opening, -0.1, 1.5)})
              .value(),
          test::kBlueWall};
}

TEST(ReadFacades, FollowsTheJambsOfASlantedPassage) {
  const auto seeing = Look({test::FromSouth(), test::FromNorth()}, {Slanted()});
  const auto facades = ReadFacades(Arch{}.footprint(), seeing.images, seeing.masks, seeing.sights, {});
  for (const std::size_t side : {std::size_t{0}, std::size_t{2}}) {
    ASSERT_THAT(facades[side].openings, SizeIs(1));
    const Opening& opening = facades[side].openings[0];
    EXPECT_NEAR(opening.ring_in_wall_m[0].x(), 0.65,
                0.03);  // Both mouths are at the left, seen from outside.
    EXPECT_NEAR(opening.ring_in_wall_m[1].x(), 1.85, 0.03);
    EXPECT_FALSE(opening.right_drift.has_value());  // Its own mouth hides that jamb.
    ASSERT_TRUE(opening.left_drift.has_value());
    EXPECT_NEAR(*opening.left_drift, 1.0, 0.1);
  }
}

TEST(ReadFacades, SeesThatJambsLeadStraightIn) {
  const auto facades = Read({}, {test::FromSouth()});
  ASSERT_THAT(facades[0].openings, SizeIs(1));
  const Opening& opening = facades[0].openings[0];
  EXPECT_NEAR(opening.left_drift.value_or(1.0), 0.0, 0.1);
  EXPECT_NEAR(opening.right_drift.value_or(1.0), 0.0, 0.1);
}

TEST(ReadFacades, ReadsTheHeadBesideAThingOfTheSameColour) {
  const test::Thing behind = test::Block(test::Box(-0.2, 3.0, 4.0, 4.0), 0.0, 2.3, test::kBlueWall);
  const auto facades = Read({}, {test::FromSouth()}, {behind});
  ASSERT_THAT(facades[0].openings, SizeIs(1));
  const Opening& opening = facades[0].openings[0];
  EXPECT_TRUE(opening.is_through) << opening.evidence;
  ASSERT_THAT(opening.ring_in_wall_m, SizeIs(4));
  EXPECT_NEAR(opening.ring_in_wall_m[2].y(), 1.5, 0.02);
}

TEST(ReadFacades, MeasuresTheSillBesideAThingThatStandsOnIt) {
  const test::Thing box = test::Block(test::Box(-0.3, -0.6, 0.3, 0.0), 0.4, 0.9, test::kGreyGround);
  const auto facades = Read({.sill_m = 0.4}, {test::FromSouth()}, {box});
  ASSERT_THAT(facades[0].openings, SizeIs(1));
  const Opening& opening = facades[0].openings[0];
  ASSERT_THAT(opening.ring_in_wall_m, SizeIs(4));
  EXPECT_NEAR(opening.ring_in_wall_m[0].y(), 0.4, 0.03);
}

TEST(ReadFacades, SeesThroughBesideAThingThatHidesMostOfTheSky) {
  const test::Thing behind = test::Block(test::Box(-0.55, 6.0, 6.0, 8.0), 0.0, 4.0, {30, 60, 30});
  const auto facades = Read({}, {test::FromSouth()}, {behind});
  ASSERT_THAT(facades[0].openings, SizeIs(1));
  EXPECT_TRUE(facades[0].openings[0].is_through) << facades[0].openings[0].evidence;
}

TEST(ReadFacades, LeavesOpenWhatShowsTooLittleBackground) {
  const test::Thing behind = test::Block(test::Box(-9.0, 3.0, 9.0, 4.0), 0.0, 4.0, {30, 60, 30});
  const auto facades = Read({}, {test::FromSouth()}, {behind});
  ASSERT_THAT(facades[0].openings, SizeIs(1));
  EXPECT_FALSE(facades[0].openings[0].is_through) << facades[0].openings[0].evidence;
  EXPECT_TRUE(facades[0].openings[0].shows_background) << facades[0].openings[0].evidence;
}

TEST(ReadFacades, TakesADarkRecessForNoWayThrough) {
  const test::Thing dark = test::Block(test::Box(-0.8, -0.1, 0.8, -0.05), 0.0, 1.5, {8, 8, 8});
  const auto facades = Read({1.6, 1.5, 0.7}, {test::FromSouth()}, {dark});
  for (const Opening& opening : facades[0].openings) EXPECT_FALSE(opening.is_through) << opening.evidence;
}

TEST(ReadFacades, TakesAPaintedDoorForNoWayThrough) {
  const test::Thing door = test::Block(test::Box(-0.6, -0.76, 0.6, -0.75), 0.0, 1.5, {60, 60, 60});
  const auto facades = Read({0.01, 0.01, 0.01}, {test::FromSouth()}, {door});
  for (const Opening& opening : facades[0].openings) EXPECT_FALSE(opening.is_through) << opening.evidence;
}

TEST(ReadFacades, TakesWhatIsOpenAtTheEndOfAWallForNoOpening) {
  const test::Thing above = test::Block(test::Box(2.0, -0.75, 2.6, 0.75), 1.5, 2.3, test::kBlueWall);
  const auto seeing = Look({test::FromSouth()}, {Arch{}.thing(), above});
  Footprint footprint = Arch{}.footprint();
  for (Eigen::Vector2d& p : footprint.polygon_in_map_m.outer) p.x() = p.x() > 0.0 ? 2.6 : p.x();
  const auto facades = ReadFacades(footprint, seeing.images, seeing.masks, seeing.sights, {});
  ASSERT_THAT(facades[0].openings, SizeIs(1));
  EXPECT_NEAR(facades[0].openings[0].ring_in_wall_m[1].x(), 2.8, 0.02);
}

TEST(ReadFacades, KnowsWhichWallsItDidNotSee) {
  const auto facades = Read({}, {test::FromSouth()});
  EXPECT_FALSE(facades[1].was_seen);
  EXPECT_FALSE(facades[2].was_seen);
  EXPECT_FALSE(facades[3].was_seen);
  EXPECT_THAT(facades[2].openings, IsEmpty());
}

TEST(ReadFacades, ReadsTheWholeWallFromAfarWhenANearPictureCutsItsFootOff) {
  const View near = test::LevelView({0.0, -2.0, 1.3}, M_PI / 2);
  const auto alone = Read({}, {near});
  EXPECT_FALSE(alone[0].was_seen);
  const auto facades = Read({}, {near, test::FromSouth()});
  EXPECT_TRUE(facades[0].was_seen);
  ASSERT_THAT(facades[0].openings, SizeIs(1));
  EXPECT_NEAR(facades[0].openings[0].ring_in_wall_m[0].y(), 0.0, 1e-9);
}

TEST(ReadFacades, SeesNothingWithoutPictures) {
  for (const Facade& facade : ReadFacades(Arch{}.footprint(), {}, {}, {}, {})) EXPECT_FALSE(facade.was_seen);
}

TEST(FindWayOut, EndsAtTheWallOpposite) {
  const auto way = FindWayOut({test::Box(-2.0, -0.75, 2.0, 0.75), {}}, 0, 1.0);
  ASSERT_TRUE(way.has_value());
  EXPECT_EQ(way->side, 2);
  EXPECT_NEAR(way->length_m, 1.5, 1e-9);
  EXPECT_NEAR(way->u_m, 3.0, 1e-9);
}

TEST(FindWayOut, FindsNoneIntoACourtyard) {
  Ring yard = test::Box(-0.5, -0.5, 0.5, 0.5);
  std::reverse(yard.begin(), yard.end());
  EXPECT_FALSE(FindWayOut({test::Box(-2.0, -2.0, 2.0, 2.0), {yard}}, 0, 2.0).has_value());
}

}  // namespace
}  // namespace soffit
