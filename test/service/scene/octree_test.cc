#include "service/scene/octree.h"

#include <gtest/gtest.h>

#include <random>
#include <sstream>

namespace soffit {
namespace {

Voxels Lay(const std::array<int, 3>& first, const std::array<int, 3>& count) {
  Grid grid;
  grid.voxel_m = 0.25;
  grid.first = first;
  grid.count = count;
  return Voxels(grid);
}

/// As OctoMap itself builds it, voxel by voxel.
octomap::OcTree PlantOneByOne(Voxels voxels) {
  octomap::OcTree tree(voxels.grid.voxel_m);
  ForEach(voxels.grid, [&](const Index& at) {
    const Voxel state = voxels.At(at);
    if (state == Voxel::kUnknown || state == Voxel::kLine) return;
    const Eigen::Vector3d center = voxels.grid.Center(at[0], at[1], at[2]);
    const float log_odds =
        state == Voxel::kFree ? tree.getClampingThresMinLog() : tree.getClampingThresMaxLog();
    tree.setNodeValue(center.x(), center.y(), center.z(), log_odds, true);
  });
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

std::string Bytes(const octomap::OcTree& tree) {
  std::ostringstream bytes;
  tree.write(bytes);
  return bytes.str();
}

TEST(PlantTree, GivesAnEmptyTreeWhenNothingIsKnown) {
  EXPECT_EQ(PlantTree(Lay({0, 0, 0}, {4, 4, 4}))->size(), 0u);
  EXPECT_EQ(PlantTree(Lay({0, 0, 0}, {0, 0, 0}))->size(), 0u);
}

TEST(PlantTree, EqualsWhatOctoMapBuildsVoxelByVoxel) {
  Voxels voxels = Lay({-21, 3, 0}, {45, 37, 22});
  std::mt19937 random(5);
  ForEach(voxels.grid, [&](const Index& at) {
    const bool is_block = at[0] < 30;  // Uniform blocks beside noise.
    voxels.At(at) = is_block ? Voxel::kFree : static_cast<Voxel>(random() % 5);
  });
  const auto tree = PlantTree(voxels);
  const octomap::OcTree other = PlantOneByOne(voxels);
  EXPECT_EQ(tree->size(), other.size());
  EXPECT_EQ(tree->size(), tree->calcNumNodes());
  EXPECT_EQ(Bytes(*tree), Bytes(other));
}

TEST(PlantTree, MergesThingsAndSolidsThatFillABlock) {
  Voxels voxels = Lay({0, 0, 0}, {2, 2, 2});
  ForEach(voxels.grid, [&](const Index& at) { voxels.At(at) = at[0] == 0 ? Voxel::kSolid : Voxel::kThing; });
  EXPECT_EQ(PlantTree(voxels)->getNumLeafNodes(), 1u);
}

}  // namespace
}  // namespace soffit
