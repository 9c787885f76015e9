#include "service/solid/solid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "test/support/plain_building.h"

namespace soffit {
namespace {

using test::Building;
using test::kBlock;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Opening Through(const Ring& ring) {
  Opening opening;
  opening.ring_in_wall_m = ring;
  opening.std_m = 0.005;
  opening.is_through = true;
  opening.shows_background = true;
  return opening;
}

std::vector<Facade> Closed(int sides) {
  std::vector<Facade> facades;
  for (int side = 0; side < sides; ++side) facades.push_back({1, side, 0.0, 2.0, 0.01, true, {}});
  return facades;
}

Ring RoundHead(double left, double right, double spring) {
  Ring ring = {{left, 0.0}, {right, 0.0}};
  for (int i = 0; i <= 24; ++i) {
    const double angle = M_PI * i / 24;
    ring.emplace_back(0.5 * (left + right) + 0.5 * (right - left) * std::cos(angle),
                      spring + 0.5 * (right - left) * std::sin(angle));
  }
  return ring;
}

TEST(RaiseSolid, RaisesAFootprintToItsHeight) {
  const auto solid = RaiseSolid(Building(kBlock), {});
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_NEAR(solid.value().volume_m3, 12.0, 1e-9);
  EXPECT_TRUE(IsClosedManifold(solid.value().mesh));
  EXPECT_THAT(solid.value().passages, IsEmpty());
}

TEST(RaiseSolid, CutsAPassageThatBothWallsShow) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}})};
  facades[2].openings = {Through({{1.4, 0}, {3, 0}, {3, 1.5}, {1.4, 1.5}})};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.6 * 1.5 * 1.5, 1e-6);
  ASSERT_THAT(solid.value().passages, SizeIs(1));
  EXPECT_EQ(solid.value().passages[0].exit_wall, 2);
}

TEST(RaiseSolid, JoinsMouthsThatDifferALittleByStraightLines) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}})};
  facades[2].openings = {Through({{1.42, 0}, {2.98, 0}, {2.98, 1.48}, {1.42, 1.48}})};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok());
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.58 * 1.49 * 1.5, 1e-3);
}

TEST(RaiseSolid, TakesTheLargerOfMouthsThatDifferForSomethingBeyondHidesTheOther) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0.3}, {2.6, 0.3}, {2.6, 1.5}, {1, 1.5}})};
  facades[2].openings = {Through({{2, 0.3}, {3, 0.3}, {3, 1.5}, {2, 1.5}})};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok());
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.6 * 1.2 * 1.5, 1e-6);
}

TEST(RaiseSolid, TakesTheLargerOfStandingMouthsWhereItsJambsLeadStraightIn) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {2.8, 0}, {2.8, 1.5}, {1, 1.5}})};
  facades[0].openings[0].left_drift = facades[0].openings[0].right_drift = 0.0;
  facades[2].openings = {Through({{1.2, 0}, {1.7, 0}, {1.7, 1.5}, {1.2, 1.5}})};  // x from 2.3 to 2.8.
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.8 * 1.5 * 1.5, 1e-6);
}

TEST(RaiseSolid, LeadsFromALowMouthUpToAHigherOne) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0.3}, {2.6, 0.3}, {2.6, 1.3}, {1, 1.3}})};
  facades[2].openings = {Through({{1.4, 0.7}, {3, 0.7}, {3, 1.7}, {1.4, 1.7}})};  // x from 1 to 2.6.
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  ASSERT_THAT(solid.value().passages, SizeIs(1));
  const auto& sections = solid.value().passages[0].sections_in_map_m;
  ASSERT_THAT(sections, SizeIs(2));
  EXPECT_NEAR(sections[0][0].z(), 0.3, 1e-6);
  EXPECT_NEAR(sections[1][0].z(), 0.7, 1e-6);
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.6 * 1.0 * 1.5, 1e-3);
}

TEST(RaiseSolid, NarrowsAPassageFromOneStandingMouthToTheOther) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}})};
  facades[2].openings = {Through({{1.4, 0}, {2.4, 0}, {2.4, 1.5}, {1.4, 1.5}})};  // x from 1.6 to 2.6.
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_TRUE(IsClosedManifold(solid.value().mesh));
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.3 * 1.5 * 1.5, 1e-3);
}

