#include "service/solid/face_picture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace soffit {
namespace {

constexpr std::uint32_t kAbove = 1, kWall = 2;

/// 800 x 600 pixels, 90 degrees wide, upright or straight down with north up.
Sight Look(std::uint32_t capture_id, const Eigen::Vector3d& from, const Eigen::Vector3d& forward) {
  Sight sight;
  sight.capture_id = capture_id;
  sight.view.intrinsics = {800, 600, 400, 400, 399.5, 299.5, {}};
  sight.taken = sight.view.intrinsics;
  sight.shown = cv::Rect(0, 0, 800, 600);
  const bool is_down = std::abs(forward.z()) > 0.9;
  const Eigen::Vector3d right =
      is_down ? Eigen::Vector3d(1, 0, 0) : Eigen::Vector3d(forward.y(), -forward.x(), 0);
  Eigen::Matrix3d map_from_camera;
  map_from_camera << right, forward.cross(right), forward;
  sight.view.map_from_camera.rotation = Eigen::Quaterniond(map_from_camera);
  sight.view.map_from_camera.translation_m = from;
  return sight;
}

/// 4 m x 2 m, 2 m high, drawn from one picture above it.
Footprint Block() {
  Footprint footprint;
  footprint.object_id = 1;
  footprint.polygon_in_map_m.outer = {{0, 0}, {4, 0}, {4, 2}, {0, 2}};
  footprint.height_m = 2.0;
  footprint.silhouettes.resize(1);
  footprint.silhouettes[0].capture_id = kAbove;
  return footprint;
}

const Sight kFromAbove = Look(kAbove, {2, 1, 12}, {0, 0, -1});
const Sight kBeforeWall = Look(kWall, {2, -4, 1}, {0, 1, 0});

std::vector<Facade> Facades(int sides, int side, std::uint32_t capture_id) {
  std::vector<Facade> facades;
  for (int i = 0; i < sides; ++i) facades.push_back({1, i, 0.0, 2.0, 0.01, i == side, {}, capture_id});
  return facades;
}

const Face& Find(const Solid& solid, FaceKind kind, int wall = -1) {
  for (const Face& face : solid.faces) {
    if (face.kind == kind && face.wall == wall) return face;
  }
  throw std::out_of_range("no such face");
}

Solid Pictured(const Footprint& building, const std::vector<Facade>& facades,
               const std::vector<Sight>& sights) {
  return FindFacePictures({RaiseSolid(building, facades).value()}, facades, sights).front();
}

void ExpectBox(const Ring& ring, double left, double upper, double right, double lower) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& p : ring) box.extend(p);
  EXPECT_NEAR(box.min().x(), left, 1e-6);
  EXPECT_NEAR(box.min().y(), upper, 1e-6);
  EXPECT_NEAR(box.max().x(), right, 1e-6);
  EXPECT_NEAR(box.max().y(), lower, 1e-6);
}

TEST(FindFacePictures, TakesAWallFromThePictureOfItsFacadeAndTheRoofFromAbove) {
  const Solid solid = Pictured(Block(), Facades(4, 0, kWall), {kFromAbove, kBeforeWall});
  const auto& wall = Find(solid, FaceKind::kWall, 0).picture;
  ASSERT_TRUE(wall);
  EXPECT_EQ(wall->capture_id, kWall);
  EXPECT_NEAR(wall->shown_ratio, 1.0, 1e-9);
  ExpectBox(wall->outline_px.outer, 399.5 - 200, 299.5 - 100, 399.5 + 200, 299.5 + 100);
  const auto& roof = Find(solid, FaceKind::kRoof).picture;
  ASSERT_TRUE(roof);
  EXPECT_EQ(roof->capture_id, kAbove);
  ExpectBox(roof->outline_px.outer, 399.5 - 80, 299.5 - 40, 399.5 + 80, 299.5 + 40);
}

TEST(FindFacePictures, GivesNoneToTheGroundAndToAWallThatNoPictureShows) {
  const Solid solid = Pictured(Block(), Facades(4, 0, kWall), {kFromAbove, kBeforeWall});
  EXPECT_FALSE(Find(solid, FaceKind::kGround).picture);
  EXPECT_FALSE(Find(solid, FaceKind::kWall, 2).picture);
}

TEST(FindFacePictures, TakesNoPictureThatTheWallWasNotReadFrom) {
  const Solid solid = Pictured(Block(), Facades(4, -1, 0), {kFromAbove, kBeforeWall});
  EXPECT_FALSE(Find(solid, FaceKind::kWall, 0).picture);
}

TEST(FindFacePictures, TakesAWallThatNoFacadeShowsFromThePictureOfTheOutline) {
  const Solid solid = Pictured(Block(), {}, {Look(kAbove, {2, -4, 8}, {0, 0, -1})});
  const auto& wall = Find(solid, FaceKind::kWall, 0).picture;
  ASSERT_TRUE(wall);
  EXPECT_EQ(wall->capture_id, kAbove);
}

