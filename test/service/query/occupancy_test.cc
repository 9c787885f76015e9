#include "service/query/occupancy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace soffit {
namespace {

using testing::SizeIs;

constexpr double kVoxel_m = 0.1;
constexpr double kForever_m = std::numeric_limits<double>::infinity();
const IsLate kNever = [] { return false; };

octomap::point3d At(double x, double y, double z) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

/// Free from 0 to 2 m on all axes, but for a wall at x = 1.5 that is occupied, and a hole of unknown about
/// (1, 1, 1).
octomap::OcTree Room() {
  octomap::OcTree tree(kVoxel_m);
  for (double x = 0.05; x < 2.0; x += kVoxel_m) {
    for (double y = 0.05; y < 2.0; y += kVoxel_m) {
      for (double z = 0.05; z < 2.0; z += kVoxel_m) {
        const bool is_hole =
            std::abs(x - 1.05) < 0.05 && std::abs(y - 1.05) < 0.05 && std::abs(z - 1.05) < 0.05;
        if (!is_hole) tree.updateNode(At(x, y, z), std::abs(x - 1.55) < 0.05);
      }
    }
  }
  tree.prune();
  return tree;
}

TEST(CellAt, TellsFreeOccupiedAndUnknownApart) {
  const auto tree = Room();
  EXPECT_EQ(CellAt(tree, {0.55, 0.55, 0.55}, 0.0).occupancy, Occupancy::kFree);
  EXPECT_EQ(CellAt(tree, {1.55, 0.55, 0.55}, 0.0).occupancy, Occupancy::kOccupied);
  EXPECT_EQ(CellAt(tree, {1.05, 1.05, 1.05}, 0.0).occupancy, Occupancy::kUnknown);
  EXPECT_EQ(CellAt(tree, {-0.05, 0.55, 0.55}, 0.0).occupancy, Occupancy::kUnknown);
  EXPECT_EQ(CellAt(tree, {1e9, 0, 0}, 0.0).occupancy, Occupancy::kUnknown);
}

TEST(CellAt, GivesTheWorstOfACoarserCell) {
  const auto tree = Room();
  const Cell cell = CellAt(tree, {1.25, 1.25, 1.25}, 0.3);
  EXPECT_NEAR(cell.size_m, 0.4, 1e-9);
  EXPECT_TRUE(cell.center_in_map_m.isApprox(Eigen::Vector3d(1.4, 1.4, 1.4))) << cell.center_in_map_m;
  EXPECT_EQ(cell.occupancy, Occupancy::kOccupied);
  EXPECT_EQ(CellAt(tree, {1.05, 1.05, 1.05}, 0.3).occupancy, Occupancy::kUnknown);
  EXPECT_EQ(CellAt(tree, {0.1, 0.1, 0.1}, 0.3).occupancy, Occupancy::kFree);
}

TEST(CellAt, AgreesWithOctoMapEverywhere) {
  const auto tree = Room();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-0.3, 2.3);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p(place(random), place(random), place(random));
    const auto* node = tree.search(p.x(), p.y(), p.z());
    const Occupancy truth = node == nullptr             ? Occupancy::kUnknown
                            : tree.isNodeOccupied(node) ? Occupancy::kOccupied
                                                        : Occupancy::kFree;
    ASSERT_EQ(CellAt(tree, p, 0.0).occupancy, truth) << p.transpose();
  }
}

TEST(SharesOf, CountsPartsOfCells) {
  const auto tree = Room();
  const Shares shares = SharesOf(tree, {Eigen::Vector3d(1.35, 0.0, 0.0), Eigen::Vector3d(1.55, 0.5, 0.5)});
  EXPECT_NEAR(shares.free_ratio, 0.75, 1e-6);
  EXPECT_NEAR(shares.occupied_ratio, 0.25, 1e-6);
  EXPECT_EQ(shares.unknown_ratio, 0.0);
  EXPECT_EQ(shares.Worst(), Occupancy::kOccupied);
}

TEST(SharesOf, ABoxLargerThanTheMapIsMostlyUnknown) {
  const Shares shares = SharesOf(Room(), {Eigen::Vector3d(-1e6, -1e6, -1e6), Eigen::Vector3d(1e6, 1e6, 1e6)});
  EXPECT_GT(shares.unknown_ratio, 0.999);
  EXPECT_EQ(SharesOf(octomap::OcTree(0.1), {Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()}).unknown_ratio,
            1.0);
}

TEST(GridOf, FillsTheBoxFromItsLowestCornerOn) {
  const CellGrid grid = GridOf(Room(), {Eigen::Vector3d(1.2, 0, 0), Eigen::Vector3d(2.2, 0.5, 0.25)}, 0.25);
  EXPECT_EQ(grid.size, Eigen::Vector3i(4, 2, 1));
  const auto at = [&](int x) { return static_cast<Occupancy>(grid.occupancy[grid.Index({x, 0, 0})]); };
  EXPECT_EQ(at(0), Occupancy::kFree);
  EXPECT_EQ(at(1), Occupancy::kOccupied);
  EXPECT_EQ(at(2), Occupancy::kFree);
  EXPECT_EQ(at(3), Occupancy::kUnknown);
}

