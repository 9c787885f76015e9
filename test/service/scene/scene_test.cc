#include "service/scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "test/support/painted_world.h"

namespace soffit {
namespace {

using test::Arch;
using test::Look;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

enum class Space { kUnknown, kFree, kOccupied };

Space At(const Scene& scene, double x, double y, double z) {
  const auto* node = scene.octree->search(x, y, z);
  if (node == nullptr) return Space::kUnknown;
  return scene.octree->isNodeOccupied(node) ? Space::kOccupied : Space::kFree;
}

Solid Model(const Arch& arch) {
  Solid solid;
  solid.footprint = arch.footprint();
  solid.mesh = arch.thing().mesh;
  return solid;
}

Scene Build(const std::vector<Sight>& sights, const Arch& arch = {}) {
  SceneObject object;
  object.footprint = arch.footprint();
  object.is_matched = true;
  return BuildScene(3, {object}, {Model(arch)}, sights, {});
}

TEST(BuildScene, KnowsNothingFreeWithoutPictures) {
  const Scene scene = Build({});
  EXPECT_EQ(At(scene, 0.0, 0.0, 0.7), Space::kUnknown);
  EXPECT_EQ(At(scene, 1.5, 0.0, 0.7), Space::kOccupied);
  EXPECT_EQ(scene.revision, 3u);
}

TEST(BuildScene, SeesAnOpenPassageFree) {
  const Scene scene = Build(Look({test::FromSouth()}, {Arch{}.thing()}).sights);
  EXPECT_EQ(At(scene, 0.0, 0.0, 0.7), Space::kFree);
  EXPECT_EQ(At(scene, 0.0, -1.5, 0.7), Space::kFree);
  EXPECT_EQ(At(scene, 1.5, 0.0, 0.7), Space::kOccupied);
  EXPECT_EQ(At(scene, 1.8, 1.3, 0.7), Space::kUnknown);  // Behind the pier.
}

TEST(BuildScene, DoesNotTrustAnUntrustedPose) {
  auto sights = Look({test::FromSouth()}, {Arch{}.thing()}).sights;
  sights[0].has_trusted_pose = false;
  EXPECT_EQ(At(Build(sights), 0.0, 0.0, 0.7), Space::kUnknown);
}

TEST(BuildScene, TakesNothingForFreeThatTheModelDoesNotExplain) {
  const test::Thing beam = test::Block(test::Box(-0.8, -0.1, 0.8, 0.1), 0.6, 0.9, {20, 90, 140});
  const Scene scene = Build(Look({test::FromSouth(), test::FromNorth()}, {Arch{}.thing(), beam}).sights);
  EXPECT_NE(At(scene, 0.0, 0.0, 0.75), Space::kFree);
  EXPECT_NE(At(scene, 0.4, 0.05, 0.7), Space::kFree);
}

TEST(BuildScene, SeesABeamOfTheBuildingsOwnColour) {
  const test::Thing beam = test::Block(test::Box(-0.8, -0.1, 0.8, 0.1), 0.6, 0.9, test::kBlueWall);
  const Scene scene = Build(Look({test::FromSouth(), test::FromNorth()}, {Arch{}.thing(), beam}).sights);
  EXPECT_NE(At(scene, 0.0, 0.0, 0.75), Space::kFree);
}

TEST(BuildScene, TakesNoBarForGroundThatGoesOnBeforeTheJambs) {
  const cv::Vec3b like_ground(102, 104, 105);
  const test::Thing bar = test::Block(test::Box(-1.1, -0.95, 1.1, -0.85), 0.3, 0.4, like_ground);
  const std::vector<View> views = {test::FromSouth(), test::FromNorth()};
  EXPECT_EQ(At(Build(Look(views, {Arch{}.thing()}).sights), 0.0, -0.9, 0.35), Space::kFree);
  EXPECT_NE(At(Build(Look(views, {Arch{}.thing(), bar}).sights), 0.0, -0.9, 0.35), Space::kFree);
}

TEST(BuildScene, TakesNoBoxForGroundThatGoesOnBeforeTheSill) {
  const Arch window{.sill_m = 0.4};
  const test::Thing box = test::Block(test::Box(-0.3, -0.6, 0.3, 0.3), 0.4, 1.0, {102, 104, 105});
  const std::vector<View> views = {test::FromSouth(), test::FromNorth()};
  EXPECT_EQ(At(Build(Look(views, {window.thing()}).sights, window), 0.02, -0.17, 0.77), Space::kFree);
  const Scene scene = Build(Look(views, {window.thing(), box}).sights, window);
  for (const double z : {0.52, 0.77, 0.92}) EXPECT_NE(At(scene, 0.02, -0.17, z), Space::kFree) << z;
}

TEST(BuildScene, TakesNoPoleForGroundAndSomethingHoveringAboveIt) {
  // Before the sky it is strange, before the ground it is as grey as that.
  const test::Thing pole = test::Block(test::Box(-0.05, -0.05, 0.05, 0.05), 0.0, 1.45, {95, 97, 98});
  const std::vector<View> views = {test::FromSouth(), test::FromNorth()};
  const Scene scene = Build(Look(views, {Arch{}.thing(), pole}).sights);
  EXPECT_NE(At(scene, 0.02, 0.02, 1.27), Space::kFree);
  EXPECT_NE(At(scene, 0.02, 0.02, 0.87), Space::kFree);
}

TEST(BuildScene, LetsFarGreyThingsBehindLeaveAPassageFree) {
  const test::Thing north = test::Block(test::Box(-0.5, 40.0, 0.4, 42.0), 0.0, 3.0, {95, 97, 98});
  const test::Thing south = test::Block(test::Box(-0.4, -42.0, 0.6, -40.0), 0.0, 3.0, {95, 97, 98});
  const std::vector<View> views = {test::FromSouth(), test::FromNorth()};
  const Scene scene = Build(Look(views, {Arch{}.thing(), north, south}).sights);
  for (const double z : {0.27, 0.72, 1.07, 1.32}) EXPECT_EQ(At(scene, 0.02, 0.02, z), Space::kFree) << z;
}

TEST(BuildScene, PlacesAPoleWhereItStands) {
  const test::Thing pole = test::Block(test::Box(-0.05, -1.3, 0.05, -1.2), 0.0, 2.5, {30, 60, 30});
  const View aside = test::LevelView({-3.0, -4.5, 1.1}, 0.95);
  const Scene scene = Build(Look({test::FromSouth(), aside}, {Arch{}.thing(), pole}).sights);
  ASSERT_THAT(scene.obstacles, Not(IsEmpty()));
  EXPECT_LT((scene.obstacles[0].base_in_map_m - Eigen::Vector3d(0.0, -1.25, 0.0)).norm(), 0.15);
  EXPECT_EQ(At(scene, 0.0, -1.27, 0.5), Space::kOccupied);
}

TEST(BuildScene, DisputesGroundThatLooksDifferentFromTwoSides) {
  // A low box as grey as a shadow would be, seen from both sides: colour alone takes it for ground.
  const test::Thing box = test::Block(test::Box(-0.3, -0.2, 0.3, 0.2), 0.0, 0.45, {70, 71, 72});
  const Scene scene = Build(Look({test::FromSouth(), test::FromNorth()}, {Arch{}.thing(), box}).sights);
  EXPECT_NE(At(scene, 0.0, 0.0, 0.2), Space::kFree);
}

TEST(BuildScene, GivesTheSameBytesTwice) {
  const auto sights = Look({test::FromSouth(), test::FromNorth()}, {Arch{}.thing()}).sights;
  std::ostringstream a, b;
  Build(sights).octree->writeBinaryConst(a);
  Build(sights).octree->writeBinaryConst(b);
  EXPECT_EQ(a.str(), b.str());
}

TEST(BuildScene, MapsNothingWithoutAModel) {
  const Scene scene = BuildScene(1, {}, {}, Look({test::FromSouth()}, {Arch{}.thing()}).sights, {});
  ASSERT_NE(scene.octree, nullptr);
  EXPECT_EQ(scene.octree->size(), 0u);
}

TEST(FindNeighbours, ListsTheNearestFirst) {
  std::vector<Footprint> map(4);
  for (std::uint32_t i = 0; i < 4; ++i) {
    map[i].object_id = i + 1;
    map[i].polygon_in_map_m.outer = test::Box(10.0 * i * i, 0, 10.0 * i * i + 1, 1);
  }
  EXPECT_THAT(FindNeighbours(map[0], map, 2), ElementsAre(2u, 3u));
  EXPECT_THAT(FindNeighbours(map[0], map, 0), IsEmpty());
}

}  // namespace
}  // namespace soffit
