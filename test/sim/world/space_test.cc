#include "test/sim/world/space.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ctime>
#include <numbers>
#include <random>

#include "test/sim/world/geos.h"

namespace soffit::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::SizeIs;

Part Box(const Vector2d& low, const Vector2d& high, double bottom_m, double top_m) {
  Prism prism;
  prism.section.outer = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  prism.low_m = bottom_m;
  prism.high_m = top_m;
  return {prism, {}};
}

World Arch() {
  World world;
  Structure arch;
  arch.id = "arch";
  arch.parts = {Box({-2, -0.75}, {-0.8, 0.75}, 0, 1.5), Box({0.8, -0.75}, {2, 0.75}, 0, 1.5),
                Box({-2, -0.75}, {2, 0.75}, 1.5, 2.3)};
  world.buildings = {arch};
  return world;
}

double Volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    sum += mesh.vertices_m[a].dot(mesh.vertices_m[b].cross(mesh.vertices_m[c])) / 6.0;
  }
  return sum;
}

TEST(BuildMesh, TakesAPrismToItsTop) {
  Prism prism;
  prism.section.outer = {{0, 0}, {4, 0}, {4, 2}, {0, 2}};
  prism.top = {{0.5, 0.5}, {3.5, 0.5}, {3.5, 1.5}, {0.5, 1.5}};
  prism.low_m = 1.0;
  prism.high_m = 4.0;
  Structure structure;
  structure.parts = {Part{prism, {}}};
  EXPECT_NEAR(Volume(BuildMesh(structure)), 3.0 / 6.0 * (8.0 + 4.0 * 3.5 * 1.5 + 3.0), 1e-9);  // Prismatoid.
}

TEST(BuildMesh, IsClosedAndFacesOutwards) {
  Structure structure;
  structure.position_m = {5, -3};
  structure.yaw_rad = 0.7;
  const Ring outer = {{0, 0}, {3, 0}, {3, 2}, {0, 2}}, hole = {{1, 0.5}, {1, 1.5}, {2, 1.5}, {2, 0.5}};
  Prism prism;
  prism.section = {outer, {hole}};
  prism.low_m = 0.5;
  prism.high_m = 2.0;
  structure.parts = {Part{prism, {}}};
  EXPECT_NEAR(Volume(BuildMesh(structure)), 5.0 * 1.5, 1e-9);
  prism.is_lying = true;
  prism.axis = {0.6, 0.8};
  structure.parts = {Part{prism, {}}};
  EXPECT_NEAR(Volume(BuildMesh(structure)), 5.0 * 1.5, 1e-9);
}

TEST(BuildMesh, LaysAProfileAsSeenAlongItsAxis) {
  Structure structure;
  Prism prism;
  prism.section.outer = {{0, 0}, {2, 0}, {2, 1}, {0, 1}};
  prism.high_m = 5.0;
  prism.is_lying = true;
  prism.at = {1, 1};
  structure.parts = {Part{prism, {}}};
  Vector3d low = Vector3d::Constant(1e9), high = -low;
  for (const Vector3d& vertex : BuildMesh(structure).vertices_m) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  EXPECT_TRUE(low.isApprox(Vector3d(1, 1, 0)) && high.isApprox(Vector3d(3, 6, 1)))
      << low.transpose() << " " << high.transpose();
}

TEST(Union, JoinsTrianglesToPolygonsWithoutCollinearCorners) {
  auto triangles = Triangulate({{{0, 0}, {2, 0}, {2, 2}, {0, 2}}, {}});
  for (const auto& triangle : Triangulate({{{2, 0.5}, {4, 0.5}, {4, 1.5}, {2, 1.5}}, {}}))
    triangles.push_back(triangle);
  const auto polygons = Union(triangles);
  ASSERT_THAT(polygons, SizeIs(1));
  EXPECT_THAT(polygons[0].outer, SizeIs(8));
  EXPECT_NEAR(Area(polygons[0]), 6.0, 1e-6);
}

/// The distance by brute force, with points all over the triangle.
double SampledDistance(const Cylinder& cylinder, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  constexpr int kSteps = 400;
  double least = 1e9;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const Vector3d p = a + (b - a) * i / kSteps + (c - a) * j / kSteps - cylinder.center_m;
      least = std::min(least, std::hypot(std::max(0.0, p.head<2>().norm() - cylinder.radius_m),
                                         std::max(0.0, std::abs(p.z()) - 0.5 * cylinder.height_m)));
    }
  }
  return least;
}

