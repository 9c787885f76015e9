#include "service/solid/solid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace soffit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Footprint Building(const Ring& ring) {
  Footprint footprint;
  footprint.object_id = 1;
  footprint.polygon_in_map_m.outer = ring;
  footprint.height_m = 2.0;
  return footprint;
}

const Ring kBlock = {{0, 0}, {4, 0}, {4, 1.5}, {0, 1.5}};

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

TEST(RaiseSolid, KeepsTheCommonPartOfMouthsThatAgree) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}})};
  facades[2].openings = {Through({{1.42, 0}, {2.98, 0}, {2.98, 1.48}, {1.42, 1.48}})};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok());
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.56 * 1.48 * 1.5, 1e-6);
}

TEST(RaiseSolid, TakesTheLargerOfMouthsThatDifferForSomethingBeyondHidesTheOther) {
  auto facades = Closed(4);
  facades[0].openings = {Through({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}})};
  facades[2].openings = {Through({{2, 0}, {3, 0}, {3, 1.5}, {2, 1.5}})};
  const auto solid = RaiseSolid(Building(kBlock), facades);
  ASSERT_TRUE(solid.ok());
  EXPECT_NEAR(solid.value().volume_m3, 12.0 - 1.6 * 1.5 * 1.5, 1e-6);
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