TEST(FindFacePictures, CutsAFaceAtThePicturesEdge) {
  const Solid solid = Pictured(Block(), Facades(4, 0, kWall), {Look(kWall, {4, -3, 1}, {0, 1, 0})});
  const auto& wall = Find(solid, FaceKind::kWall, 0).picture;
  ASSERT_TRUE(wall);
  EXPECT_NEAR(wall->shown_ratio, 0.75, 0.05);
  ExpectBox(wall->outline_px.outer, -0.5, 299.5 - 400.0 / 3, 399.5, 299.5 + 400.0 / 3);
}

TEST(FindFacePictures, CutsAFaceThatReachesBehindTheCamera) {
  const Solid solid = Pictured(Block(), Facades(4, 0, kWall), {Look(kWall, {1, -0.5, 1}, {1, 0, 0})});
  const auto& wall = Find(solid, FaceKind::kWall, 0).picture;
  ASSERT_TRUE(wall);
  EXPECT_GT(wall->shown_ratio, 0.5);
  EXPECT_LT(wall->shown_ratio, 0.8);
  ExpectBox(wall->outline_px.outer, -0.5, -0.5, 399.5 - 400 * 0.5 / 3, 599.5);
}

TEST(FindFacePictures, GivesNoneToAWallBehindAnotherWing) {
  Footprint u = Block();  // A courtyard, open to the north, before which the camera stands to the south.
  u.polygon_in_map_m.outer = {{0, 0}, {6, 0}, {6, 5}, {4, 5}, {4, 2}, {2, 2}, {2, 5}, {0, 5}};
  auto facades = Facades(8, -1, kWall);
  for (Facade& facade : facades) facade.was_seen = true;
  const Solid solid = Pictured(u, facades, {Look(kWall, {-5, 3.5, 1}, {1, 0, 0})});
  EXPECT_TRUE(Find(solid, FaceKind::kWall, 7).picture);
  EXPECT_FALSE(Find(solid, FaceKind::kWall, 3).picture);  // It faces the camera, behind the west wing.
}

TEST(FindFacePictures, TellsHowMuchOfAWallAnotherBuildingHides) {
  Footprint other = Block();
  other.object_id = 2;
  other.polygon_in_map_m.outer = {{2, -2.2}, {9, -2.2}, {9, -2}, {2, -2}};
  const auto facades = Facades(4, 0, kWall);
  const Solid wall = RaiseSolid(Block(), facades).value();
  const Solid screen = RaiseSolid(other, {}).value();
  const Solid seen = FindFacePictures({wall, screen}, facades, {kBeforeWall}).front();
  EXPECT_NEAR(Find(seen, FaceKind::kWall, 0).picture.value().shown_ratio, 0.5, 0.05);
}

TEST(FindFacePictures, TakesAPassageFromThePicturesOfItsEnds) {
  auto facades = Facades(4, -1, 0);
  Opening mouth;
  mouth.is_through = mouth.shows_background = true;
  mouth.ring_in_wall_m = {{1, 0}, {3, 0}, {3, 1.5}, {1, 1.5}};
  for (const int side : {0, 2}) {
    facades[static_cast<std::size_t>(side)].was_seen = true;
    facades[static_cast<std::size_t>(side)].openings = {mouth};
    facades[static_cast<std::size_t>(side)].capture_id = side == 0 ? 5 : 6;
  }
  const Solid solid =
      Pictured(Block(), facades, {Look(5, {2, -9, 1}, {0, 1, 0}), Look(6, {2, 4, 1}, {0, -1, 0})});
  const auto& ceiling = Find(solid, FaceKind::kCeiling, 0).picture;
  ASSERT_TRUE(ceiling);
  EXPECT_EQ(ceiling->capture_id, 6U);
  const auto& wall = Find(solid, FaceKind::kWall, 2).picture;
  ASSERT_TRUE(wall);
  EXPECT_EQ(wall->outline_px.outer.size(), 8U);
  EXPECT_TRUE(Contains(wall->outline_px, {100, 300}));
  EXPECT_FALSE(Contains(wall->outline_px, {400, 300}));  // The passage.
  EXPECT_TRUE(Contains(wall->outline_px, {700, 300}));
}

TEST(FindFacePictures, DrawsInThePictureAsItWasTaken) {
  Sight kept = kBeforeWall;
  kept.taken = {1600, 1200, 800, 800, 799.5, 599.5, {-0.1, 0.01, 0.001, -0.002, 0.0}};
  const Solid solid = Pictured(Block(), Facades(4, 0, kWall), {kept});
  const Ring& ring = Find(solid, FaceKind::kWall, 0).picture.value().outline_px.outer;
  const Eigen::Vector2d corner = PixelOf(kept.taken, {-0.5, -0.25});
  const auto nearest = [&](const Eigen::Vector2d& p) {
    double distance = 1e9;
    for (const Eigen::Vector2d& q : ring) distance = std::min(distance, (p - q).norm());
    return distance;
  };
  EXPECT_LT(nearest(corner), 1e-6);
  EXPECT_LT(DistanceToRing(PixelOf(kept.taken, {0.13, -0.25}), ring), 0.2);  // Bent between its corners.
  for (const Eigen::Vector2d& p : ring) EXPECT_TRUE(p.x() > 300 && p.x() < 1300) << p.transpose();
}

}  // namespace
}  // namespace soffit
