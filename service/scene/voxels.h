#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace soffit {

/// The space that is mapped: whole voxels, aligned as OctoMap aligns them.
struct Grid {
  double voxel_m = 0.0;
  std::array<int, 3> first{};
  std::array<int, 3> count{};

  Eigen::Vector3d Center(int x, int y, int z) const {
    return {(first[0] + x + 0.5) * voxel_m, (first[1] + y + 0.5) * voxel_m, (first[2] + z + 0.5) * voxel_m};
  }
  std::size_t Size() const { return Count(0) * Count(1) * Count(2); }
  std::size_t Number(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * Count(1) + static_cast<std::size_t>(y)) * Count(2) +
           static_cast<std::size_t>(z);
  }

 private:
  std::size_t Count(std::size_t axis) const { return static_cast<std::size_t>(count[axis]); }
};

/// What is known of a voxel. A thing is something that the model does not have; where a thin line may be is
/// unknown.
enum class Voxel : std::uint8_t { kUnknown, kFree, kSolid, kThing, kLine };
using Index = std::array<int, 3>;

struct Voxels {
  Grid grid;
  std::vector<Voxel> states;

  explicit Voxels(const Grid& laid) : grid(laid), states(laid.Size(), Voxel::kUnknown) {}

  bool Has(const Index& at) const {
    return at[0] >= 0 && at[1] >= 0 && at[2] >= 0 && at[0] < grid.count[0] && at[1] < grid.count[1] &&
           at[2] < grid.count[2];
  }
  Voxel At(const Index& at) const { return states[grid.Number(at[0], at[1], at[2])]; }
  Voxel& At(const Index& at) { return states[grid.Number(at[0], at[1], at[2])]; }
};

/// Calls `visit` for each voxel of the grid, in the order of their numbers.
template <class Visit>
void ForEach(const Grid& grid, Visit&& visit) {
  for (int x = 0; x < grid.count[0]; ++x) {
    for (int y = 0; y < grid.count[1]; ++y) {
      for (int z = 0; z < grid.count[2]; ++z) visit(Index{x, y, z});
    }
  }
}

}  // namespace soffit