TEST(RaiseSolid, CutsAPassageThatIsSlantedToItsWalls) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{0.3, 0}, {1.5, 0}, {1.5, 1.5}, {0.3, 1.5}})};
  facades[2].openings = {Through({{1.0, 0}, {2.2, 0}, {2.2, 1.5}, {1.0, 1.5}})};  // x from 1.8 to 3.
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  ASSERT_THAT(solid.value().passages, SizeIs(1));
  EXPECT_THAT(solid.value().passages[0].sections_in_map_m, SizeIs(2));
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.2 * 1.5 * 1.5, 1e-3);
}

TEST(RaiseSolid, DoesNotJoinWhatOnlyLooksThroughSideways) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{0.3, 0}, {1.5, 0}, {1.5, 1.5}, {0.3, 1.5}})};
  facades[2].openings = {Through({{1.0, 0}, {2.2, 0}, {2.2, 1.5}, {1.0, 1.5}})};
  facades[2].openings[0].is_through = false;
  EXPECT_THAT(RaiseSolid(Building(kBlock), facades).value().passages, IsEmpty());
}

TEST(RaiseSolid, JoinsEachOfTwoSlantedPassagesAlongItsJambs) {
  // Each leads 1 to the right over 1 inward; straight opposite either lies a mouth of the other one.
  Footprint building = Building({{0, 0}, {8, 0}, {8, 2}, {0, 2}});
  auto facades = Closed(4);
  for (const double left : {0.5, 2.5}) {
    Opening front = Through({{left, 0}, {left + 1.5, 0}, {left + 1.5, 1.5}, {left, 1.5}});
    front.left_drift = 1.0;
    facades[0].openings.push_back(front);
    const double right = 8.0 - (left + 2.0);  // As seen from the back.
    Opening back = Through({{right - 1.5, 0}, {right, 0}, {right, 1.5}, {right - 1.5, 1.5}});
    back.left_drift = 1.0;
    facades[2].openings.push_back(back);
  }
  const auto solid = RaiseSolid(building, facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  ASSERT_THAT(solid.value().passages, SizeIs(2));
  for (const Passage& passage : solid.value().passages) {
    const auto& sections = passage.sections_in_map_m;
    ASSERT_THAT(sections, SizeIs(2));
    EXPECT_NEAR(sections[1][0].x() - sections[0][0].x(), 2.0, 1e-6);
  }
}

TEST(RaiseSolid, BendsAPassageWhereItsJambsMeet) {
  // Straight in for 1 m, then on at 45 degrees.
  Footprint building = Building({{0, 0}, {6, 0}, {6, 2}, {0, 2}});
  auto facades = Closed(4);
  Opening front = Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}});
  front.left_drift = front.right_drift = 0.0;
  Opening back = Through({{2.4, 0}, {4, 0}, {4, 1.5}, {2.4, 1.5}});  // x from 2 to 3.6.
  back.left_drift = back.right_drift = 1.0;
  facades[0].openings = {front};
  facades[2].openings = {back};
  const auto solid = RaiseSolid(building, facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_TRUE(IsClosedManifold(solid.value().mesh));
  ASSERT_THAT(solid.value().passages, SizeIs(1));
  ASSERT_THAT(solid.value().passages[0].sections_in_map_m, SizeIs(3));
  EXPECT_TRUE(solid.value().passages[0].sections_in_map_m[1][0].isApprox(Eigen::Vector3d(1, 1, 0), 1e-6));
  EXPECT_NEAR(solid.value().volume_m3, 24.0 - 1.6 * 1.5 * 2.0, 1e-3);
}

TEST(RaiseSolid, NarrowsAPassageToItsWaist) {
  auto facades = Closed(4);
  for (const std::size_t side : {std::size_t{0}, std::size_t{2}}) {
    facades[side].openings = {Through({{1, 0}, {3, 0}, {3, 1.5}, {1, 1.5}})};
    facades[side].openings[0].left_drift = 0.4;
    facades[side].openings[0].right_drift = -0.4;
  }
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  ASSERT_THAT(solid.value().passages, SizeIs(1));
  const auto& sections = solid.value().passages[0].sections_in_map_m;
  ASSERT_THAT(sections, SizeIs(3));
  EXPECT_NEAR(sections[1][1].x() - sections[1][0].x(), 1.4, 1e-6);
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.7 * 1.5 * 1.5, 1e-3);
}

TEST(RaiseSolid, LeadsUnderACorner) {
  Footprint building = Building({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {3.7, 0}, {3.7, 1.5}, {1, 1.5}})};
  facades[1].openings = {Through({{0.3, 0}, {3, 0}, {3, 1.5}, {0.3, 1.5}})};
  const auto solid = RaiseSolid(building, facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  ASSERT_THAT(solid.value().passages, SizeIs(1));
  EXPECT_EQ(solid.value().passages[0].exit_wall, 1);
  EXPECT_TRUE(IsClosedManifold(solid.value().mesh));
}

