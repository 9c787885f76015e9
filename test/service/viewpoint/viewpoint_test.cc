#include "service/viewpoint/viewpoint.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace soffit {
namespace {

using ::testing::SizeIs;

constexpr VehicleEnvelope kVehicle{0.35, 0.30, 0.25};
constexpr double kPi = std::numbers::pi;

Intrinsics Camera() { return {1280, 960, 850.0, 850.0, 631.2, 482.8, {}}; }

Footprint Building(Ring ring, double height_m, std::uint32_t id = 1) {
  Footprint footprint;
  footprint.object_id = id;
  footprint.polygon_in_map_m.outer = std::move(ring);
  footprint.height_m = height_m;
  return footprint;
}

Ring Box(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}; }

Ring Turned(Ring ring, double by_rad, const Eigen::Vector2d& shift) {
  for (Eigen::Vector2d& corner : ring) corner = Eigen::Rotation2Dd(by_rad) * corner + shift;
  return ring;
}

View Look(const Viewpoint& viewpoint) {
  return {Camera(),
          {CameraAttitude(viewpoint.yaw_rad, viewpoint.pitch_rad), viewpoint.position_in_map_m},
          0.0,
          0.0};
}

bool IsInPicture(const Viewpoint& viewpoint, const Eigen::Vector2d& corner, double height_m) {
  const auto pixel = Project(Look(viewpoint), {corner.x(), corner.y(), height_m});
  return pixel && pixel->x() > 0 && pixel->x() < 1279 && pixel->y() > 0 && pixel->y() < 959;
}

bool ShowsWholeWall(const Viewpoint& view, const Footprint& object) {
  const Ring& ring = object.polygon_in_map_m.outer;
  const auto side = static_cast<std::size_t>(view.side);
  const Eigen::Vector2d& a = ring[side];
  const Eigen::Vector2d& b = ring[(side + 1) % ring.size()];
  return IsInPicture(view, a, 0.0) && IsInPicture(view, b, 0.0) && IsInPicture(view, a, object.height_m) &&
         IsInPicture(view, b, object.height_m);
}

std::vector<int> SidesOf(const std::vector<Viewpoint>& views) {
  std::vector<int> sides;
  for (const Viewpoint& view : views) sides.push_back(view.side);
  return sides;
}

TEST(PlanOverview, TakesThePapersAltitudeWhereTheAreaFits) {
  const Viewpoint view = PlanOverview({3.0, 4.0}, 2.0, Camera(), {});
  EXPECT_EQ(view.purpose, Purpose::kOverview);
  EXPECT_DOUBLE_EQ(view.position_in_map_m.z(), 9.0);
  EXPECT_DOUBLE_EQ(view.pitch_rad, -kPi / 2.0);
}

TEST(PlanOverview, ClimbsUntilTheAreaFits) {
  const Viewpoint view = PlanOverview({0.0, 0.0}, 20.0, Camera(), {});
  EXPECT_GT(view.position_in_map_m.z(), 9.0);
  for (double angle = 0.0; angle < 6.28; angle += 0.1) {
    EXPECT_TRUE(IsInPicture(view, 20.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle)), 0.0));
  }
}

TEST(PlanTop, HasTheWholeRoofInThePictureAtAnyTurn) {
  for (const double turn : {0.0, 0.4, 1.3, 2.9}) {
    const Footprint object = Building(Turned(Box(0, 0, 6, 1.5), turn, {5, -8}), 2.3);
    const Viewpoint view = PlanTop(object, Camera(), kVehicle, {});
    for (const Eigen::Vector2d& corner : object.polygon_in_map_m.outer)
      EXPECT_TRUE(IsInPicture(view, corner, 2.3));
    EXPECT_GE(view.position_in_map_m.z(), 2.3 + kVehicle.NeededHeight_m());
  }
}

TEST(PlanTop, LaysTheLongSideOfThePictureAlongTheLongSideOfTheObject) {
  const Viewpoint view = PlanTop(Building(Box(0, 0, 8, 2), 2.0), Camera(), kVehicle, {});
  const auto a = Project(Look(view), {0, 1, 2.0});
  const auto b = Project(Look(view), {8, 1, 2.0});
  EXPECT_GT(std::abs(a->x() - b->x()), 10.0 * std::abs(a->y() - b->y()));
}

TEST(PlanTop, StaysAboveATallBuilding) {
  const Viewpoint view = PlanTop(Building(Box(0, 0, 12, 6), 20.0), Camera(), kVehicle, {});
  EXPECT_GT(view.position_in_map_m.z(), 21.0);
}

TEST(PlanTop, DoesNotApproachAnObjectOfUnknownHeight) {
  const Viewpoint view = PlanTop(Building(Box(0, 0, 2, 1), 0.0), Camera(), kVehicle, {});
  EXPECT_GE(view.position_in_map_m.z(), 9.0);
}

TEST(PlanWalls, BeginsWithFrontRightAndOppositeAndShowsEachWallWhole) {
  const Footprint object = Building(Turned(Box(0, 0, 4, 1.5), 0.7, {-3, 6}), 2.3);
  const std::vector<Viewpoint> views = PlanWalls(object, {object}, Camera(), kVehicle, {});
  EXPECT_THAT(SidesOf(views), testing::ElementsAre(0, 1, 2, 3));
  for (const Viewpoint& view : views) {
    EXPECT_TRUE(ShowsWholeWall(view, object)) << view.reason;
    EXPECT_DOUBLE_EQ(view.pitch_rad, 0.0);
  }
}

