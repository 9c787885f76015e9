#include "service/edge/files/move_map.h"

#include <gtest/gtest.h>

#include "test/support/arch_scene.h"

namespace soffit {
namespace {

const Eigen::Vector3d kFar(691000.0, 5335000.0, 510.0);

TEST(MoveMap, MovesAllOfACorridorAndItsPassage) {
  Analysis analysis{{}, test::ArchUnderstanding()};
  Understanding& all = analysis.understanding;
  all.scene.solids.at(0).passages = {{}};
  all.scene.solids.at(0).passages[0].sections_in_map_m = {{{1, 2, 3}}, {{4, 5, 6}}};
  all.decisions.at(0).corridor->bends_in_map_m = {{7, 8, 9}};
  const std::vector<Eigen::Vector3d> path = all.decisions[0].corridor->Path();

  const Understanding moved = MoveMap(analysis, kFar).understanding;
  EXPECT_EQ(moved.scene.solids[0].passages[0].sections_in_map_m[1][0], kFar + Eigen::Vector3d(4, 5, 6));
  const std::vector<Eigen::Vector3d> moved_path = moved.decisions[0].corridor->Path();
  ASSERT_EQ(moved_path.size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) EXPECT_EQ(moved_path[i], path[i] + kFar);
}

}  // namespace
}  // namespace soffit
