#include "service/query/surface.h"

#include <gtest/gtest.h>

#include <limits>

#include "test/support/arch_scene.h"

namespace soffit {
namespace {

constexpr double kForever_m = std::numeric_limits<double>::infinity();

TEST(DistanceToModels, IsNegativeInsideAndPositiveInThePassage) {
  const Scene scene = test::ArchUnderstanding().scene;
  const auto inside = DistanceToModels(scene, {0.6, 0.75, 1.0}, kForever_m);
  ASSERT_TRUE(inside.has_value());
  EXPECT_NEAR(inside->signed_m, -0.6, 1e-9);
  EXPECT_EQ(inside->object_id, 1u);
  const auto passage = DistanceToModels(scene, {2.0, 0.75, 1.0}, kForever_m);
  EXPECT_NEAR(passage->signed_m, 0.4, 1e-9) << "to the soffit";
  EXPECT_TRUE(passage->point_in_map_m.isApprox(Eigen::Vector3d(2.0, 0.75, 1.4)));
  EXPECT_NEAR(DistanceToModels(scene, {-3, -4, 2.3}, kForever_m)->signed_m, 5.0, 1e-9) << "to a corner";
}

TEST(DistanceToModels, HasNoneBeyondTheRange) {
  EXPECT_FALSE(DistanceToModels(test::ArchUnderstanding().scene, {100, 0, 0}, 50.0).has_value());
  EXPECT_FALSE(DistanceToModels(Scene{}, {0, 0, 0}, kForever_m).has_value());
}

TEST(ModelHeightAt, IsThatOfTheRoof) {
  const Scene scene = test::ArchUnderstanding().scene;
  EXPECT_NEAR(ModelHeightAt(scene, {2.0, 0.75}).value(), 2.3, 1e-9);
  EXPECT_FALSE(ModelHeightAt(scene, {9.0, 9.0}).has_value());
}

}  // namespace
}  // namespace soffit
