#include "service/scene/octree.h"

#include <algorithm>
#include <optional>

namespace soffit {
namespace {

using octomap::OcTree;
using octomap::OcTreeNode;

constexpr int kZero = 1 << 15;  // OctoMap's key of coordinate 0.
constexpr int kEdge = 1 << 16;  // Of the root, in voxels.

/// Else OctoMap makes a root with the first voxel only.
class RootedTree : public OcTree {
 public:
  explicit RootedTree(double voxel_m) : OcTree(voxel_m) {
    root = new OcTreeNode();
    tree_size = 1;
  }
};

class Planter {
 public:
  explicit Planter(const Voxels& voxels)
      : voxels_(voxels),
        tree_(std::make_shared<RootedTree>(voxels.grid.voxel_m)),
        log_odds_{0.0F, tree_->getClampingThresMinLog(), tree_->getClampingThresMaxLog(),
                  tree_->getClampingThresMaxLog(), 0.0F} {}

  std::shared_ptr<const OcTree> Plant() {
    const std::array<int, 3>& first = voxels_.grid.first;
    Grow(tree_->getRoot(), {-kZero - first[0], -kZero - first[1], -kZero - first[2]}, kEdge);
    return tree_;
  }

 private:
  float LogOdds(Voxel state) const { return log_odds_[static_cast<std::size_t>(state)]; }

  /// The value that all voxels of the cube have, 0 when all are unknown; none when they differ. Beyond the
  /// grid all is unknown.
  std::optional<float> Alike(const Index& low, int edge) const {
    const std::array<int, 3>& count = voxels_.grid.count;
    Index from, to;
    bool is_within = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      from[axis] = std::max(low[axis], 0);
      to[axis] = std::min(low[axis] + edge, count[axis]);
      if (from[axis] >= to[axis]) return 0.0F;
      is_within = is_within && to[axis] - from[axis] == edge;
    }
    const float value =
        is_within ? LogOdds(voxels_.states[voxels_.grid.Number(from[0], from[1], from[2])]) : 0.0F;
    for (int x = from[0]; x < to[0]; ++x) {
      for (int y = from[1]; y < to[1]; ++y) {
        const Voxel* column = &voxels_.states[voxels_.grid.Number(x, y, from[2])];
        const bool is_alike = std::all_of(column, column + (to[2] - from[2]),
                                          [&](Voxel state) { return LogOdds(state) == value; });
        if (!is_alike) return std::nullopt;
      }
    }
    return value;
  }

  /// Gives a node, whose voxels differ, its children.
  void Grow(OcTreeNode* node, const Index& low, int edge) {
    const int half = edge / 2;
    for (int part = 0; part < 8; ++part) {
      const Index at = {low[0] + part % 2 * half, low[1] + part / 2 % 2 * half, low[2] + part / 4 * half};
      const std::optional<float> value = Alike(at, half);
      if (value == 0.0F) continue;
      OcTreeNode* child = tree_->createNodeChild(node, static_cast<unsigned int>(part));
      if (value) {
        child->setLogOdds(*value);
      } else {
        Grow(child, at, half);
      }
    }
    node->updateOccupancyChildren();
  }

  const Voxels& voxels_;
  std::shared_ptr<OcTree> tree_;
  std::array<float, 5> log_odds_;  ///< By Voxel.
};

}  // namespace

std::shared_ptr<const OcTree> PlantTree(const Voxels& voxels) {
  const bool is_empty = std::all_of(voxels.states.begin(), voxels.states.end(), [](Voxel state) {
    return state == Voxel::kUnknown || state == Voxel::kLine;
  });
  if (is_empty) return std::make_shared<OcTree>(voxels.grid.voxel_m);
  return Planter(voxels).Plant();
}

}  // namespace soffit
