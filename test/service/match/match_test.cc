#include "service/match/match.h"

#include <gmock/gmock.h>

#include <numbers>
#include <opencv2/imgproc.hpp>

#include "service/match/similarity.h"
#include "service/match/word.h"

namespace soffit {
namespace {

using std::numbers::pi;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const Ring kL = {{0, 0}, {40, 0}, {40, 15}, {15, 15}, {15, 30}, {0, 30}};
const Ring kT = {{0, 0}, {40, 0}, {40, 12}, {27, 12}, {27, 35}, {13, 35}, {13, 12}, {0, 12}};
const Ring kBox = {{0, 0}, {30, 0}, {30, 20}, {0, 20}};
const Ring kSquare = {{0, 0}, {20, 0}, {20, 20}, {0, 20}};

Ring Mirrored(Ring ring) {
  for (Eigen::Vector2d& p : ring) p.x() = -p.x();
  return {ring.rbegin(), ring.rend()};
}

Similarity Laid(double scale, double rotation_cw_rad, double x, double y) {
  return {scale * std::cos(-rotation_cw_rad), scale * std::sin(-rotation_cw_rad), {x, y}};
}

Polygon Shape(const Ring& ring) { return {ring, {}}; }

/// Perfectly drawn shapes.
std::vector<TracedShape> Drawn(const std::vector<Polygon>& polygons) {
  std::vector<TracedShape> shapes;
  for (const Polygon& polygon : polygons) shapes.push_back({polygon});
  return shapes;
}

std::vector<Match> Find(const std::vector<Polygon>& map, const std::vector<Polygon>& reference) {
  return FindMatches(Drawn(map), {Drawn(reference)}, {});
}

TEST(FindMatches, FindsScaleClockwiseRotationAndPlace) {
  const std::vector<Polygon> map = {Laid(2.0, 1.0, 300, 10) * Shape(kT), Laid(0.7, 2.2, -50, 80) * Shape(kL)};
  const auto matches = Find(map, {Shape(kL)});
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_THAT(matches[0].shapes, ElementsAre(1));
  EXPECT_NEAR(matches[0].scale, 0.7, 1e-3);
  EXPECT_NEAR(matches[0].rotation_cw_rad, 2.2, 1e-3);
  EXPECT_NEAR(matches[0].translation.x(), -50, 0.1);
  EXPECT_NEAR(matches[0].translation.y(), 80, 0.1);
  EXPECT_GT(matches[0].score, 0.99);
  EXPECT_FALSE(matches[0].is_ambiguous);
  EXPECT_THAT(matches[0].equivalent_rotations_cw_rad, SizeIs(1));
}

TEST(FindMatches, FindsEveryRotation) {
  for (int i = 0; i < 24; ++i) {
    const double rotation = 2.0 * pi * i / 24.0;
    const auto matches = Find({Laid(1.3, rotation, 5, 5) * Shape(kT)}, {Shape(kT)});
    ASSERT_THAT(matches, SizeIs(1)) << i;
    EXPECT_NEAR(std::remainder(matches[0].rotation_cw_rad - rotation, 2.0 * pi), 0.0, 1e-3);
  }
}

TEST(FindMatches, RejectsMirrorImages) {
  for (const double rotation : {0.0, 0.8, 2.5, 4.4}) {
    EXPECT_THAT(Find({Laid(1.0, rotation, 0, 0) * Shape(Mirrored(kL))}, {Shape(kL)}), IsEmpty());
  }
}

TEST(FindMatches, RejectsNearTwins) {
  Ring longer = kL;
  longer[4].y() = longer[5].y() = 36;  // One wing is a fifth longer.
  Ring thicker = kL;
  thicker[2].y() = thicker[3].y() = 19;
  for (const Ring& twin : {longer, thicker}) EXPECT_THAT(Find({Shape(twin)}, {Shape(kL)}), IsEmpty());
}

TEST(FindMatches, ForgivesWhatTheRoughnessOfTheDrawingsExplains) {
  Ring bent = kL;
  for (std::size_t i = 0; i < bent.size(); ++i)
    bent[i] += Eigen::Vector2d(i % 2 ? 0.9 : -0.9, i % 3 ? 0.7 : -0.7);
  EXPECT_THAT(Find({Shape(bent)}, {Shape(kL)}), IsEmpty());
  EXPECT_THAT(FindMatches({{Shape(bent), 1.0}}, {{{Shape(kL), 1.0}}}, {}), SizeIs(1));
}

TEST(FindMatches, ListsAllRotationsOfASymmetricShape) {
  const auto boxes = Find({Laid(1.0, 0.5, 0, 0) * Shape(kBox)}, {Shape(kBox)});
  ASSERT_THAT(boxes, SizeIs(1));
  EXPECT_THAT(boxes[0].equivalent_rotations_cw_rad, SizeIs(2));
  const auto squares = Find({Laid(1.0, 0.5, 0, 0) * Shape(kSquare)}, {Shape(kSquare)});
  ASSERT_THAT(squares, SizeIs(1));
  EXPECT_THAT(squares[0].equivalent_rotations_cw_rad, SizeIs(4));
  EXPECT_FALSE(squares[0].is_ambiguous);
}

TEST(FindMatches, MarksSeveralPlacesAsAmbiguous) {
  const auto matches = Find({Shape(kL), Laid(2.0, 1.0, 200, 0) * Shape(kL), Shape(kT)}, {Shape(kL)});
  ASSERT_THAT(matches, SizeIs(2));
  EXPECT_TRUE(matches[0].is_ambiguous);
  EXPECT_TRUE(matches[1].is_ambiguous);
}

TEST(FindMatches, CallsALoneBoxAmbiguousAmongBoxesOfNearlyItsProportion) {
  const Polygon longer = Laid(1.0, 0.4, 100, 0) * Shape({{0, 0}, {34, 0}, {34, 20}, {0, 20}});
  const Polygon shorter = Laid(1.5, 1.1, 0, 100) * Shape({{0, 0}, {27, 0}, {27, 20}, {0, 20}});
  const auto matches = Find({Shape(kBox), longer, shorter}, {Shape(kBox)});
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_TRUE(matches[0].is_ambiguous);
}

TEST(FindMatches, IsSureOfAShapeThatSharesMoreThanAProportion) {
  Ring longer = kL;
  longer[1].x() = longer[2].x() = 46;
  const auto matches = Find({Shape(kL), Laid(1.5, 1.1, 0, 100) * Shape(longer)}, {Shape(kL)});
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_FALSE(matches[0].is_ambiguous);
}

TEST(FindMatches, TakesABlobTooSmallToHaveAFormForNothing) {
  const Polygon blob = Laid(0.1, 0.3, 0, 0) * Shape(kBox);
  EXPECT_THAT(FindMatches({{blob, 0.4}}, {Drawn({Shape(kL)})}, {}), IsEmpty());
}

TEST(FindMatches, TellsHolesApart) {
  const Polygon open = Shape(kSquare);
  const Polygon court{kSquare, {{{6, 6}, {6, 14}, {14, 14}, {14, 6}}}};
  const Polygon offset{kSquare, {{{3, 6}, {3, 14}, {11, 14}, {11, 6}}}};
  const std::vector<Polygon> map = {open, court, offset};
  const auto matches = Find(map, {court});
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_THAT(matches[0].shapes, ElementsAre(1));
  const auto of_offset = Find(map, {offset});
  ASSERT_THAT(of_offset, SizeIs(1));
  EXPECT_THAT(of_offset[0].shapes, ElementsAre(2));
  EXPECT_THAT(of_offset[0].equivalent_rotations_cw_rad, SizeIs(1));
}

TEST(FindMatches, ForgivesAHoleTooNarrowToBeDrawn) {
  const auto with_slit = [](double width) {
    return Polygon{kT, {{{18, 14}, {18, 30}, {18 + width, 30}, {18 + width, 14}}}};
  };
  EXPECT_THAT(Find({Shape(kT)}, {with_slit(0.3)}), SizeIs(1));
  EXPECT_THAT(Find({with_slit(0.3)}, {Shape(kT)}), SizeIs(1));
  EXPECT_THAT(Find({Shape(kT)}, {with_slit(4.0)}), IsEmpty());
  EXPECT_THAT(Find({with_slit(4.0)}, {Shape(kT)}), IsEmpty());
}

TEST(FindMatches, FindsAGroupAmongIdenticalBoxes) {
  const std::vector<Polygon> group = {Laid(1, 0, 0, 0) * Shape(kBox), Laid(1, 0.5, 70, 10) * Shape(kBox),
                                      Laid(1, 1.3, 20, 90) * Shape(kBox)};
  const Similarity place = Laid(0.4, 2.0, 500, 300);
  std::vector<Polygon> map;
  for (int i = 0; i < 20; ++i)
    map.push_back(Laid(0.4, i * 0.7, 60.0 * (i % 5), 60.0 * (i / 5)) * Shape(kBox));
  for (const Polygon& shape : group) map.push_back(place * shape);
  const auto matches = Find(map, group);
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_THAT(matches[0].shapes, ElementsAre(20, 21, 22));
  EXPECT_NEAR(matches[0].scale, 0.4, 1e-3);
  EXPECT_NEAR(matches[0].rotation_cw_rad, 2.0, 1e-3);
  EXPECT_FALSE(matches[0].is_ambiguous);
}

TEST(FindMatches, AllowsForThePositionsOfAGroupAsWellAsTheyAreKnown) {
  const std::vector<Polygon> group = {Shape(kL), Laid(1, 0.5, 70, 10) * Shape(kT),
                                      Laid(1, 1.3, 20, 90) * Shape(kBox)};
  std::vector<TracedShape> map = Drawn(group);
  for (Eigen::Vector2d& p : map[1].polygon.outer) p += Eigen::Vector2d(4.0, -3.0);
  EXPECT_THAT(FindMatches(map, {Drawn(group)}, {}), IsEmpty());
  for (TracedShape& shape : map) shape.position_std = 4.0;
  EXPECT_THAT(FindMatches(map, {Drawn(group)}, {}), SizeIs(1));
}

TEST(FindMatches, FindsNothingWhereNothingIs) {
  EXPECT_THAT(Find({}, {Shape(kL)}), IsEmpty());
  EXPECT_THAT(Find({Shape(kT), Shape(kBox)}, {Shape(kL)}), IsEmpty());
}

TEST(FindMatches, SkipsDegenerateShapesOfTheMap) {
  const std::vector<Polygon> map = {{}, Shape({{0, 0}, {1, 1}}), Shape({{0, 0}, {1, 0}, {2, 0}}), Shape(kL)};
  const auto matches = Find(map, {Shape(kL)});
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_THAT(matches[0].shapes, ElementsAre(3));
}

TEST(FindMatches, RefusesADegenerateReference) {
  EXPECT_THROW(Find({Shape(kL)}, {}), ContractViolation);
  EXPECT_THROW(Find({Shape(kL)}, {Shape({{0, 0}, {1, 0}})}), ContractViolation);
}

TEST(FindMatches, KeepsPrecisionFarFromTheOrigin) {
  const auto matches = Find({Laid(0.5, 1.0, 691000, 5335000) * Shape(kL)}, {Shape(kL)});
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_NEAR(matches[0].translation.x(), 691000, 0.05);
  EXPECT_NEAR(matches[0].translation.y(), 5335000, 0.05);
}

TEST(FindMatches, GivesTheSameForTheSame) {
  const std::vector<Polygon> map = {Laid(1, 0.3, 0, 0) * Shape(kL), Laid(2, 1.3, 90, 0) * Shape(kL)};
  const auto once = Find(map, {Shape(kL)});
  const auto again = Find(map, {Shape(kL)});
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].score, again[i].score);
    EXPECT_EQ(once[i].rotation_cw_rad, again[i].rotation_cw_rad);
  }
}