TEST(RaiseSolid, JoinsNoMouthsOfDifferentStoreys) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {2.6, 0}, {2.6, 0.8}, {1, 0.8}})};
  facades[2].openings = {Through({{1.4, 1.1}, {3, 1.1}, {3, 1.9}, {1.4, 1.9}})};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_THAT(solid.value().passages, IsEmpty());
}

TEST(RaiseSolid, JoinsNoMouthsThatMeetInACorner) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {4, 0}, {4, 1.5}, {1, 1.5}})};
  facades[1].openings = {Through({{0, 0}, {1, 0}, {1, 1.5}, {0, 1.5}})};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_THAT(solid.value().passages, IsEmpty());
}

TEST(RaiseSolid, SupposesThatASlantedPassageGoesOnAlongItsJambs) {
  auto facades = Closed(4);
  facades[2].was_seen = false;
  facades[0].openings = {Through({{0.3, 0}, {1.5, 0}, {1.5, 1.5}, {0.3, 1.5}})};
  facades[0].openings[0].left_drift = 1.0;
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  ASSERT_THAT(solid.value().passages, SizeIs(1));
  EXPECT_TRUE(solid.value().passages[0].sections_in_map_m[1][0].isApprox(Eigen::Vector3d(1.8, 1.5, 0), 1e-6));
}

TEST(RaiseSolid, CutsNoPassageIntoAWallThatWasSeenClosed) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}})};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok());
  EXPECT_THAT(solid.value().passages, IsEmpty());
  EXPECT_NEAR(solid.value().volume_m3, 12.0, 1e-9);
}

TEST(RaiseSolid, CutsARecessAsDeepAsItIs) {
  auto facades = Closed(4);
  Opening niche = Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}});
  niche.recess = Recess{{{1, 0}, {2.5, 0}, {2.5, 1.4}, {1, 1.4}}, 0.4, 0.01};
  facades[0].openings = {niche};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok());
  EXPECT_THAT(solid.value().passages, IsEmpty());
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.5 * 1.4 * 0.4, 1e-6);
}

TEST(RaiseSolid, ProposesAPassageToAWallThatWasNotSeen) {
  auto facades = Closed(4);
  facades[2].was_seen = false;
  facades[0].openings = {Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}})};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok());
  ASSERT_THAT(solid.value().passages, SizeIs(1));
  EXPECT_EQ(solid.value().passages[0].exit_wall, 2);
}

TEST(RaiseSolid, StaysClosedUnderARoundHead) {
  auto facades = Closed(4);
  facades[0].openings = {Through(RoundHead(1.0, 2.6, 0.8))};
  facades[2].openings = {Through(RoundHead(1.4, 3.0, 0.8))};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_TRUE(IsClosedManifold(solid.value().mesh));
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.5 * (1.6 * 0.8 + 0.5 * M_PI * 0.64), 0.02);
}

TEST(RaiseSolid, CutsATableFromCrossingPassages) {
  const Ring square = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
  auto facades = Closed(4);
  for (Facade& facade : facades) facade.openings = {Through({{0.3, 0}, {2.7, 0}, {2.7, 1.6}, {0.3, 1.6}})};
  const auto solid = RaiseSolid(Building(square), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_TRUE(IsClosedManifold(solid.value().mesh));
  EXPECT_THAT(solid.value().passages, SizeIs(2));
  EXPECT_NEAR(solid.value().volume_m3, 9.0 * 0.4 + 4 * 0.09 * 1.6, 1e-6);
}

TEST(RaiseSolid, CutsOneWingOfAnL) {
  const Ring ell = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}};
  auto facades = Closed(6);
  facades[0].openings = {Through({{2, 0}, {3.5, 0}, {3.5, 1.4}, {2, 1.4}})};
  facades[2].openings = {Through({{0.5, 0}, {2, 0}, {2, 1.4}, {0.5, 1.4}})};
  const auto solid = RaiseSolid(Building(ell), facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  ASSERT_THAT(solid.value().passages, SizeIs(1));
  EXPECT_NEAR(solid.value().volume_m3, 6.0 * 2.0 - 1.5 * 1.4 * 1.0, 1e-6);
}

