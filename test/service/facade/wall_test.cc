#include "service/facade/wall.h"

#include <gtest/gtest.h>

namespace soffit {
namespace {

using Eigen::Vector2d;

Footprint Building(const std::vector<Level>& levels) {
  Footprint building;
  building.polygon_in_map_m.outer = {{0, 0}, {4, 0}, {4, 2}, {0, 2}};
  building.height_m = 3.0;
  building.levels = levels;
  return building;
}

TEST(WallOf, LeansAsItsBuildingDoes) {
  const Wall wall = WallOf(Building({{3.0, {0.6, 0, 0, 0}}}), 0);
  EXPECT_LT((wall.InMap({1.0, 2.0}) - Eigen::Vector3d(1.0, 0.4, 2.0)).norm(), 1e-12);
  EXPECT_EQ(WallOf(Building({}), 0).lean, 0.0);
}

TEST(SpanAt, NarrowsUnderAGable) {
  const Footprint gable = Building({{1.0, {0, 0, 0, 0}}, {3.0, {1, 0, 1, 0}}});
  EXPECT_EQ(*SpanAt(gable, 1, 0.5), Vector2d(0.0, 2.0));
  EXPECT_LT((*SpanAt(gable, 1, 2.0) - Vector2d(0.5, 1.5)).norm(), 1e-12);
  EXPECT_FALSE(SpanAt(gable, 1, 3.1).has_value());
}

TEST(SpanAt, EndsWhereTheWallStandsBack) {
  const Footprint tower = Building({{1.0, {0, 0, 0, 0}}, {1.0, {0.5, 0, 0, 0}}, {3.0, {0.5, 0, 0, 0}}});
  EXPECT_TRUE(SpanAt(tower, 0, 0.9).has_value());
  EXPECT_FALSE(SpanAt(tower, 0, 1.1).has_value());
  EXPECT_EQ(*SpanAt(tower, 2, 2.0), Vector2d(0.0, 4.0));
  EXPECT_EQ(*SpanAt(Building({}), 0, 2.0), Vector2d(0.0, 4.0));
}

}  // namespace
}  // namespace soffit