TEST(AlignWords, ForgivesASplitSide) {
  Ring split = kBox;
  split.insert(split.begin() + 1, Eigen::Vector2d(14, -1.5));
  const Word whole = Spell(kBox, 0.5);
  const Word broken = Spell(split, 0.5);
  ASSERT_EQ(broken.size(), whole.size() + 1);
  const auto alignments = AlignWords(whole, broken);
  ASSERT_FALSE(alignments.empty());
  EXPECT_LT(alignments.front().cost, 0.08);
  EXPECT_NEAR(std::remainder(alignments.front().rotation_ccw_rad, pi), 0.0, 0.05);
}

cv::Mat1b Bitmap(const std::vector<Ring>& shapes, cv::Size size) {
  cv::Mat1b bitmap(size, uchar{255});
  for (const Ring& ring : shapes) {
    std::vector<cv::Point> corners;
    for (const Eigen::Vector2d& p : ring)
      corners.emplace_back(static_cast<int>(p.x()), static_cast<int>(p.y()));
    cv::fillPoly(bitmap, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(0));
  }
  return bitmap;
}

TEST(ReadReference, ReadsBlackShapesYUp) {
  const auto reference = ReadReference(Bitmap({{{20, 10}, {59, 10}, {59, 29}, {20, 29}}}, {100, 60}));
  ASSERT_TRUE(reference.ok());
  ASSERT_THAT(reference.value().shapes, SizeIs(1));
  EXPECT_NEAR(SignedArea(reference.value().shapes[0].polygon.outer), 800.0, 1.0);
  EXPECT_NEAR(Centroid(reference.value().shapes[0].polygon).x(), 39.5, 0.1);
  EXPECT_NEAR(Centroid(reference.value().shapes[0].polygon).y(), -19.5, 0.1);
}

