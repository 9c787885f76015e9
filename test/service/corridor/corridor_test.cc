#include "service/corridor/corridor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "service/corridor/rectangle.h"

namespace soffit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Ring HalfDisc(double radius) {
  Ring ring;
  for (int i = 0; i <= 48; ++i) {
    const double angle = M_PI * i / 48;
    ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return ring;
}

TEST(FitRectangle, FillsARectangle) {
  const auto fit = FitRectangle({{1, 0}, {3, 0}, {3, 1.5}, {1, 1.5}}, 1.2, 0.8);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->left, 1.0, 1e-6);
  EXPECT_NEAR(fit->right, 3.0, 1e-6);
  EXPECT_NEAR(fit->bottom, 0.0, 1e-6);
  EXPECT_NEAR(fit->top, 1.5, 1e-6);
}

TEST(FitRectangle, FindsTheLargestOfItsShapeInAHalfDisc) {
  // Half the width w / 2 and the height h lie on the circle: k = 1 / |(w / 2, h)|.
  const auto fit = FitRectangle(HalfDisc(1.0), 1.2, 0.8);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->right - fit->left, 1.2, 5e-3);
  EXPECT_NEAR(fit->top - fit->bottom, 0.8, 5e-3);
  EXPECT_NEAR(fit->left + fit->right, 0.0, 5e-3);
}

TEST(FitRectangle, TakesTheRoomBesideABulge) {
  const auto fit = FitRectangle({{0, 0}, {1, 0}, {1.5, 0.6}, {2, 0}, {4, 0}, {4, 1}, {0, 1}}, 1.2, 0.8);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR(fit->left, 2.0, 0.15);
  EXPECT_NEAR(fit->right, 4.0, 1e-6);
}

TEST(FitRectangle, FindsNoneInNothing) {
  EXPECT_FALSE(FitRectangle({}, 1.0, 1.0).has_value());
  EXPECT_FALSE(FitRectangle({{0, 0}, {1, 0}}, 1.0, 1.0).has_value());
  EXPECT_FALSE(FitRectangle({{0, 0}, {0, 1}, {0, 2}}, 1.0, 1.0).has_value());
}

Scene WithPassage(std::vector<Obstacle> obstacles) {
  Solid solid;
  solid.footprint.object_id = 7;
  solid.footprint.polygon_in_map_m.outer = {{0, 0}, {4, 0}, {4, 1.5}, {0, 1.5}};
  Passage passage;
  passage.entry_wall = 0;
  passage.exit_wall = 2;
  passage.length_m = 1.5;
  passage.section_m = {{1, 0}, {3, 0}, {3, 1.5}, {1, 1.5}};
  solid.passages = {passage};
  Scene scene;
  scene.solids = {solid};
  scene.obstacles = std::move(obstacles);
  scene.octree = std::make_shared<octomap::OcTree>(0.1);
  return scene;
}

const VehicleEnvelope kVehicle{0.35, 0.30, 0.25};

TEST(PlanCorridors, LeadsStraightThroughTheMiddle) {
  const auto corridors = PlanCorridors(WithPassage({}), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_TRUE(corridors[0].entry_in_map_m.isApprox(Eigen::Vector3d(2.0, -1.0, 0.75), 1e-6));
  EXPECT_TRUE(corridors[0].exit_in_map_m.isApprox(Eigen::Vector3d(2.0, 2.5, 0.75), 1e-6));
  EXPECT_NEAR(corridors[0].free_width_m, 2.0, 1e-6);
}

TEST(PlanCorridors, KeepsTheUncertaintyOfTheSidesOffThem) {
  Scene scene = WithPassage({});
  scene.solids[0].passages[0].std_m = 0.02;
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  for (double x = -0.95; x < 2.2; x += 0.1) {  // More was seen free on the left than the vehicle can use.
    for (double y = -1.95; y < 3.5; y += 0.1) {
      for (double z = 0.05; z < 1.0; z += 0.1) tree->setNodeValue(x, y, z, -2.0F, true);
    }
  }
  tree->updateInnerOccupancy();
  scene.octree = tree;
  const auto corridors = PlanCorridors(scene, 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_LT(corridors[0].left_m, 0.95);
  EXPECT_GE(corridors[0].left_m - 0.60, 3.0 * 0.02);
  EXPECT_GE(corridors[0].entry_in_map_m.z() - 0.40, 3.0 * 0.02);
}

Obstacle Pillar(const Eigen::Vector3d& base_in_map_m, double radius_m, double height_m) {
  Obstacle pillar;
  pillar.base_in_map_m = base_in_map_m;
  pillar.radius_m = radius_m;
  pillar.height_m = height_m;
  return pillar;
}

TEST(PlanCorridors, GoesBesideAPole) {
  const auto corridors = PlanCorridors(WithPassage({Pillar({1.3, -0.5, 0}, 0.05, 2.0)}), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].free_width_m, 1.65, 1e-6);
  EXPECT_THAT(corridors[0].limited_by, HasSubstr("obstacle at 1.30, -0.50"));
}

TEST(PlanCorridors, TellsWhatAPoleInTheMiddleLeaves) {
  const auto corridors = PlanCorridors(WithPassage({Pillar({2.0, -0.5, 0}, 0.05, 2.0)}), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].free_width_m, 0.95, 1e-6);
}

TEST(PlanCorridors, GoesOverALowThingWithRoomToSpare) {
  const auto corridors = PlanCorridors(WithPassage({Pillar({2.0, 0.7, 0}, 0.9, 0.3)}), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].floor_m, 0.6, 1e-6);
  EXPECT_NEAR(corridors[0].free_height_m, 0.9, 1e-6);
}

TEST(PlanCorridors, GoesCloserOverAThingWhoseTopIsSeen) {
  Obstacle low = Pillar({2.0, 0.7, 0}, 0.9, 0.3);
  low.is_top_seen = true;
  const auto corridors = PlanCorridors(WithPassage({low}), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].floor_m, 0.3, 1e-6);
}

TEST(PlanCorridors, GoesUnderAThingThatHangs) {
  Obstacle beam = Pillar({2.0, 0.7, 1.2}, 2.0, 0.1);
  beam.std_m = 0.02;
  const auto corridors = PlanCorridors(WithPassage({beam}), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].floor_m, 0.0, 1e-6);
  EXPECT_NEAR(corridors[0].free_height_m, 1.2 - 3.0 * 0.02, 1e-6);
}

TEST(PlanCorridors, DoesNotLoseAPassageThatIsFilledUp) {
  const auto corridors = PlanCorridors(WithPassage({Pillar({2.0, 0.7, 0}, 2.0, 2.0)}), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_EQ(corridors[0].free_width_m, 0.0);
}

TEST(PlanCorridors, FindsNoneWithoutAPassageOrForAnotherObject) {
  Scene scene = WithPassage({});
  EXPECT_THAT(PlanCorridors(scene, 8, kVehicle, {}), IsEmpty());
  scene.solids[0].passages.clear();
  EXPECT_THAT(PlanCorridors(scene, 7, kVehicle, {}), IsEmpty());
}

TEST(PlanCorridors, RefusesAVehicleWithoutSize) {
  EXPECT_THROW(PlanCorridors(WithPassage({}), 7, {}, {}), ContractViolation);
}

}  // namespace
}  // namespace soffit
