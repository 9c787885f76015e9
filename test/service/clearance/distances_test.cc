#include "service/clearance/distances.h"

#include <gtest/gtest.h>

#include <cmath>

#include "test/support/arch_scene.h"

namespace soffit {
namespace {

const VehicleEnvelope kVehicle{0.35, 0.30, 0.25};

/// The arch of test/support, its model alone, with everything free about it.
Scene FreeArch() {
  Scene scene;
  scene.solids = test::ArchUnderstanding().scene.solids;
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  for (double x = -1.95; x < 6.0; x += 0.1) {
    for (double y = -3.95; y < 6.0; y += 0.1) {
      for (double z = 0.05; z < 3.0; z += 0.1) tree->setNodeValue(x, y, z, -2.0F, true);
    }
  }
  tree->updateInnerOccupancy();
  scene.octree = tree;
  return scene;
}

void Set(Scene& scene, const Eigen::Vector3d& at, float value) {
  auto tree = std::make_shared<octomap::OcTree>(*scene.octree);
  tree->expand();
  if (value == 0.0F) {
    tree->deleteNode(at.x(), at.y(), at.z());
  } else {
    tree->setNodeValue(at.x(), at.y(), at.z(), value);
  }
  scene.octree = tree;
}

const std::vector<Eigen::Vector3d> kThrough = {{2.0, -1.6, 0.6}, {2.0, 3.1, 0.6}};

TEST(MeasureDistances, GivesThatToTheNearerJamb) {
  const Distances distances =
      MeasureDistances(FreeArch(), {{1.9, -1.6, 0.6}, {1.9, 3.1, 0.6}}, kVehicle, 1.0);
  EXPECT_NEAR(distances.to_surface_m, 0.35, 2e-3);  // The jamb is at 1.2.
  EXPECT_EQ(distances.to_occupied_m, 1.0);
  EXPECT_EQ(distances.to_unknown_m, 1.0);
}

TEST(MeasureDistances, TakesWhatIsBeyondTheMapForUnknown) {
  const Distances distances = MeasureDistances(FreeArch(), {{5.0, 0.0, 1.5}, {5.0, 1.0, 1.5}}, kVehicle, 1.0);
  EXPECT_NEAR(distances.to_unknown_m, 0.65, 0.025);  // The map ends at 6.
}

TEST(MeasureDistances, AreNoneForAVehicleThatIsLargerThanTheMap) {
  const Distances distances = MeasureDistances(FreeArch(), kThrough, {1e6, 1e6, 0.0}, 1.0);
  EXPECT_EQ(distances.to_unknown_m, 0.0);
  EXPECT_EQ(distances.to_surface_m, 0.0);
}

TEST(MeasureDistances, TellsOccupiedFromUnknown) {
  Scene scene = FreeArch();
  Set(scene, {2.75, -0.55, 0.65}, 2.0F);  // From 2.7 on: 0.7 aside.
  Set(scene, {1.35, 2.35, 0.55}, 0.0F);   // To 1.4: 0.6 aside.
  const Distances distances = MeasureDistances(scene, kThrough, kVehicle, 1.0);
  EXPECT_NEAR(distances.to_occupied_m, 0.35, 0.025);
  EXPECT_NEAR(distances.to_unknown_m, 0.25, 0.025);
  EXPECT_LE(distances.to_occupied_m, 0.35 + 1e-9);
  EXPECT_LE(distances.to_unknown_m, 0.25 + 1e-9);
}

TEST(MeasureDistances, IsZeroForWhatIsTouched) {
  const Distances distances =
      MeasureDistances(FreeArch(), {{0.5, -1.6, 0.6}, {0.5, 3.1, 0.6}}, kVehicle, 1.0);
  EXPECT_EQ(distances.to_surface_m, 0.0);
}

TEST(MeasureDistances, FollowsABend) {
  Scene scene = FreeArch();
  Set(scene, {5.05, -0.55, 0.65}, 2.0F);
  EXPECT_EQ(MeasureDistances(scene, kThrough, kVehicle, 1.0).to_occupied_m, 1.0);
  const std::vector<Eigen::Vector3d> around = {{2.0, -1.6, 0.6}, {5.0, -1.6, 0.6}, {5.0, 3.1, 0.6}};
  EXPECT_EQ(MeasureDistances(scene, around, kVehicle, 1.0).to_occupied_m, 0.0);
}

}  // namespace
}  // namespace soffit