TEST(ReadReference, DropsSpecks) {
  cv::Mat1b bitmap = Bitmap({{{20, 10}, {79, 10}, {79, 49}, {20, 49}}}, {100, 60});
  for (int i = 0; i < 8; ++i) bitmap(5, 10 * i + 3) = 0;
  const auto reference = ReadReference(bitmap);
  ASSERT_TRUE(reference.ok());
  EXPECT_THAT(reference.value().shapes, SizeIs(1));
}

TEST(ReadReference, KeepsTheShedBesideAHall) {
  const auto reference = ReadReference(
      Bitmap({{{20, 10}, {279, 10}, {279, 189}, {20, 189}}, {{300, 20}, {319, 20}, {319, 34}, {300, 34}}},
             {340, 200}));
  ASSERT_TRUE(reference.ok());
  EXPECT_THAT(reference.value().shapes, SizeIs(2));
}

/// As a map is drawn: a pixel is black when its centre lies inside.
cv::Mat1b Drawing(const Polygon& polygon, cv::Size size) {
  cv::Mat1b bitmap(size, uchar{255});
  for (int row = 0; row < size.height; ++row) {
    for (int col = 0; col < size.width; ++col) {
      if (Contains(polygon, {col, -row})) bitmap(row, col) = 0;
    }
  }
  return bitmap;
}

