#include "service/footprint/massing.h"

#include <gtest/gtest.h>

namespace soffit {
namespace {

const Ring kBox = {{0, 0}, {4, 0}, {4, 2}, {0, 2}};

Massing Mansard() {
  return {{kBox, {{1, 0.5}, {1, 1.5}, {2, 1.5}, {2, 0.5}}},
          {{2.0, {0, 0, 0, 0}}, {3.0, {0.3, 0.2, 0.3, 0}}},
          {{false, false, false, false}, {true, true, true, false}}};
}

TEST(Changed, KeepsABuildingStanding) {
  const Massing massing = Mansard();
  const Layout layout(massing);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(layout.size);
  change(layout.roof_height) = -5.0;
  change.tail<3>() << 5.0, -1.0, 5.0;
  const Massing changed = Changed(massing, change);
  EXPECT_GT(changed.levels[1].height_m, changed.levels[0].height_m);
  EXPECT_EQ(changed.levels[1].inset_m[1], 0.0);
  EXPECT_NEAR(changed.levels[1].inset_m[0] + changed.levels[1].inset_m[2], 2.0, 1e-9);  // A ridge.
}

TEST(Layout, CountsALedgeAsOneHeight) {
  Massing tower = Upright({kBox, {}}, 2.0);
  tower.levels = {{1.0, {0, 0, 0, 0}}, {1.0, {0.5, 0, 0, 0}}, {2.0, {0.5, 0, 0, 0}}};
  tower.is_free = {{false, false, false, false}, {true, false, false, false}, {false, false, false, false}};
  const Layout layout(tower);
  EXPECT_EQ(layout.height[0], layout.height[1]);
  EXPECT_EQ(layout.inset[2], layout.inset[1]);
  EXPECT_EQ(layout.size, 8 + 2 + 1);
}

}  // namespace
}  // namespace soffit
