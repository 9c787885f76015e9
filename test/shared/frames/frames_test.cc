#include "shared/frames/frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace soffit {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

TEST(CameraAttitude, LooksAlongTheYawWhenLevel) {
  const Eigen::Quaterniond north = CameraAttitude(kHalfTurn / 2, 0.0);
  EXPECT_LT((north * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((north * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((north * Eigen::Vector3d::UnitY() + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(CameraAttitude, HasTheHeadingAtThePicturesTopWhenItLooksStraightDown) {
  const Eigen::Quaterniond down = CameraAttitude(0.3, -kHalfTurn / 2);
  EXPECT_LT((down * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  const Eigen::Vector3d heading(std::cos(0.3), std::sin(0.3), 0.0);
  EXPECT_LT((down * -Eigen::Vector3d::UnitY() - heading).norm(), 1e-12);
}

TEST(Pose, UndoesItselfWithItsInverse) {
  const Pose<Map, Camera> pose{CameraAttitude(1.0, -0.4), {3, -2, 7}};
  const Point<Map> point{{-1, 5, 2}};
  EXPECT_LT(((pose * (pose.Inverse() * point)).xyz_m - point.xyz_m).norm(), 1e-12);
  const Pose<Map, Map> identity = pose * pose.Inverse();
  EXPECT_LT(identity.translation_m.norm(), 1e-12);
}

}  // namespace
}  // namespace soffit