TEST(ReadReference, KeepsWhatIsAsSmallAsAPixelForTheMatch) {
  const Ring notched = {{0, 0}, {26, 0}, {26, 9}, {17, 9}, {17, 10.4}, {10, 10.4}, {10, 18}, {0, 18}};
  const auto reference = ReadReference(Drawing(Laid(0.8, 0.3, 6, -24) * Shape(notched), {40, 40}));
  ASSERT_TRUE(reference.ok());
  const auto map = ReadShapes(Drawing(Laid(1.9, 2.0, 40, -20) * Shape(notched), {120, 120}), 60.0);
  const auto matches = FindMatches(map, reference.value(), {});
  ASSERT_THAT(matches, SizeIs(1));
  EXPECT_NEAR(matches[0].scale, 1.9 / 0.8, 0.02 * 1.9 / 0.8);
  EXPECT_NEAR(matches[0].rotation_cw_rad, 1.7, 0.03);
  EXPECT_GT(matches[0].score, 0.9);
}

TEST(ReadShapes, ReadsACombOfManyTeethAndAPlateOfManyHoles) {
  cv::Mat1b bitmap(1500, 3000, uchar{255});
  bitmap(cv::Rect(10, 10, 1400, 20)).setTo(0);
  for (int col = 10; col < 1410; col += 4) bitmap(cv::Rect(col, 10, 2, 1400)).setTo(0);
  bitmap(cv::Rect(1500, 10, 1400, 1400)).setTo(0);
  for (int i = 0; i < 10000; ++i) bitmap(cv::Rect(1510 + i % 100 * 13, 20 + i / 100 * 13, 5, 5)).setTo(255);
  const auto shapes = ReadShapes(bitmap, 60.0);
  ASSERT_THAT(shapes, SizeIs(2));
  EXPECT_NEAR(Area(shapes[0].polygon), 1400.0 * 1400.0, 0.01 * 1400.0 * 1400.0);
  EXPECT_THAT(FindMatches(shapes, {Drawn({Shape(kL)})}, {}), IsEmpty());
}

TEST(ReadShapes, FindsNothingInNoise) {
  cv::Mat1b noise(600, 600);
  cv::theRNG().state = 1;
  cv::randu(noise, 0, 256);
  const auto shapes = ReadShapes(noise, 60.0);
  EXPECT_GT(shapes.size(), 100u);
  EXPECT_THAT(FindMatches(shapes, {Drawn({Shape(kL)})}, {}), IsEmpty());
}

TEST(ReadReference, RefusesEmptyWhiteBlackAndCrowdedBitmaps) {
  EXPECT_FALSE(ReadReference({}).ok());
  EXPECT_FALSE(ReadReference(cv::Mat1b(50, 50, uchar{255})).ok());
  EXPECT_FALSE(ReadReference(cv::Mat1b(50, 50, uchar{0})).ok());
  cv::Mat1b crowded(500, 500, uchar{255});
  for (int i = 0; i < 100; ++i) crowded(cv::Rect(50 * (i % 10) + 5, 50 * (i / 10) + 5, 20, 20)).setTo(0);
  EXPECT_FALSE(ReadReference(crowded).ok());
}

}  // namespace
}  // namespace soffit
