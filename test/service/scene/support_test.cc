#include "service/scene/support.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace soffit {
namespace {

Voxels AllFree() {
  Grid grid;
  grid.voxel_m = 0.1;
  grid.count = {7, 8, 9};
  Voxels voxels(grid);
  std::fill(voxels.states.begin(), voxels.states.end(), Voxel::kFree);
  return voxels;
}

TEST(FreeUnsupported, FreesASpeckInTheAir) {
  Voxels voxels = AllFree();
  voxels.At({3, 3, 4}) = voxels.At({4, 4, 5}) = Voxel::kUnknown;
  FreeUnsupported(voxels);
  EXPECT_EQ(voxels.At({3, 3, 4}), Voxel::kFree);
  EXPECT_EQ(voxels.At({4, 4, 5}), Voxel::kFree);
}

TEST(FreeUnsupported, KeepsWhatMayStandHangOrLean) {
  for (const auto& [far, what] : {std::pair(Index{3, 3, 0}, Voxel::kUnknown),  // On the ground.
                                  std::pair(Index{3, 3, 8}, Voxel::kUnknown),  // From above.
                                  std::pair(Index{0, 3, 4}, Voxel::kUnknown),  // From outside of the grid.
                                  std::pair(Index{3, 7, 4}, Voxel::kUnknown),
                                  std::pair(Index{5, 5, 6}, Voxel::kSolid),  // On the model.
                                  std::pair(Index{5, 5, 6}, Voxel::kThing),  // On a thing.
                                  std::pair(Index{3, 3, 5}, Voxel::kLine)}) {
    Voxels voxels = AllFree();
    Index at = {3, 3, 4};
    voxels.At(at) = Voxel::kUnknown;
    while (at != far) {  // A thin chain, over corners, up to what holds it.
      for (std::size_t axis = 0; axis < 3; ++axis)
        at[axis] += (far[axis] > at[axis]) - (far[axis] < at[axis]);
      voxels.At(at) = Voxel::kUnknown;
    }
    voxels.At(far) = what;
    FreeUnsupported(voxels);
    EXPECT_EQ(voxels.At({3, 3, 4}), Voxel::kUnknown);
    EXPECT_EQ(voxels.At(far), what);
  }
}

TEST(FreeUnsupported, JoinsAroundAColumn) {
  Voxels voxels = AllFree();
  for (int z = 2; z < 7; ++z) voxels.At({3, 3, z}) = Voxel::kUnknown;
  voxels.At({3, 4, 2}) = voxels.At({3, 5, 2}) = voxels.At({3, 5, 1}) = voxels.At({3, 5, 0}) = Voxel::kUnknown;
  FreeUnsupported(voxels);
  EXPECT_EQ(voxels.At({3, 3, 6}), Voxel::kUnknown);
}

TEST(FreeUnsupported, TakesAnEmptyGrid) {
  Voxels voxels{Grid{}};
  FreeUnsupported(voxels);
  EXPECT_TRUE(voxels.states.empty());
}

}  // namespace
}  // namespace soffit
