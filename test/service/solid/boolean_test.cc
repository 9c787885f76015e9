#include "service/solid/boolean.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <memory>
#include <random>

namespace soffit {
namespace {

/// In a plan turned by 40 degrees, so that no coordinate is shared by chance.
const Eigen::Vector3d kAlong(std::cos(0.7), std::sin(0.7), 0);
const Eigen::Vector3d kCorner_m(2.7, 1.3, 0);
const Eigen::Vector3d kAcross(-std::sin(0.7), std::cos(0.7), 0);

Prism Block(double width_m, double depth_m, double height_m) {
  Prism block;
  block.ring = {{0, 0}, {width_m, 0}, {width_m, depth_m}, {0, depth_m}};
  block.origin_m = kCorner_m;
  block.x_axis = kAlong;
  block.y_axis = kAcross;
  block.sweep_m = {0, 0, height_m};
  return block;
}

Prism Passage(double left_m, double right_m, double height_m, double depth_m) {
  Prism passage;
  passage.ring = {{left_m, -0.5}, {right_m, -0.5}, {right_m, height_m}, {left_m, height_m}};
  passage.origin_m = kCorner_m - 0.3 * kAcross;
  passage.x_axis = kAlong;
  passage.y_axis = Eigen::Vector3d::UnitZ();
  passage.sweep_m = (depth_m + 0.6) * kAcross;
  return passage;
}

TEST(Subtract, GivesTheSameOrderWhereverItsWorkLiesInMemory) {
  const Prism body = Block(6, 2, 4);
  const std::vector<Tube> passages = {Passage(0.73, 2.21, 1.9, 2), Passage(3.17, 5.05, 2.3, 2)};
  const auto first = Subtract(body, passages);
  ASSERT_TRUE(first.ok()) << first.error().message;

  std::mt19937 random(5);
  std::vector<std::unique_ptr<char[]>> in_the_way;
  for (int run = 0; run < 40; ++run) {
    for (int i = 0; i < 2000; ++i) {
      in_the_way.push_back(std::make_unique<char[]>(16 + random() % 600));
      if (random() % 3 != 0) in_the_way[random() % in_the_way.size()].reset();
    }
    const auto again = std::async(std::launch::async, [&] { return Subtract(body, passages); }).get();
    ASSERT_TRUE(again.ok());
    ASSERT_EQ(again.value().triangles, first.value().triangles) << "run " << run;
    ASSERT_EQ(again.value().vertices_in_map_m, first.value().vertices_in_map_m) << "run " << run;
  }
}

TEST(Subtract, RefusesNumbersThatAreNotFinite) {
  Prism passage = Passage(0.7, 2.2, 1.9, 2);
  passage.ring[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Subtract(Block(6, 2, 4), {passage}).ok());
}

TEST(IsSound, TellsATubeThatCrossesItself) {
  const Tube straight = Passage(0.7, 2.2, 1.9, 2);
  EXPECT_TRUE(IsSound(straight));
  Tube crossed = straight;
  std::reverse(crossed.rings_m.back().begin(), crossed.rings_m.back().end());
  EXPECT_FALSE(IsSound(crossed));
}

}  // namespace
}  // namespace soffit
