#include "service/corridor/corridor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "service/corridor/lane.h"
#include "service/corridor/rectangle.h"

namespace soffit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
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

/// Upright, with these ends on the ground, left and right as seen by who enters.
Section Upright(const Eigen::Vector2d& left, const Eigen::Vector2d& right, double height) {
  return {{left.x(), left.y(), 0},
          {right.x(), right.y(), 0},
          {right.x(), right.y(), height},
          {left.x(), left.y(), height}};
}

Scene WithPassage(std::vector<Obstacle> obstacles) {
  Solid solid;
  solid.footprint.object_id = 7;
  solid.footprint.polygon_in_map_m.outer = {{0, 0}, {4, 0}, {4, 1.5}, {0, 1.5}};
  Passage passage;
  passage.entry_wall = 0;
  passage.exit_wall = 2;
  passage.sections_in_map_m = {Upright({1, 0}, {3, 0}, 1.5), Upright({1, 1.5}, {3, 1.5}, 1.5)};
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

TEST(PlanCorridors, FollowsASlantedPassage) {
  Scene scene = WithPassage({});
  scene.solids[0].passages[0].sections_in_map_m = {Upright({0, 0}, {2, 0}, 1.5),
                                                   Upright({1.5, 1.5}, {3.5, 1.5}, 1.5)};
  const auto corridors = PlanCorridors(scene, 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].free_width_m, std::sqrt(2.0), 1e-9);
  const Eigen::Vector3d way = (corridors[0].exit_in_map_m - corridors[0].entry_in_map_m).normalized();
  EXPECT_TRUE(way.isApprox(Eigen::Vector3d(1, 1, 0).normalized(), 1e-9));
  const double before = -corridors[0].entry_in_map_m.y();
  EXPECT_GE(before, 0.6);
  EXPECT_TRUE(corridors[0].bends_in_map_m.empty());
}

TEST(PlanCorridors, TellsTheWidthOfTheNarrowestPlace) {
  Scene scene = WithPassage({});
  scene.solids[0].passages[0].sections_in_map_m = {Upright({0.5, 0}, {3.5, 0}, 1.5),
                                                   Upright({1.2, 0.7}, {2.6, 0.7}, 1.3),
                                                   Upright({0.5, 1.5}, {3.5, 1.5}, 1.5)};
  const auto corridors = PlanCorridors(scene, 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].free_width_m, 1.4, 1e-9);
  EXPECT_NEAR(corridors[0].free_height_m, 1.3, 1e-9);
  EXPECT_TRUE(corridors[0].bends_in_map_m.empty());
}

/// The arch's passage with mouths from these heights up.
Scene Rising(double entry_m, double exit_m, double height_m) {
  Scene scene = WithPassage({});
  auto& sections = scene.solids[0].passages[0].sections_in_map_m;
  for (Section* section : {&sections[0], &sections[1]}) {
    const double floor = section == &sections[0] ? entry_m : exit_m;
    for (std::size_t i = 0; i < 4; ++i) (*section)[i].z() = i < 2 ? floor : floor + height_m;
  }
  return scene;
}

TEST(PlanCorridors, StaysLevelInAPassageThatRises) {
  const auto corridors = PlanCorridors(Rising(0.2, 0.6, 1.6), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].floor_m, 0.6, 1e-9);
  EXPECT_NEAR(corridors[0].free_height_m, 1.2, 1e-6);
  EXPECT_NEAR(corridors[0].free_width_m, 2.0, 1e-5);
  EXPECT_EQ(corridors[0].entry_in_map_m.z(), corridors[0].exit_in_map_m.z());
}