TEST(CountCells, OfAnAbsurdBoxIsNotSmall) {
  EXPECT_GT(CountCells({Eigen::Vector3d(-1e300, -1e300, -1e300), Eigen::Vector3d(1e300, 1e300, 1e300)}, 0.01),
            1e30);
}

TEST(CastRay, TellsHitFreeUnknownAndOutOfRangeApart) {
  const auto tree = Room();
  const Eigen::Vector3d from(0.55, 0.55, 0.55);
  const Ray hit = CastRay(tree, from, Eigen::Vector3d::UnitX(), kForever_m);
  EXPECT_EQ(hit.end, RayEnd::kHit);
  EXPECT_NEAR(hit.distance_m, 0.95, 1e-5);
  EXPECT_NEAR(hit.cell.center_in_map_m.x(), 1.55, 1e-5);
  const Ray free = CastRay(tree, from, Eigen::Vector3d::UnitX(), 0.5);
  EXPECT_EQ(free.end, RayEnd::kFree);
  EXPECT_EQ(free.distance_m, 0.5);
  const Ray unknown = CastRay(tree, from, Eigen::Vector3d(1, 1, 1).normalized(), kForever_m);
  EXPECT_EQ(unknown.end, RayEnd::kUnknown);
  EXPECT_NEAR(unknown.distance_m, 0.45 * std::sqrt(3.0), 1e-5);
  const Ray out = CastRay(tree, from, -Eigen::Vector3d::UnitY(), kForever_m);
  EXPECT_EQ(out.end, RayEnd::kOutOfRange);
  EXPECT_NEAR(out.distance_m, 0.55, 1e-5);
}

TEST(CastRay, NeverTakesTheUnknownForFree) {
  EXPECT_EQ(CastRay(Room(), {5, 5, 5}, Eigen::Vector3d::UnitX(), 1.0).end, RayEnd::kOutOfRange);
  EXPECT_EQ(CastRay(octomap::OcTree(0.1), {0, 0, 0}, Eigen::Vector3d::UnitX(), 1.0).end, RayEnd::kOutOfRange);
  // Along a side that cells share, and from a corner of the map.
  EXPECT_EQ(CastRay(Room(), {1.0, 1.0, 0.5}, Eigen::Vector3d::UnitZ(), kForever_m).end, RayEnd::kUnknown);
  EXPECT_EQ(CastRay(Room(), {0, 0, 0}, -Eigen::Vector3d::UnitZ(), 1.0).end, RayEnd::kOutOfRange);
}

TEST(FindNearest, FindsTheNearestOfEach) {
  const auto tree = Room();
  const auto occupied = FindNearest(tree, {1.05, 0.55, 0.55}, Occupancy::kOccupied, kForever_m, kNever);
  ASSERT_TRUE(occupied.has_value());
  EXPECT_NEAR(occupied->distance_m, 0.45, 1e-5);
  EXPECT_TRUE(occupied->point_in_map_m.isApprox(Eigen::Vector3d(1.5, 0.55, 0.55), 1e-5));
  const auto unknown = FindNearest(tree, {1.05, 1.05, 1.25}, Occupancy::kUnknown, kForever_m, kNever);
  ASSERT_TRUE(unknown.has_value());
  EXPECT_NEAR(unknown->distance_m, 0.15, 1e-5);
  EXPECT_FALSE(FindNearest(tree, {0.05, 0.55, 0.55}, Occupancy::kOccupied, 0.5, kNever).has_value());
  EXPECT_FALSE(
      FindNearest(tree, {0.05, 0.5, 0.5}, Occupancy::kOccupied, kForever_m, [] { return true; }).has_value());
}

TEST(LayersAt, ListsWhatIsAboveEachOther) {
  const auto layers = LayersAt(Room(), {1.05, 1.05});
  ASSERT_THAT(layers, SizeIs(3));
  EXPECT_EQ(layers[1].occupancy, Occupancy::kUnknown);
  EXPECT_NEAR(layers[1].bottom_m, 1.0, 1e-5);
  EXPECT_NEAR(layers[1].top_m, 1.1, 1e-5);
  EXPECT_NEAR(layers[2].top_m, 2.0, 1e-5);
  EXPECT_THAT(LayersAt(Room(), {5.0, 5.0}), SizeIs(0));
}

TEST(CompareOctrees, FindsExactlyWhatChanged) {
  const auto before = Room();
  auto after = Room();
  after.deleteNode(At(0.55, 0.55, 0.55));
  for (int i = 0; i < 10; ++i) after.updateNode(At(0.25, 0.25, 0.25), true);
  const CellChanges changes = CompareOctrees(before, after, 100);
  EXPECT_EQ(changes.count, 2u);
  ASSERT_THAT(changes.cells, SizeIs(2));
  EXPECT_EQ(changes.cells[0].occupancy, Occupancy::kOccupied);
  EXPECT_EQ(changes.cells[1].occupancy, Occupancy::kUnknown);
  EXPECT_TRUE(
      changes.box_in_map_m.isApprox({Eigen::Vector3d::Constant(0.2), Eigen::Vector3d::Constant(0.6)}, 1e-5));
  EXPECT_EQ(CompareOctrees(before, before, 100).count, 0u);
  EXPECT_TRUE(CompareOctrees(before, after, 1).has_more);
}

}  // namespace
}  // namespace soffit
