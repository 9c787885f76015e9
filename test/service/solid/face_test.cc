#include "service/solid/face.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "test/support/plain_building.h"

namespace soffit {
namespace {

using test::Building;
using test::kBlock;
using ::testing::SizeIs;

std::vector<Facade> Closed(int sides) {
  std::vector<Facade> facades;
  for (int side = 0; side < sides; ++side) facades.push_back({1, side, 0.0, 2.0, 0.01, true, {}});
  return facades;
}

Opening At(const Ring& ring) {
  Opening opening;
  opening.ring_in_wall_m = ring;
  return opening;
}

std::vector<Face> FacesOf(const Solid& solid, FaceKind kind) {
  std::vector<Face> faces;
  std::ranges::copy_if(solid.faces, std::back_inserter(faces), [&](const Face& f) { return f.kind == kind; });
  return faces;
}

double AreaOf(const Mesh& mesh, const Face& face) {
  double area = 0.0;
  for (const std::size_t t : face.triangles) {
    const auto corner = [&](std::size_t i) -> const Eigen::Vector3d& {
      return mesh.vertices_in_map_m[static_cast<std::size_t>(mesh.triangles[t][i])];
    };
    area += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  return area;
}

TEST(GatherFaces, GivesEachTriangleToOneFace) {
  auto facades = Closed(4);
  facades[0].openings = {At({{1, 0}, {2.6, 0}, {2.6, 1.5}, {1, 1.5}})};
  facades[0].openings[0].recess = Recess{facades[0].openings[0].ring_in_wall_m, 0.3, 0.01};
  const Solid solid = RaiseSolid(Building(kBlock), facades).value();
  std::multiset<std::size_t> triangles;
  for (const Face& face : solid.faces) triangles.insert(face.triangles.begin(), face.triangles.end());
  EXPECT_THAT(triangles, SizeIs(solid.mesh.triangles.size()));
  EXPECT_EQ(*triangles.rbegin(), solid.mesh.triangles.size() - 1);
  EXPECT_THAT(std::set(triangles.begin(), triangles.end()), SizeIs(triangles.size()));
}

TEST(GatherFaces, TellsTheFacesOfARecessFromTheWallAroundIt) {
  auto facades = Closed(4);
  facades[1].openings = {At({{0.4, 0.5}, {1.1, 0.5}, {1.1, 1.5}, {0.4, 1.5}})};
  facades[1].openings[0].recess = Recess{facades[1].openings[0].ring_in_wall_m, 0.3, 0.01};
  const Solid solid = RaiseSolid(Building(kBlock), facades).value();
  const std::vector<Face> backs = FacesOf(solid, FaceKind::kBack);
  ASSERT_THAT(backs, SizeIs(1));
  EXPECT_EQ(backs[0].wall, 1);
  EXPECT_EQ(backs[0].opening, 0);
  EXPECT_NEAR(AreaOf(solid.mesh, backs[0]), 0.7, 1e-6);
  EXPECT_THAT(FacesOf(solid, FaceKind::kFloor), SizeIs(1));
  EXPECT_THAT(FacesOf(solid, FaceKind::kCeiling), SizeIs(1));
  EXPECT_THAT(FacesOf(solid, FaceKind::kWall), SizeIs(4 + 2));
  EXPECT_THAT(FacesOf(solid, FaceKind::kRoof), SizeIs(1));
  EXPECT_THAT(FacesOf(solid, FaceKind::kGround), SizeIs(1));
  for (const Face& face : solid.faces) {
    if (face.kind != FaceKind::kWall || face.opening >= 0 || face.wall != 1) continue;
    EXPECT_NEAR(AreaOf(solid.mesh, face), 1.5 * 2.0 - 0.7, 1e-6);
    const std::vector<Ring3> outline = OutlineOf(solid.mesh, face);
    ASSERT_THAT(outline, SizeIs(2));
    EXPECT_NEAR(outline[0][0].x(), 4.0, 1e-9);
  }
}

TEST(GatherFaces, LeavesTheHoleOfACourtyardInTheRoof) {
  Footprint building = Building({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
  building.polygon_in_map_m.holes = {{{1, 1}, {1, 3}, {3, 3}, {3, 1}}};
  const Solid solid = RaiseSolid(building, {}).value();
  EXPECT_THAT(FacesOf(solid, FaceKind::kWall), SizeIs(8));
  const std::vector<Face> roofs = FacesOf(solid, FaceKind::kRoof);
  ASSERT_THAT(roofs, SizeIs(1));
  const std::vector<Ring3> outline = OutlineOf(solid.mesh, roofs[0]);
  ASSERT_THAT(outline, SizeIs(2));
  EXPECT_THAT(outline[0], SizeIs(4));
  EXPECT_NEAR(AreaOf(solid.mesh, roofs[0]), 12.0, 1e-9);
}

TEST(GatherFaces, GivesWallLedgeAndUpperWallOfASetbackToTheirSide) {
  Footprint building = Building({{0, 0}, {6, 0}, {6, 5}, {0, 5}});
  building.height_m = 4.0;
  building.levels = {{2.0, {0, 0, 0, 0}}, {2.0, {0, 1, 0, 0}}, {4.0, {0, 1, 0, 0}}};
  const Solid solid = RaiseSolid(building, {}).value();
  std::vector<double> walls, roofs;
  for (const Face& face : solid.faces) {
    if (face.wall != 1) continue;
    (face.kind == FaceKind::kRoof ? roofs : walls).push_back(AreaOf(solid.mesh, face));
  }
  EXPECT_THAT(
      walls, testing::UnorderedElementsAre(testing::DoubleNear(10.0, 1e-4), testing::DoubleNear(10.0, 1e-4)));
  EXPECT_THAT(roofs, testing::ElementsAre(testing::DoubleNear(5.0, 1e-4)));
}

}  // namespace
}  // namespace soffit
