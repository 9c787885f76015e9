#include "service/footprint/footprint.h"

#include <gmock/gmock.h>

#include "service/footprint/carve.h"
#include "shared/result/result.h"
#include "test/support/aerial_world.h"

namespace soffit {
namespace {

using test::Block;
using test::Box;
using test::LookDown;
using test::LShape;
using test::RelativeDifference;
using test::TraceBlocks;
using test::Turned;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Gt;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const Ring kBeside = Turned(Box(2.0, 1.2), 0.4, {2.4, 0.9});

TEST(TraceFootprints, TakesTheLeanOfABoxOffAndTellsItsHeight) {
  const auto footprints = TraceBlocks(LookDown({0, 0, 9}), 1, {{kBeside, 1.5}});
  ASSERT_THAT(footprints, SizeIs(1));
  EXPECT_NEAR(footprints[0].height_m, 1.5, 0.06);
  EXPECT_THAT(footprints[0].polygon_in_map_m.outer, SizeIs(4));
  EXPECT_LT(RelativeDifference(kBeside, footprints[0].polygon_in_map_m.outer), 0.03);
  EXPECT_FALSE(footprints[0].is_cut);
  EXPECT_THAT(footprints[0].captures, ElementsAre(1));
}

TEST(TraceFootprints, HandlesATiltedCamera) {
  const auto footprints = TraceBlocks(LookDown({0, 0, 9}, 1.1, 0.15), 1, {{kBeside, 1.5}});
  ASSERT_THAT(footprints, SizeIs(1));
  EXPECT_NEAR(footprints[0].height_m, 1.5, 0.06);
  EXPECT_LT(RelativeDifference(kBeside, footprints[0].polygon_in_map_m.outer), 0.03);
}

TEST(TraceFootprints, StraightensAnLWithItsInnerCorner) {
  const Ring shape = Turned(LShape(), 2.0, {2.5, -1.0});
  const auto footprints = TraceBlocks(LookDown({0, 0, 12}), 1, {{shape, 2.0}});
  ASSERT_THAT(footprints, SizeIs(1));
  EXPECT_NEAR(footprints[0].height_m, 2.0, 2.0 * footprints[0].height_std_m);
  EXPECT_LT(footprints[0].height_std_m, 0.5);
  EXPECT_THAT(footprints[0].polygon_in_map_m.outer, SizeIs(6));
  EXPECT_LT(RelativeDifference(shape, footprints[0].polygon_in_map_m.outer), 0.05);
}

/// Walls that show in the notch are of the roof's colour. In the second picture the wing's lean fills the
/// notch in part, and the dent of the passage goes on to the inner corner.
TEST(MergeFootprints, DrawsAnLWithAPassageInOneWing) {
  const Ring ell = {{-1.95, -1.25}, {1.95, -1.25}, {1.95, -0.05},
                    {-0.85, -0.05}, {-0.85, 1.25}, {-1.95, 1.25}};
  const Ring stem = {{-1.95, -1.25}, {-0.4, -1.25}, {-0.4, -0.05},
                     {-0.85, -0.05}, {-0.85, 1.25}, {-1.95, 1.25}};
  const Ring pier = {{1.3, -1.25}, {1.95, -1.25}, {1.95, -0.05}, {1.3, -0.05}};
  const double turn = 1.2;
  const Eigen::Vector2d at(2.5, 0.1);
  const std::vector<Block> house = {
      {Turned(stem, turn, at), 1.5}, {Turned(pier, turn, at), 1.5}, {Turned(ell, turn, at), 2.2, 1.5}};
  auto map = MergeFootprints({}, TraceBlocks(LookDown({0, 0, 9}), 1, house));
  map = MergeFootprints(map, TraceBlocks(LookDown({3.9, 1.2, 6.5}, 1.0), 2, house));
  map = MergeFootprints(map, TraceBlocks(LookDown({2.5, 0.1, 6.5}, 2.0), 3, house));
  ASSERT_THAT(map, SizeIs(1));
  EXPECT_THAT(map[0].polygon_in_map_m.outer, SizeIs(6));
  EXPECT_LT(RelativeDifference(Turned(ell, turn, at), map[0].polygon_in_map_m.outer), 0.03);
  EXPECT_NEAR(map[0].height_m, 2.2, 0.03);
}

/// The reported poses contradict each other by many pixels.
TEST(MergeFootprints, KeepsTheShapeWhenPosesAreNoisy) {
  const Ring ell = Turned(LShape(), 0.7, {0.5, -0.5});
  std::vector<Footprint> map;
  std::uint32_t id = 0;
  for (const Eigen::Vector3d& from :
       {Eigen::Vector3d(0, 0, 11), Eigen::Vector3d(2, 1, 9), Eigen::Vector3d(0, 2, 9)}) {
    ++id;
    View reported = LookDown(from, 0.4 * id);
    const double sign = id % 2 == 0 ? 1.0 : -1.0;
    const Eigen::AngleAxisd turn(0.006, Eigen::Vector3d(sign, 0.5, -sign).normalized());
    const View view = reported;
    reported.position_std_m = 0.05;
    reported.orientation_std_rad = 0.006;
    reported.map_from_camera.translation_m += Eigen::Vector3d(0.05 * sign, -0.04, 0.03 * sign);
    reported.map_from_camera.rotation = turn * reported.map_from_camera.rotation;
    map = MergeFootprints(map, TraceBlocks(view, id, {{ell, 2.0}}, reported));
  }
  ASSERT_THAT(map, SizeIs(1));
  Ring ring = map[0].polygon_in_map_m.outer;
  ASSERT_THAT(ring, SizeIs(6));
  EXPECT_NEAR(map[0].height_m, 2.0, 3.0 * map[0].height_std_m);
  EXPECT_LT(map[0].height_std_m, 0.1);
  const Eigen::Vector2d shift = Centroid({ell, {}}) - Centroid({ring, {}});
  EXPECT_LT(shift.norm(), 0.1);
  EXPECT_THAT(map[0].corner_std_m, Each(Gt(0.02)));
  for (Eigen::Vector2d& p : ring) p += shift;
  EXPECT_LT(RelativeDifference(ell, ring), 0.04);
}

/// Two of its sides run as the upright edges of a tall building would.
TEST(TraceFootprints, DoesNotTakeASideThatHappensToBeRadialForAWall) {
  const Ring ell = {{-4.0, -0.6}, {-2.0, -0.6}, {-2.0, 0.0}, {-3.2, 0.0}, {-3.2, 2.0}, {-4.0, 2.0}};
  const auto footprints = TraceBlocks(LookDown({0, 0, 9}), 1, {{ell, 0.01}});
  ASSERT_THAT(footprints, SizeIs(1));
  EXPECT_THAT(footprints[0].polygon_in_map_m.outer, SizeIs(6));
  EXPECT_LT(RelativeDifference(ell, footprints[0].polygon_in_map_m.outer), 0.03);
}

/// Seen from the side, ground shows through the opening: the blob has a dent that the building has not.
TEST(TraceFootprints, DoesNotTakeAnOpeningForANotch) {
  const Block left{Turned(Box(1.2, 1.5), 0.0, {2.6, -1.4}), 1.4};
  const Block right{Turned(Box(1.2, 1.5), 0.0, {2.6, 1.4}), 1.4};
  const Ring roof = Turned(Box(1.2, 4.3), 0.0, {2.6, 0.0});
  const auto footprints = TraceBlocks(LookDown({0, 0, 9}), 1, {left, right, {roof, 2.0, 1.4}});
  ASSERT_THAT(footprints, SizeIs(1));
  EXPECT_THAT(footprints[0].polygon_in_map_m.outer, SizeIs(4));
  EXPECT_LT(RelativeDifference(roof, footprints[0].polygon_in_map_m.outer), 0.03);
}

TEST(TraceFootprints, DoesNotKnowTheHeightOfWhatLiesRightBeneath) {
  const auto footprints = TraceBlocks(LookDown({0, 0, 9}), 1, {{Box(3, 2), 2.0}});
  ASSERT_THAT(footprints, SizeIs(1));
  EXPECT_EQ(footprints[0].height_m, 0.0);
  EXPECT_EQ(footprints[0].height_std_m, 0.0);
}

TEST(TraceFootprints, TakesAChimneyForNoCourtyard) {
  const View view = LookDown({0, 0, 9});
  Mask mask = test::Photograph(view, {{Turned(Box(3.0, 3.0), 0.4), 1.5}});
  const Eigen::Vector2d chimney = *Project(view, {0.3, 0.2, 1.5});
  cv::circle(mask.label, {static_cast<int>(chimney.x()), static_cast<int>(chimney.y())}, 14, cv::Scalar(0),
             -1);
  Image image;
  image.view = view;
  image.seen = cv::Rect({0, 0}, mask.label.size());
  const auto outlines = TraceOutlines(mask, image.seen, {});
  ASSERT_THAT(outlines, SizeIs(1));
  ASSERT_THAT(outlines[0].polygon_px.holes, SizeIs(1));
  const auto footprints = TraceFootprints(image, outlines, {});
  ASSERT_THAT(footprints, SizeIs(1));
  EXPECT_THAT(footprints[0].polygon_in_map_m.holes, IsEmpty());
}

TEST(TraceFootprints, MarksWhatThePictureCuts) {
  const auto footprints = TraceBlocks(LookDown({0, 0, 9}), 1, {{Box(30, 2), 2.0}});
  ASSERT_THAT(footprints, SizeIs(1));
  EXPECT_TRUE(footprints[0].is_cut);
}

TEST(TraceFootprints, LeavesOutWhatIsTooSmall) {
  EXPECT_THAT(TraceBlocks(LookDown({0, 0, 9}), 1, {{Box(0.3, 0.3), 0.2}}), IsEmpty());
  EXPECT_THAT(TraceBlocks(LookDown({0, 0, 9}), 1, {}), IsEmpty());
}

TEST(TraceFootprints, RefusesACameraThatDoesNotLookDown) {
  Image image;
  image.view = LookDown({0, 0, 9});
  image.view.map_from_camera.rotation = CameraAttitude(0.0, -0.7);
  EXPECT_THROW(TraceFootprints(image, {}, {}), ContractViolation);
}

TEST(MergeFootprints, TellsTheHeightByParallax) {
  const std::vector<Block> blocks = {{Turned(Box(3, 2), 0.2), 2.0}};
  const auto high = TraceBlocks(LookDown({0.1, 0.1, 9}), 1, blocks);
  const auto low = TraceBlocks(LookDown({-0.1, 0.05, 6.5}, 1.0), 2, blocks);
  const auto map = MergeFootprints(MergeFootprints({}, high), low);
  ASSERT_THAT(map, SizeIs(1));
  EXPECT_NEAR(map[0].height_m, 2.0, 0.05);
  EXPECT_GT(map[0].height_std_m, 0.0);
  EXPECT_LT(map[0].height_std_m, 0.2);
  EXPECT_LT(RelativeDifference(blocks[0].ring_in_map_m, map[0].polygon_in_map_m.outer), 0.02);
  EXPECT_THAT(map[0].captures, ElementsAre(1, 2));
}

TEST(MergeFootprints, KeepsIdsAndNumbersNewBuildings) {
  const Block first{Turned(Box(3, 2), 0.2), 2.0};
  const Block second{Turned(Box(1.5, 1.5), 0.2, {4, 1}), 1.0};
  const auto map = MergeFootprints({}, TraceBlocks(LookDown({0, 0, 7}), 1, {first}));
  ASSERT_THAT(map, SizeIs(1));
  const auto more = MergeFootprints(map, TraceBlocks(LookDown({2, 0, 12}), 2, {second, first}));
  ASSERT_THAT(more, SizeIs(2));
  EXPECT_EQ(more[0].object_id, 1u);
  EXPECT_EQ(more[1].object_id, 2u);
  EXPECT_LT(RelativeDifference(first.ring_in_map_m, more[0].polygon_in_map_m.outer), 0.04);
}

TEST(MergeFootprints, LetsAWholeViewWinOverACutOne) {
  const std::vector<Block> blocks = {{Turned(Box(6, 2), 0.2), 1.0}};
  const auto cut = TraceBlocks(LookDown({3.5, 0, 5}), 1, blocks);
  ASSERT_THAT(cut, SizeIs(1));
  ASSERT_TRUE(cut[0].is_cut);
  const auto map = MergeFootprints(MergeFootprints({}, cut), TraceBlocks(LookDown({0, 1, 12}), 2, blocks));
  ASSERT_THAT(map, SizeIs(1));
  EXPECT_FALSE(map[0].is_cut);
}

/// What each of the cameras shows, all looking north, in one map.
std::vector<Footprint> MapFrom(const std::vector<Eigen::Vector3d>& cameras,
                               const std::vector<Block>& blocks) {
  std::vector<Footprint> map;
  std::uint32_t id = 0;
  for (const Eigen::Vector3d& from : cameras)
    map = MergeFootprints(map, TraceBlocks(LookDown(from, std::numbers::pi / 2), ++id, blocks));
  return map;
}

TEST(MergeFootprints, PutsABuildingTogetherThatEveryPictureCuts) {
  const Ring ell = Turned({{-8, 0}, {8, 0}, {8, 3}, {-4, 3}, {-4, 6}, {-8, 6}}, 0.1);
  for (const double height_m : {0.0, 2.5}) {
    const auto map = MapFrom({{-5, 2, 10}, {4, 2, 10}}, {{ell, height_m}});
    ASSERT_THAT(map, SizeIs(1));
    EXPECT_FALSE(map[0].is_cut);
    EXPECT_THAT(map[0].captures, ElementsAre(1, 2));
    EXPECT_THAT(map[0].polygon_in_map_m.outer, SizeIs(6));
    EXPECT_LT(RelativeDifference(ell, map[0].polygon_in_map_m.outer), 0.02);
    EXPECT_NEAR(map[0].height_m, height_m, 0.1);
  }
}

TEST(MergeFootprints, PutsPartsTogetherInAnyOrder) {
  const Ring bar = Turned(Box(30, 3), 0.05);
  const auto map = MapFrom({{-11, 0, 10}, {11, 0, 10}, {0, 0, 10}}, {{bar, 2.0}});
  ASSERT_THAT(map, SizeIs(1));
  EXPECT_EQ(map[0].object_id, 1u);
  EXPECT_FALSE(map[0].is_cut);
  EXPECT_THAT(map[0].polygon_in_map_m.outer, SizeIs(4));
  EXPECT_LT(RelativeDifference(bar, map[0].polygon_in_map_m.outer), 0.02);
}

TEST(MergeFootprints, LeavesPartsCutThatNoPictureJoins) {
  const auto map = MapFrom({{-11, 0, 10}, {11, 0, 10}}, {{Box(30, 3), 2.0}});
  ASSERT_THAT(map, SizeIs(2));
  EXPECT_TRUE(map[0].is_cut);
  EXPECT_TRUE(map[1].is_cut);
}

TEST(MergeFootprints, KeepsNeighboursApartThatPicturesCut) {
  const std::vector<Block> blocks = {{Turned(Box(6, 3), 0.0, {-9, 0}), 2.0},
                                     {Turned(Box(12, 3), 0.0, {1, 0}), 2.0}};
  const auto map = MapFrom({{-9, 0, 10}, {4, 0, 10}}, blocks);
  ASSERT_THAT(map, SizeIs(2));
  EXPECT_FALSE(map[0].is_cut && map[1].is_cut);
}

/// Two buildings of one colour, of which one hides the foot of the other in the overview.
TEST(MergeFootprints, TakesABlobOfTwoBuildingsApart) {
  const Block near{Turned(Box(2.5, 1.5), 0.3, {2.0, 0.0}), 2.0};
  const Block far{Turned(Box(1.5, 2.0), 0.3, {4.1, 0.5}), 1.2};
  const auto blob = TraceBlocks(LookDown({0, 0, 10}), 1, {near, far});
  ASSERT_THAT(blob, SizeIs(1));
  auto map = MergeFootprints({}, blob);
  map = MergeFootprints(map, TraceBlocks(LookDown({2.05, 0.1, 6}), 2, {near}));
  map = MergeFootprints(map, TraceBlocks(LookDown({4.0, 0.4, 5}), 3, {far}));
  ASSERT_THAT(map, SizeIs(2));
  EXPECT_FALSE(map[0].is_cut);
  EXPECT_FALSE(map[1].is_cut);
  EXPECT_NEAR(map[0].height_m, near.height_m, 0.08);
  EXPECT_NEAR(map[1].height_m, far.height_m, 0.08);
  EXPECT_LT(RelativeDifference(near.ring_in_map_m, map[0].polygon_in_map_m.outer), 0.05);
  EXPECT_LT(RelativeDifference(far.ring_in_map_m, map[1].polygon_in_map_m.outer), 0.05);
}

TEST(MergeFootprints, LearnsTheHeightFromAViewThatTheEdgeCuts) {
  const Ring ring = Turned(Box(3, 2), 0.2);
  const auto above = TraceBlocks(LookDown({0.1, 0, 7}), 1, {{ring, 2.0}});
  const auto cut = TraceBlocks(LookDown({5.2, 0, 7}, 0.0), 2, {{ring, 2.0}});
  ASSERT_THAT(cut, SizeIs(1));
  ASSERT_TRUE(cut[0].is_cut);
  const auto map = MergeFootprints(MergeFootprints({}, above), cut);
  ASSERT_THAT(map, SizeIs(1));
  EXPECT_NEAR(map[0].height_m, 2.0, 0.05);
}

TEST(MergeFootprints, GivesTheSameForTheSame) {
  const std::vector<Block> blocks = {{kBeside, 1.5}, {Turned(LShape(), 1.0, {-4, 0}), 2.0}};
  const auto once = MergeFootprints({}, TraceBlocks(LookDown({0, 0, 12}), 1, blocks));
  const auto again = MergeFootprints({}, TraceBlocks(LookDown({0, 0, 12}), 1, blocks));
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].polygon_in_map_m.outer, again[i].polygon_in_map_m.outer);
    EXPECT_EQ(once[i].height_m, again[i].height_m);
  }
}