TEST(RaiseSolid, KeepsACourtyardOpen) {
  Footprint building = Building({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  building.polygon_in_map_m.holes = {{{1, 1}, {1, 3}, {3, 3}, {3, 1}}};
  const auto solid = RaiseSolid(building, {});
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  EXPECT_NEAR(solid.value().volume_m3, 12.0 * 2.0, 1e-6);
}

Footprint WithLevels(const Ring& ring, const std::vector<Level>& levels) {
  Footprint footprint = Building(ring);
  footprint.levels = levels;
  footprint.height_m = levels.back().height_m;
  return footprint;
}

double VolumeOf(const Footprint& footprint, const std::vector<Facade>& facades = {}) {
  const auto solid = RaiseSolid(footprint, facades);
  EXPECT_TRUE(solid.ok() && IsClosedManifold(solid.value().mesh));
  return solid.ok() ? solid.value().volume_m3 : 0.0;
}

TEST(RaiseSolid, SetsATowerBack) {
  EXPECT_NEAR(
      VolumeOf(WithLevels(kBlock, {{1, {0, 0, 0, 0}}, {1, {0.25, 1, 0.25, 1}}, {3, {0.25, 1, 0.25, 1}}})),
      6.0 + 2.0 * 2.0 * 1.0, 1e-4);
}

TEST(RaiseSolid, PutsAGableAHipAndAMonoPitchOnWalls) {
  EXPECT_NEAR(VolumeOf(WithLevels(kBlock, {{1, {0, 0, 0, 0}}, {2, {0.75, 0, 0.75, 0}}})), 9.0, 1e-4);
  EXPECT_NEAR(VolumeOf(WithLevels(kBlock, {{1, {0, 0, 0, 0}}, {2, {0, 0, 1.5, 0}}})), 9.0, 1e-4);
  EXPECT_NEAR(VolumeOf(WithLevels(kBlock, {{1, {0, 0, 0, 0}}, {2, {0.75, 0.75, 0.75, 0.75}}})),
              6.0 + 3.0 - 2.0 * (0.75 * 0.75 - 1.5 * 0.75 / 3.0), 1e-4);
}

TEST(RaiseSolid, LeansWallsAndStillCutsThePassage) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}})};
  facades[2].openings = {Through({{1.4, 0}, {3, 0}, {3, 1.5}, {1.4, 1.5}})};
  const Footprint leaning = WithLevels(kBlock, {{2, {0.2, 0, 0.2, 0}}});
  const auto solid = RaiseSolid(leaning, facades);
  ASSERT_TRUE(solid.ok()) << solid.error().message;
  const double depth_m = 1.5 - 2.0 * 0.1 * 0.75;  // Of the passage, half-way up.
  EXPECT_NEAR(solid.value().volume_m3, 4.0 * 2.0 * 1.3 - 1.6 * 1.5 * depth_m, 1e-3);
  EXPECT_THAT(solid.value().passages, SizeIs(1));
  EXPECT_NEAR(solid.value().openings[0].polygon_in_map_m[2].y(), 0.15, 1e-9);  // On the wall as it leans.
}

TEST(RaiseSolid, LowersOneWingOnly) {
  const Ring u = {{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {1, 1}, {1, 3}, {0, 3}};
  std::vector<double> end_of_wing(8, 0.0);
  end_of_wing[2] = 2.0;
  EXPECT_NEAR(VolumeOf(WithLevels(u, {{1, std::vector<double>(8, 0.0)}, {1, end_of_wing}, {2, end_of_wing}})),
              2.0 * 9.0 - 2.0, 1e-4);
}

TEST(RaiseSolid, RefusesWhatIsNoBuilding) {
  EXPECT_FALSE(RaiseSolid(Building({{0, 0}, {1, 0}}), {}).ok());
  EXPECT_FALSE(RaiseSolid(Building({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), {}).ok());
  EXPECT_FALSE(RaiseSolid(Building({{0, 0}, {0, 1}, {1, 1}, {1, 0}}), {}).ok());
}

TEST(RaiseSolid, NeedsAHeight) {
  Footprint building = Building(kBlock);
  building.height_m = 0.0;
  const auto solid = RaiseSolid(building, {});
  ASSERT_FALSE(solid.ok());
  EXPECT_THAT(solid.error().message, HasSubstr("height"));
}

TEST(IsClosedManifold, RejectsAHoleAndATurnedFace) {
  Mesh mesh = RaiseSolid(Building(kBlock), {}).value().mesh;
  Mesh turned = mesh;
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_FALSE(IsClosedManifold(turned));
  mesh.triangles.pop_back();
  EXPECT_FALSE(IsClosedManifold(mesh));
  EXPECT_FALSE(IsClosedManifold({}));
}

}  // namespace
}  // namespace soffit