TEST(Distance, OfACylinderToATriangleIsExact) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-2.0, 2.0);
  const auto point = [&] { return Vector3d(coordinate(random), coordinate(random), coordinate(random)); };
  for (int i = 0; i < 60; ++i) {
    const Cylinder cylinder{0.5 * point(), 0.4, 0.3};
    Vector3d a = point(), b = point(), c = point();
    if (i % 3 == 0) a.z() = b.z() = c.z();                          // Level.
    if (i % 3 == 1) c.head<2>() = (a.head<2>() + b.head<2>()) / 2;  // Plumb.
    EXPECT_NEAR(Distance(cylinder, a, b, c), SampledDistance(cylinder, a, b, c), 0.012) << i;
    EXPECT_LE(Distance(cylinder, a, b, c), SampledDistance(cylinder, a, b, c) + 1e-9) << i;
  }
}

TEST(Distance, IsZeroWhenALargeTriangleCutsTheCylinder) {
  const Cylinder cylinder{{0, 0, 1}, 0.35, 0.3};
  EXPECT_EQ(Distance(cylinder, {-50, -50, 1.1}, {50, -50, 1.1}, {0, 50, 1.1}), 0.0);
  EXPECT_NEAR(Distance(cylinder, {-50, -50, 1.5}, {50, -50, 1.5}, {0, 50, 1.5}), 0.35, 1e-9);
  EXPECT_NEAR(Distance(cylinder, {1, -50, -50}, {1, 50, -50}, {1, 0, 90}), 0.65, 1e-9);
}

TEST(Space, GivesTheLeastDistanceInAPassage) {
  const Space space(Arch());
  const Space::Nearest inside = space.DistanceTo({{0.1, 0, 0.9}, 0.35, 0.3});
  EXPECT_NEAR(inside.distance_m, 0.8 - 0.1 - 0.35, 1e-6);
  EXPECT_EQ(inside.owner, "arch");
  const Space::Nearest low = space.DistanceTo({{0, 0, 0.25}, 0.35, 0.3});
  EXPECT_NEAR(low.distance_m, 0.1, 1e-6);
  EXPECT_EQ(low.owner, "ground");
  EXPECT_EQ(space.DistanceTo({{0.6, 0, 0.9}, 0.35, 0.3}).distance_m, 0.0);
}

TEST(Space, SaysNothingBeyondItsLimit) {
  const Space space(Arch());
  const Space::Nearest nearest = space.DistanceToBodies({{100, 0, 50}, 0.35, 0.3}, 3.0);
  EXPECT_EQ(nearest.distance_m, 3.0);
  EXPECT_EQ(nearest.owner, "");
}

TEST(Space, AnswersFastEnoughForEveryStepOfThePhysics) {
  World world = Arch();
  for (int i = 0; i < 20; ++i) world.bushes.push_back({{3.0 + i % 5, 2.0 + i / 5}, 0.4});
  const Space space(world);
  const std::clock_t begin = std::clock();  // Of the processor: other programs do not count.
  constexpr int kQueries = 1000;
  for (int i = 0; i < kQueries; ++i) space.DistanceTo({{0.01 * i - 5.0, 0.3, 1.2}, 0.35, 0.3}, 2.0);
  const double query_us = 1e6 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC / kQueries;
  RecordProperty("microseconds_per_query", static_cast<int>(query_us));
  EXPECT_LT(query_us, 2000.0);  // Measured 20 us; a wide margin for sanitizers.
}

TEST(Space, TellsWhetherACylinderIsFreeAlongItsWay) {
  World world;
  Structure post;
  Prism prism;
  prism.section.outer = {{2.0, 0.5}, {2.02, 0.5}, {2.02, 0.52}, {2.0, 0.52}};
  prism.high_m = 3.0;
  post.parts = {{prism, {}}};
  world.obstacles = {post};
  const Space space(world);
  const Eigen::Vector3d end(4, 0, 1);
  EXPECT_TRUE(space.IsFreeAlong({{0, 0, 1}, 0.49, 0.5}, end));
  EXPECT_FALSE(space.IsFreeAlong({{0, 0, 1}, 0.51, 0.5}, end));
  EXPECT_TRUE(space.IsFreeAlong({{0, 0, 1}, 0.51, 0.5}, {1.0, 0, 1}));
  EXPECT_FALSE(space.IsFreeAlong({{0, 0, 1}, 0.1, 2.01}, end));  // Into the ground.
  EXPECT_FALSE(space.IsFreeAlong({{0, 0, 1}, 0.1, 1.0}, {4, 0, 0.4}));
  EXPECT_FALSE(space.IsFreeAlong({{2.01, 0.45, 1}, 0.1, 1.0}, {2.01, 0.45, 1}));
}

}  // namespace
}  // namespace soffit::sim