TEST(WithHeight, DrawsTheTrueSizeForTheTrueHeight) {
  const Ring ring = Turned(Box(3, 2), 0.2);
  const auto seen = TraceBlocks(LookDown({0, 0, 9}), 1, {{ring, 2.0}});
  ASSERT_THAT(seen, SizeIs(1));
  EXPECT_GT(RelativeDifference(ring, seen[0].polygon_in_map_m.outer), 0.3);
  const Footprint right = WithHeight(seen[0], 2.0, 0.05);
  EXPECT_LT(RelativeDifference(ring, right.polygon_in_map_m.outer), 0.02);
  EXPECT_EQ(right.height_m, 2.0);
  EXPECT_EQ(right.height_std_m, 0.05);
  EXPECT_EQ(right.corner_std_m.size(), right.polygon_in_map_m.outer.size());
}

TEST(WithHeight, RefusesAHeightAboveTheCamera) {
  const auto seen = TraceBlocks(LookDown({0, 0, 9}), 1, {{Box(3, 2), 2.0}});
  ASSERT_THAT(seen, SizeIs(1));
  EXPECT_THROW(WithHeight(seen[0], 9.5, 0.1), ContractViolation);
  EXPECT_THROW(WithHeight(seen[0], 0.0, 0.1), ContractViolation);
}

TEST(Carve, KeepsACourtyard) {
  Silhouette silhouette;
  silhouette.view = LookDown({0, 0, 10});
  const double k = 850.0 / 10.0;
  const auto square = [&](double half, bool reversed) {
    Ring ring;
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
      ring.emplace_back(635.2 + x * half * k, 483.1 + y * half * k);
    if (reversed) std::reverse(ring.begin(), ring.end());
    return ring;
  };
  silhouette.outline.polygon_px = {square(2.5, false), {square(1.0, true)}};
  const Polygon carved = Carve(silhouette, 2.0);
  ASSERT_THAT(carved.holes, SizeIs(1));
  EXPECT_NEAR(SignedArea(carved.outer), 16.0, 0.2);     // Roof edges shrink by 8 / 10.
  EXPECT_NEAR(SignedArea(carved.holes[0]), -4.0, 0.2);  // The court's base is seen itself.
}

}  // namespace
}  // namespace soffit
