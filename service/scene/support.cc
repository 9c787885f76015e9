#include "service/scene/support.h"

#include <algorithm>
#include <numeric>

namespace soffit {
namespace {

/// Voxels of one column, from `low` up to and not including `high`, none of which is free.
struct Run {
  int low = 0;
  int high = 0;
  bool is_supported = false;
};

/// The runs of all columns, joined into groups (disjoint sets).
class Groups {
 public:
  explicit Groups(const Voxels& voxels) : grid_(voxels.grid) {
    for (int x = 0; x < grid_.count[0]; ++x) {
      for (int y = 0; y < grid_.count[1]; ++y) AddColumn(voxels, x, y);
    }
    parents_.resize(runs_.size());
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
    for (int x = 0; x < grid_.count[0]; ++x) {
      for (int y = 0; y < grid_.count[1]; ++y) {
        Join(x, y, x, y + 1);
        for (int aside = -1; aside <= 1; ++aside) Join(x, y, x + 1, y + aside);
      }
    }
  }

  template <class Visit>
  void ForEachUnsupported(Visit&& visit) {
    for (int x = 0; x < grid_.count[0]; ++x) {
      for (int y = 0; y < grid_.count[1]; ++y) {
        for (std::size_t i = First(x, y); i < First(x, y + 1); ++i) {
          if (!runs_[RootOf(i)].is_supported) visit(x, y, runs_[i]);
        }
      }
    }
  }

 private:
  void AddColumn(const Voxels& voxels, int x, int y) {
    first_.push_back(runs_.size());
    const bool is_outer = x == 0 || y == 0 || x + 1 == grid_.count[0] || y + 1 == grid_.count[1];
    const Voxel* column = &voxels.states[grid_.Number(x, y, 0)];
    for (int z = 0; z < grid_.count[2]; ++z) {
      if (column[z] == Voxel::kFree) continue;
      Run run{z, z, is_outer || z == 0};
      for (; run.high < grid_.count[2] && column[run.high] != Voxel::kFree; ++run.high)
        run.is_supported = run.is_supported || column[run.high] != Voxel::kUnknown;
      run.is_supported = run.is_supported || run.high == grid_.count[2];
      runs_.push_back(run);
      z = run.high;
    }
  }

  std::size_t First(int x, int y) const {
    const std::size_t column =
        static_cast<std::size_t>(x) * static_cast<std::size_t>(grid_.count[1]) + static_cast<std::size_t>(y);
    return column < first_.size() ? first_[column] : runs_.size();
  }

  std::size_t RootOf(std::size_t run) {
    while (parents_[run] != run) run = parents_[run] = parents_[parents_[run]];
    return run;
  }

  /// Joins the runs of two neighbouring columns that touch, by corners too.
  void Join(int x, int y, int other_x, int other_y) {
    if (other_x >= grid_.count[0] || other_y < 0 || other_y >= grid_.count[1]) return;
    std::size_t a = First(x, y);
    std::size_t b = First(other_x, other_y);
    const std::size_t end_a = First(x, y + 1);
    const std::size_t end_b = First(other_x, other_y + 1);
    while (a < end_a && b < end_b) {
      if (runs_[a].low <= runs_[b].high && runs_[b].low <= runs_[a].high) Unite(a, b);
      ++(runs_[a].high < runs_[b].high ? a : b);
    }
  }

  void Unite(std::size_t a, std::size_t b) {
    const std::size_t root_a = RootOf(a);
    const std::size_t root_b = RootOf(b);
    parents_[root_b] = root_a;
    runs_[root_a].is_supported = runs_[root_a].is_supported || runs_[root_b].is_supported;
  }

  const Grid& grid_;
  std::vector<Run> runs_;           ///< Column by column, upward.
  std::vector<std::size_t> first_;  ///< Of each column.
  std::vector<std::size_t> parents_;
};

}  // namespace

void FreeUnsupported(Voxels& voxels) {
  Groups(voxels).ForEachUnsupported([&](int x, int y, const Run& run) {
    for (int z = run.low; z < run.high; ++z) voxels.At({x, y, z}) = Voxel::kFree;
  });
}

}  // namespace soffit