TEST(PlanWalls, SeesATallBuildingFromBaseToTopFromALowPlace) {
  const Footprint object = Building(Box(0, 0, 14, 8), 20.0);
  const std::vector<Viewpoint> views = PlanWalls(object, {object}, Camera(), kVehicle, {});
  ASSERT_THAT(views, SizeIs(4));
  for (const Viewpoint& view : views) {
    EXPECT_TRUE(ShowsWholeWall(view, object)) << view.reason;
    EXPECT_LE(view.position_in_map_m.z(), 4.0);
  }
}

TEST(PlanWalls, SeesTheSidesOfANotchFromWithinIt) {
  const Footprint object = Building({{0, 0}, {12, 0}, {12, 3}, {3, 3}, {3, 12}, {0, 12}}, 2.5);
  const std::vector<Viewpoint> views = PlanWalls(object, {object}, Camera(), kVehicle, {});
  EXPECT_THAT(SidesOf(views), testing::IsSupersetOf({0, 2, 3, 5}));
  for (const Viewpoint& view : views) {
    EXPECT_TRUE(ShowsWholeWall(view, object)) << view.side;
    if (view.side == 2 || view.side == 3) {
      EXPECT_GT(view.position_in_map_m.x(), 3.0);
      EXPECT_GT(view.position_in_map_m.y(), 3.0);
    }
  }
}

TEST(PlanWalls, KeepsOffOtherBuildings) {
  const Footprint object = Building(Box(0, 0, 4, 1.5), 2.3);
  const Footprint in_front = Building(Box(1, -4.6, 3, -3.4), 2.0, 2);
  const std::vector<Viewpoint> views = PlanWalls(object, {object, in_front}, Camera(), kVehicle, {});
  ASSERT_FALSE(views.empty());
  for (const Viewpoint& view : views) {
    const Eigen::Vector2d place = view.position_in_map_m.head<2>();
    EXPECT_GE(DistanceToRing(place, in_front.polygon_in_map_m.outer), 1.6 - 1e-9);
    EXPECT_FALSE(Contains(in_front.polygon_in_map_m.outer, place));
  }
}

TEST(PlanWalls, LeavesOutAWallThatAnotherBuildingHides) {
  const Footprint object = Building(Box(0, 0, 4, 1.5), 2.3);
  const Footprint close = Building(Box(-2, -1.2, 6, -0.7), 2.0, 2);
  const std::vector<Viewpoint> views = PlanWalls(object, {object, close}, Camera(), kVehicle, {});
  EXPECT_THAT(SidesOf(views), testing::Not(testing::Contains(0)));
  EXPECT_THAT(SidesOf(views), testing::Contains(2));
}

TEST(PlanWalls, DoesNotTakeAnOlderShapeOfTheObjectForAnObstacle) {
  const Footprint object = Building(Box(0, 0, 4, 1.5), 2.3);
  const Footprint older = Building(Box(-0.2, -0.2, 4.2, 1.7), 0.0);
  EXPECT_THAT(PlanWalls(object, {older}, Camera(), kVehicle, {}), SizeIs(4));
}

TEST(PlanWalls, TakesARoundTowerFromAFewSides) {
  Ring ring;
  for (int i = 0; i < 32; ++i)
    ring.emplace_back(2.0 * std::cos(i * kPi / 16.0), 2.0 * std::sin(i * kPi / 16.0));
  const Footprint tower = Building(ring, 3.0);
  const std::vector<Viewpoint> views = PlanWalls(tower, {tower}, Camera(), kVehicle, {});
  EXPECT_GE(views.size(), 2U);
  EXPECT_LE(views.size(), 4U);
}

TEST(PlanWalls, GivesTheSamePlanForTheSameInput) {
  const Footprint object =
      Building(Turned({{0, 0}, {9, 0}, {9, 3}, {3, 3}, {3, 7}, {0, 7}}, 1.1, {2, 2}), 2.5);
  const auto a = PlanWalls(object, {object}, Camera(), kVehicle, {});
  const auto b = PlanWalls(object, {object}, Camera(), kVehicle, {});
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].position_in_map_m, b[i].position_in_map_m);
}

TEST(PlanCorridorLook, HasTheNeededSpaceAtTheEntryInThePicture) {
  const Eigen::Vector3d entry(2.0, -1.6, 0.8);
  const Eigen::Vector3d exit(2.0, 3.1, 0.8);
  const Viewpoint view = PlanCorridorLook(entry, exit, {}, Camera(), kVehicle, {});
  EXPECT_NEAR(view.yaw_rad, kPi / 2.0, 1e-9);
  EXPECT_LT(view.position_in_map_m.y(), entry.y());
  for (const double side : {-0.6, 0.6}) {
    EXPECT_TRUE(IsInPicture(view, {2.0 + side, entry.y() + 1e-3}, 0.4));
    EXPECT_TRUE(IsInPicture(view, {2.0 + side, entry.y() + 1e-3}, 1.2));
  }
}

TEST(PlanCorridorLook, DoesNotBackIntoAnotherBuilding) {
  const Footprint behind = Building(Box(0, -4, 4, -2.4), 2.0, 2);
  const Viewpoint view =
      PlanCorridorLook({2.0, -1.6, 0.8}, {2.0, 3.1, 0.8}, {behind}, Camera(), kVehicle, {});
  EXPECT_GE(view.position_in_map_m.y(), -1.8 - 1e-9);
}

}  // namespace
}  // namespace soffit
