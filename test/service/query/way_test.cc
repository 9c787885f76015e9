#include "service/query/way.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/support/arch_scene.h"

namespace soffit {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr VehicleEnvelope kVehicle{0.2, 0.2, 0.1};
constexpr double kMaxCells = 1e6;
const IsLate kNever = [] { return false; };

/// Free around the arch from the ground to 4 m, and occupied where its model is.
Scene Yard() {
  Scene scene = test::ArchUnderstanding().scene;
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  for (double x = -2.95; x < 7.0; x += 0.1) {
    for (double y = -3.95; y < 5.0; y += 0.1) {
      for (double z = 0.05; z < 4.0; z += 0.1) {
        const bool is_in_box = x > 0 && x < 4 && y > 0 && y < 1.5 && z < 2.3;
        const bool is_in_passage = x > 1.2 && x < 2.8 && z < 1.4;
        tree->updateNode(
            octomap::point3d(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)),
            is_in_box && !is_in_passage, true);
      }
    }
  }
  tree->updateInnerOccupancy();
  tree->prune();
  scene.octree = tree;
  return scene;
}

void Forget(Scene& scene, double y) {
  auto tree = std::make_shared<octomap::OcTree>(*scene.octree);
  for (double x = -2.95; x < 7.0; x += 0.1) {
    for (double z = 0.05; z < 4.0; z += 0.1) tree->deleteNode(x, y, z);
  }
  scene.octree = tree;
}

TEST(CheckWay, IsClearThroughThePassageAndBlockedThroughTheWall) {
  const Scene scene = Yard();
  EXPECT_EQ(CheckWay(scene, {{2.0, -1.0, 0.7}, {2.0, 3.0, 0.7}}, kVehicle, kNever).verdict, Verdict::kClear);
  const Way wall = CheckWay(scene, {{0.6, -1.0, 0.7}, {0.6, 3.0, 0.7}}, kVehicle, kNever);
  EXPECT_EQ(wall.verdict, Verdict::kBlocked);
  EXPECT_THAT(wall.reason, HasSubstr("building 1"));
  EXPECT_THAT(wall.in_the_way, Not(IsEmpty()));
}

TEST(CheckWay, DependsOnTheVehicle) {
  const std::vector<Eigen::Vector3d> way = {{2.0, -1.0, 0.7}, {2.0, 3.0, 0.7}};
  EXPECT_EQ(CheckWay(Yard(), way, {0.6, 0.3, 0.15}, kNever).verdict, Verdict::kClear);
  EXPECT_EQ(CheckWay(Yard(), way, {0.7, 0.3, 0.15}, kNever).verdict, Verdict::kBlocked);
}

TEST(CheckWay, IsNotClearWhereOneLayerWasNotSeen) {
  Scene scene = Yard();
  Forget(scene, 2.55);
  const Way way = CheckWay(scene, {{2.0, -1.0, 0.7}, {2.0, 3.0, 0.7}}, kVehicle, kNever);
  EXPECT_EQ(way.verdict, Verdict::kInsufficientData);
  ASSERT_THAT(way.in_the_way, Not(IsEmpty()));
  for (const Cell& cell : way.in_the_way) EXPECT_EQ(cell.occupancy, Occupancy::kUnknown);
}

TEST(CheckWay, TakesTheWordOfTheModelWhereTheMapSaysFree) {
  Scene scene = Yard();
  auto tree = std::make_shared<octomap::OcTree>(*scene.octree);
  for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf) leaf->setLogOdds(-1.0F);
  scene.octree = tree;
  EXPECT_EQ(CheckWay(scene, {{0.6, -1.0, 0.7}, {0.6, 3.0, 0.7}}, kVehicle, kNever).verdict,
            Verdict::kBlocked);
}

TEST(FindWay, GoesAroundTheBuilding) {
  const Way way = FindWay(Yard(), {0.6, -1.0, 0.7}, {0.6, 3.0, 0.7}, kVehicle, kMaxCells, kNever);
  ASSERT_EQ(way.verdict, Verdict::kClear) << way.reason;
  EXPECT_GT(way.points_in_map_m.size(), 2u);
  EXPECT_GT(way.length_m, 4.0);
  EXPECT_LT(way.length_m, 6.5);
  EXPECT_TRUE(way.points_in_map_m.back().isApprox(Eigen::Vector3d(0.6, 3.0, 0.7)));
}

TEST(FindWay, IsTheStraightLineWhereThatIsFree) {
  EXPECT_THAT(FindWay(Yard(), {2, -1, 0.7}, {2, 3, 0.7}, kVehicle, kMaxCells, kNever).points_in_map_m,
              SizeIs(2));
}

TEST(FindWay, NamesTheUnknownCellsThatCutItOff) {
  Scene scene = Yard();
  Forget(scene, 2.55);
  const Way way = FindWay(scene, {0.6, -1.0, 0.7}, {0.6, 3.0, 0.7}, kVehicle, kMaxCells, kNever);
  EXPECT_EQ(way.verdict, Verdict::kInsufficientData) << way.reason;
  EXPECT_THAT(way.points_in_map_m, IsEmpty());
  EXPECT_THAT(way.in_the_way, Not(IsEmpty()));
}

TEST(FindWay, GivesUpWhenThereIsNoTimeAndNeverSaysClear) {
  const Way way =
      FindWay(Yard(), {0.6, -1.0, 0.7}, {0.6, 3.0, 0.7}, kVehicle, kMaxCells, [] { return true; });
  EXPECT_EQ(way.verdict, Verdict::kInsufficientData);
}

TEST(FindWay, BoundsItsWorkForFarEnds) {
  const Way way = FindWay(Yard(), {2, -1, 0.7}, {5000, 3000, 0.7}, kVehicle, 1e5, kNever);
  EXPECT_EQ(way.verdict, Verdict::kInsufficientData);
}

}  // namespace
}  // namespace soffit