TEST(PlanCorridors, HasNoHeightWhereNoLevelLineLeadsThrough) {
  const auto corridors = PlanCorridors(Rising(0.0, 1.4, 1.2), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_EQ(corridors[0].free_height_m, 0.0);
  EXPECT_NEAR(corridors[0].free_width_m, 2.0, 1e-9);
}

TEST(Corridor, KeepsItsWidthAroundABend) {
  Corridor corridor;
  corridor.entry_in_map_m = {0, 0, 1};
  corridor.bends_in_map_m = {{5, 0, 1}};
  corridor.exit_in_map_m = {5, 4, 1};
  corridor.left_m = 0.5;
  corridor.free_width_m = 2.0;
  corridor.free_height_m = 1.5;
  corridor.floor_m = 0.2;
  const std::vector<Section> sections = corridor.Sections();
  ASSERT_EQ(sections.size(), 3U);
  EXPECT_TRUE(sections[0][0].isApprox(Eigen::Vector3d(0, 0.5, 0.2)));
  EXPECT_TRUE(sections[1][0].isApprox(Eigen::Vector3d(4.5, 0.5, 0.2)));
  EXPECT_TRUE(sections[1][1].isApprox(Eigen::Vector3d(6.5, -1.5, 0.2)));
  EXPECT_TRUE(sections[2][2].isApprox(Eigen::Vector3d(6.5, 4, 1.7)));
  EXPECT_EQ(corridor.Edges().size(), 20U);
}

TEST(FindWidestLane, NeverLeadsBackwards) {
  // Seen from the side, the second one lies before the first one, and more of them behind each other.
  const std::vector<Section> sections = {Upright({0, 0}, {1, 1}, 1.5), Upright({0.9, 0.5}, {1.9, 1.2}, 1.5)};
  const auto lane = FindWidestLane(sections);
  ASSERT_TRUE(lane.has_value());
  EXPECT_GT(lane->way.dot(Eigen::Vector2d(0.9, 0.35)), 0.0);
  EXPECT_GT(lane->right_m, lane->left_m);
  EXPECT_FALSE(FindWidestLane({Upright({0, 0}, {1, 0}, 1.5), Upright({3, 0}, {4, 0}, 1.5)}).has_value());
}

TEST(PlanCorridors, TurnsIntoTheWidestDirection) {
  // No line at right angles to the walls is as wide as one that leads from one side to the other.
  const auto lane = FindWidestLane({Upright({0, 0}, {2, 0}, 1.5), Upright({0.8, 1.5}, {2.8, 1.5}, 1.5)});
  ASSERT_TRUE(lane.has_value());
  double widest = 0.0;
  for (double angle = -1.2; angle < 1.2; angle += 1e-4) {
    const Eigen::Vector2d right(std::cos(angle), std::sin(angle));
    const double low = std::max(0.0, right.dot(Eigen::Vector2d(0.8, 1.5)));
    const double high = std::min(right.dot(Eigen::Vector2d(2, 0)), right.dot(Eigen::Vector2d(2.8, 1.5)));
    widest = std::max(widest, high - low);
  }
  EXPECT_NEAR(lane->right_m - lane->left_m, widest, 2e-4);
  EXPECT_GE(lane->right_m - lane->left_m, widest);
}

TEST(PlanCorridors, BendsWhereNoStraightLineFits) {
  Scene scene = WithPassage({});
  // Straight in for 2 m, then to the right at 45 degrees for 2 m; 1.6 m wide all along.
  const double k = 0.8 * std::tan(M_PI / 8), end = 2.0 / std::sqrt(2.0), half = 0.8 / std::sqrt(2.0);
  scene.solids[0].passages[0].sections_in_map_m = {
      Upright({-0.8, 0}, {0.8, 0}, 1.5), Upright({-0.8, 2 + k}, {0.8, 2 - k}, 1.5),
      Upright({end - half, 2 + end + half}, {end + half, 2 + end - half}, 1.5)};
  const auto corridors = PlanCorridors(scene, 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].free_width_m, 1.6, 1e-6);
  ASSERT_THAT(corridors[0].bends_in_map_m, SizeIs(1));
  EXPECT_TRUE(corridors[0].bends_in_map_m[0].isApprox(Eigen::Vector3d(0, 2, 0.75), 1e-6));
  EXPECT_THAT(corridors[0].Path(), SizeIs(3));
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
  EXPECT_THAT(corridors[0].limited_by, HasSubstr("obstacle at (1.30, -0.50, 0.00)"));
}

TEST(PlanCorridors, NamesPlacesInTheCoordinatesThatPeopleAreTold) {
  Scene scene = WithPassage({Pillar({1.3, -0.5, 0}, 0.05, 2.0)});
  scene.map_origin_m = {691000.0, 5335000.0, 510.0};
  const auto corridors = PlanCorridors(scene, 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_THAT(corridors[0].limited_by, HasSubstr("obstacle at (691001.30, 5334999.50, 510.00)"));
  EXPECT_NEAR(corridors[0].entry_in_map_m.x(), 2.2, 0.5);  // Numbers stay in the map.
}

TEST(PlanCorridors, NamesAllThatBoundsItAndNothingElse) {
  const std::vector<Obstacle> poles = {Pillar({1.2, -0.5, 0}, 0.05, 2.0), Pillar({2.7, 0.4, 0}, 0.05, 2.0),
                                       Pillar({1.05, 1.0, 0}, 0.05, 2.0)};
  const auto corridors = PlanCorridors(WithPassage(poles), 7, kVehicle, {});
  ASSERT_THAT(corridors, SizeIs(1));
  EXPECT_NEAR(corridors[0].free_width_m, 1.4, 1e-6);
  EXPECT_THAT(corridors[0].limited_by, HasSubstr("obstacle at (1.20, -0.50, 0.00)"));
  EXPECT_THAT(corridors[0].limited_by, HasSubstr("obstacle at (2.70, 0.40, 0.00)"));
  EXPECT_THAT(corridors[0].limited_by, Not(HasSubstr("1.05")));
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
