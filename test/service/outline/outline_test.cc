#include "service/outline/outline.h"

#include <gmock/gmock.h>

#include <numbers>
#include <opencv2/imgproc.hpp>

#include "service/outline/region.h"
#include "service/outline/ring_fit.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

using ::testing::Each;
using ::testing::IsEmpty;
using ::testing::Le;
using ::testing::SizeIs;

/// Pixels whose centre lies inside: what an ideal camera would label.
cv::Mat1b Draw(const Polygon& polygon, cv::Size size) {
  cv::Mat1b bitmap(size, uchar{0});
  for (int row = 0; row < size.height; ++row) {
    for (int col = 0; col < size.width; ++col) {
      if (Contains(polygon, {col, row})) bitmap(row, col) = 1;
    }
  }
  return bitmap;
}

Mask MaskOf(const cv::Mat1b& label) {
  Mask mask;
  mask.label = label;
  mask.classes = {"red", "blue"};
  return mask;
}

std::vector<Outline> Trace(const cv::Mat1b& label, const OutlineOptions& options = {}) {
  return TraceOutlines(MaskOf(label), cv::Rect({0, 0}, label.size()), options);
}

const Ring kSlanted = {{40.3, 30.7}, {211.2, 78.1}, {181.9, 184.4}, {10.6, 137.3}};

double DistanceToNearest(const Eigen::Vector2d& p, const Ring& corners) {
  double least = 1e9;
  for (const Eigen::Vector2d& corner : corners) least = std::min(least, (p - corner).norm());
  return least;
}

TEST(TraceOutlines, GivesFourCornersForARectangleBetterThanThePixel) {
  const auto outlines = Trace(Draw({kSlanted, {}}, {240, 220}));
  ASSERT_THAT(outlines, SizeIs(1));
  EXPECT_EQ(outlines[0].color, "red");
  ASSERT_THAT(outlines[0].polygon_px.outer, SizeIs(4));
  for (const Eigen::Vector2d& corner : kSlanted) {
    EXPECT_LT(DistanceToNearest(corner, outlines[0].polygon_px.outer), 0.3);
  }
  EXPECT_NEAR(Area(outlines[0].polygon_px), SignedArea(kSlanted), 0.002 * SignedArea(kSlanted));
  EXPECT_THAT(outlines[0].corner_std_px, SizeIs(4));
  EXPECT_THAT(outlines[0].corner_std_px, Each(Le(0.3)));
  EXPECT_FALSE(outlines[0].is_cut);
}

TEST(TraceOutlines, HasNoHalfPixelBias) {
  cv::Mat1b label(100, 100, uchar{0});
  label(cv::Rect(20, 30, 40, 50)) = 2;
  const auto outlines = Trace(label);
  ASSERT_THAT(outlines, SizeIs(1));
  EXPECT_EQ(outlines[0].color, "blue");
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(19.5, 29.5), {59.5, 29.5}, {59.5, 79.5}, {19.5, 79.5}}) {
    EXPECT_LT(DistanceToNearest(corner, outlines[0].polygon_px.outer), 1e-9);
  }
  EXPECT_GT(SignedArea(outlines[0].polygon_px.outer), 0.0);
}

TEST(TraceOutlines, SharpensCornersThatAMedianRoundedOff) {
  cv::Mat1b label = Draw({kSlanted, {}}, {240, 220});
  cv::medianBlur(label, label, 7);
  const auto outlines = Trace(label);
  ASSERT_THAT(outlines, SizeIs(1));
  ASSERT_THAT(outlines[0].polygon_px.outer, SizeIs(4));
  for (const Eigen::Vector2d& corner : kSlanted) {
    EXPECT_LT(DistanceToNearest(corner, outlines[0].polygon_px.outer), 0.5);
  }
}

TEST(TraceOutlines, KeepsCourtyardsAndDropsSmallHoles) {
  cv::Mat1b label(200, 200, uchar{0});
  label(cv::Rect(20, 20, 150, 150)) = 1;
  label(cv::Rect(60, 60, 40, 50)) = 0;
  label(cv::Rect(140, 140, 3, 3)) = 0;
  const auto outlines = Trace(label);
  ASSERT_THAT(outlines, SizeIs(1));
  ASSERT_THAT(outlines[0].polygon_px.holes, SizeIs(1));
  EXPECT_NEAR(SignedArea(outlines[0].polygon_px.holes[0]), -2000.0, 1.0);
}

/// The greatest distance of the ring's corners and middles of sides from an ellipse along the axes.
double DistanceFromEllipse(const Ring& ring, const Eigen::Vector2d& center, const Eigen::Vector2d& radii) {
  double greatest = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    for (const Eigen::Vector2d& p :
         {ring[i], Eigen::Vector2d(0.5 * (ring[i] + ring[(i + 1) % ring.size()]))}) {
      const Eigen::Vector2d q = (p - center).cwiseQuotient(radii);
      const double distance = (q.norm() - 1.0) * q.norm() / q.cwiseQuotient(radii).norm();
      greatest = std::max(greatest, std::abs(distance));
    }
  }
  return greatest;
}

cv::Mat1b DrawEllipse(const Eigen::Vector2d& center, const Eigen::Vector2d& radii, cv::Size size) {
  cv::Mat1b label(size, uchar{0});
  for (int row = 0; row < size.height; ++row) {
    for (int col = 0; col < size.width; ++col) {
      const Eigen::Vector2d q = (Eigen::Vector2d(col, row) - center).cwiseQuotient(radii);
      label(row, col) = q.norm() < 1.0 ? 1 : 0;
    }
  }
  return label;
}

TEST(TraceOutlines, KeepsRoundTowersRoundDownToTheSmallest) {
  for (const double radius : {11.0, 12.0, 14.0, 17.0, 25.0, 40.0, 80.0, 200.0}) {
    for (const double aspect : {1.0, 0.85}) {  // A circle looked at from the side is an ellipse.
      SCOPED_TRACE(testing::Message() << "radius " << radius << ", aspect " << aspect);
      const auto size = static_cast<int>(2.0 * radius + 30.0);
      const Eigen::Vector2d center(0.5 * size + 0.3, 0.5 * size - 0.2);
      const Eigen::Vector2d radii(radius, aspect * radius);
      const auto outlines = Trace(DrawEllipse(center, radii, {size, size}));
      ASSERT_THAT(outlines, SizeIs(1));
      const Ring& ring = outlines[0].polygon_px.outer;
      EXPECT_GE(ring.size(), 9u);
      EXPECT_LT(DistanceFromEllipse(ring, center, radii), 0.6);
      EXPECT_NEAR(SignedArea(ring), std::numbers::pi * radii.prod(), 0.01 * SignedArea(ring));
      EXPECT_THAT(outlines[0].corner_std_px, SizeIs(ring.size()));
      EXPECT_THAT(outlines[0].corner_std_px, Each(Le(0.3)));
    }
  }
}

TEST(TraceOutlines, KeepsACurveBetweenStraightSides) {
  cv::Mat1b label = DrawEllipse({120.2, 80.4}, {50.0, 50.0}, {200, 160});
  label.colRange(0, 120).setTo(0);
  label(cv::Rect(30, 31, 91, 100)).setTo(1);  // Half round at one end, square at the other.
  const auto outlines = Trace(label);
  ASSERT_THAT(outlines, SizeIs(1));
  const Ring& ring = outlines[0].polygon_px.outer;
  EXPECT_LT(DistanceToNearest({29.5, 30.5}, ring), 0.3);
  EXPECT_LT(DistanceToNearest({29.5, 130.5}, ring), 0.3);
  Ring round;
  std::copy_if(ring.begin(), ring.end(), std::back_inserter(round),
               [](const auto& p) { return p.x() > 122.0; });
  EXPECT_GE(round.size(), 8u);
  for (const Eigen::Vector2d& p : round) EXPECT_NEAR((p - Eigen::Vector2d(120.2, 80.4)).norm(), 50.0, 0.7);
}

TEST(TraceOutlines, KeepsTheCornersOfAnOctagon) {
  for (const double radius : {20.0, 30.0, 60.0}) {
    SCOPED_TRACE(radius);
    Ring octagon;
    for (int i = 0; i < 8; ++i) {
      const double angle = std::numbers::pi * (0.07 + 0.25 * i);
      octagon.emplace_back(80.1 + radius * std::cos(angle), 80.4 + radius * std::sin(angle));
    }
    const auto outlines = Trace(Draw({octagon, {}}, {160, 160}));
    ASSERT_THAT(outlines, SizeIs(1));
    ASSERT_THAT(outlines[0].polygon_px.outer, SizeIs(8));
    for (const auto& p : octagon) EXPECT_LT(DistanceToNearest(p, outlines[0].polygon_px.outer), 0.6);
  }
}

TEST(TraceOutlines, KeepsARoundCourtyardRound) {
  cv::Mat1b label(200, 200, uchar{0});
  label(cv::Rect(20, 20, 160, 150)) = 1;
  label.setTo(0, DrawEllipse({101.3, 94.7}, {35.0, 35.0}, label.size()));
  const auto outlines = Trace(label);
  ASSERT_THAT(outlines, SizeIs(1));
  ASSERT_THAT(outlines[0].polygon_px.holes, SizeIs(1));
  const Ring& hole = outlines[0].polygon_px.holes[0];
  EXPECT_LT(SignedArea(hole), 0.0);
  EXPECT_LT(DistanceFromEllipse(hole, {101.3, 94.7}, {35.0, 35.0}), 0.6);
}

TEST(TraceOutlines, MarksBlobsAtTheEdgeOfWhatWasSeenAsCut) {
  cv::Mat1b label(200, 200, uchar{0});
  label(cv::Rect(10, 10, 60, 60)) = 1;
  label(cv::Rect(100, 100, 60, 60)) = 1;
  const auto outlines = TraceOutlines(MaskOf(label), cv::Rect(10, 0, 180, 200), {});
  ASSERT_THAT(outlines, SizeIs(2));
  EXPECT_NE(outlines[0].is_cut, outlines[1].is_cut);
}

TEST(TraceOutlines, FindsNothingInAnEmptyMaskOrOutsideOfIt) {
  EXPECT_THAT(Trace(cv::Mat1b(50, 50, uchar{0})), IsEmpty());
  EXPECT_THAT(TraceOutlines(MaskOf(cv::Mat1b(50, 50, uchar{1})), cv::Rect(60, 60, 10, 10), {}), IsEmpty());
}

TEST(TraceOutlines, OrdersByAreaAndKeepsColoursApart) {
  cv::Mat1b label(200, 200, uchar{0});
  label(cv::Rect(10, 10, 40, 40)) = 1;
  label(cv::Rect(50, 10, 60, 60)) = 2;
  const auto outlines = Trace(label);
  ASSERT_THAT(outlines, SizeIs(2));
  EXPECT_EQ(outlines[0].color, "blue");
  EXPECT_EQ(outlines[1].color, "red");
}

TEST(TraceOutlines, ManySpecksAreDroppedFast) {
  cv::Mat1b label(1000, 1000, uchar{0});
  for (int i = 0; i < 10000; ++i) label((i / 100) * 10, (i % 100) * 10) = 1;
  EXPECT_THAT(Trace(label), IsEmpty());
}

TEST(TraceOutlines, DropsTheMixedPixelsAlongAnEdge) {
  cv::Mat1b label(100, 400, uchar{0});
  label(cv::Rect(20, 40, 350, 2)) = 1;
  EXPECT_THAT(Trace(label), IsEmpty());
}

TEST(TraceOutlines, EveryRingOfAJaggedBlobIsSimple) {
  cv::RNG random(7);
  cv::Mat1b label(300, 300, uchar{0});
  for (int i = 0; i < 60; ++i) {
    cv::circle(label, {random.uniform(60, 240), random.uniform(60, 240)}, random.uniform(3, 25),
               cv::Scalar(i % 3 ? 1 : 0), -1);
  }
  const auto outlines = Trace(label);
  EXPECT_FALSE(outlines.empty());
  for (const Outline& outline : outlines) {
    EXPECT_TRUE(IsSimple(outline.polygon_px.outer));
    for (const Ring& hole : outline.polygon_px.holes) EXPECT_TRUE(IsSimple(hole));
  }
}

TEST(TraceOutlines, RefusesInvalidOptions) {
  OutlineOptions options;
  options.simplify_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Trace(cv::Mat1b(50, 50, uchar{0}), options), ContractViolation);
}

TEST(TraceRegions, FollowsTheSidesOfPixels) {
  cv::Mat1b bitmap(4, 4, uchar{0});
  bitmap(1, 2) = 1;
  const auto regions = TraceRegions(bitmap, 0.0);
  ASSERT_THAT(regions, SizeIs(1));
  EXPECT_DOUBLE_EQ(SignedArea(regions[0].boundary.outer), 1.0);
  EXPECT_LT((Centroid(regions[0].boundary) - Eigen::Vector2d(2, 1)).norm(), 1e-12);
}

TEST(TraceRegions, KeepsDiagonalNeighboursApart) {
  cv::Mat1b bitmap(4, 4, uchar{0});
  bitmap(1, 1) = bitmap(2, 2) = 1;
  EXPECT_THAT(TraceRegions(bitmap, 0.0), SizeIs(2));
}

TEST(TraceRegions, HasTheAreaOfItsPixels) {
  cv::RNG random(3);
  cv::Mat1b bitmap(64, 64);
  random.fill(bitmap, cv::RNG::UNIFORM, 0, 2);
  double area = 0.0;
  for (const Region& region : TraceRegions(bitmap, 0.0)) area += Area(region.boundary);
  EXPECT_DOUBLE_EQ(area, cv::countNonZero(bitmap));
}

TEST(TraceRegions, TellsTouchingLabelsApart) {
  cv::Mat1b labels(6, 8, uchar{2});
  labels.colRange(3, 8) = 1;
  labels(2, 5) = 2;
  const auto regions = TraceRegions(labels, 0.0);
  ASSERT_THAT(regions, SizeIs(3));
  EXPECT_EQ(regions[0].label, 1);
  EXPECT_DOUBLE_EQ(Area(regions[0].boundary), 29.0);
  EXPECT_THAT(regions[0].boundary.holes, SizeIs(1));
  EXPECT_EQ(regions[1].label, 2);
  EXPECT_DOUBLE_EQ(Area(regions[1].boundary), 18.0);
  EXPECT_EQ(regions[2].label, 2);
}

TEST(TraceRegions, GivesHolesToTheRegionAroundThem) {
  cv::Mat1b labels(20, 40, uchar{1});
  labels.col(20) = 0;
  labels(cv::Rect(3, 3, 6, 2)) = 0;  // An arch: its feet end later than the hole between them.
  labels(cv::Rect(3, 3, 2, 10)) = 0;
  labels(cv::Rect(6, 6, 1, 2)) = 0;
  labels(cv::Rect(25, 8, 10, 10)) = 0;
  labels(cv::Rect(28, 11, 4, 4)) = 1;  // A region in the hole of another.
  const auto regions = TraceRegions(labels, 0.0);
  ASSERT_THAT(regions, SizeIs(3));
  EXPECT_THAT(regions[0].boundary.holes, SizeIs(2));
  EXPECT_DOUBLE_EQ(Area(regions[0].boundary), 400.0 - 28.0 - 2.0);
  EXPECT_THAT(regions[1].boundary.holes, SizeIs(1));
  EXPECT_DOUBLE_EQ(Area(regions[1].boundary), 380.0 - 100.0);
  EXPECT_DOUBLE_EQ(Area(regions[2].boundary), 16.0);
}

TEST(TraceRegions, KeepsTheGreatest) {
  cv::Mat1b labels(20, 60, uchar{0});
  for (int i = 0; i < 5; ++i) labels(cv::Rect(12 * i, 0, 3 + (3 * i) % 5, 4)).setTo(1);
  const auto regions = TraceRegions(labels, 1.0, 2);
  ASSERT_THAT(regions, SizeIs(2));
  EXPECT_EQ(Area(regions[0].boundary), 7 * 4);
  EXPECT_EQ(Area(regions[1].boundary), 6 * 4);
}

TEST(ThinRing, StaysWithinAPixelOfTheTruth) {
  const Ring truth = {{10.3, 12.1}, {80.2, 30.7}, {71.9, 61.4}, {40.1, 52.9}, {38.2, 60.0}, {2.7, 50.6}};
  const auto regions = TraceRegions(Draw({truth, {}}, {100, 80}), 10.0);
  ASSERT_THAT(regions, SizeIs(1));
  const Ring thin = ThinRing(regions[0].boundary.outer, 0.3);
  EXPECT_NEAR(SignedArea(thin), SignedArea(truth), 0.01 * SignedArea(truth));
  for (const Eigen::Vector2d& corner : thin) EXPECT_LT(DistanceToRing(corner, truth), 1.0);
  for (const Eigen::Vector2d& corner : truth) EXPECT_LT(DistanceToRing(corner, thin), 1.2);
}

TEST(FitRing, GivesNothingForDegenerateBoundaries) {
  EXPECT_THAT(FitRing({}, 1.0, 1.0).ring, IsEmpty());
  EXPECT_THAT(FitRing({{0, 0}, {1, 0}}, 1.0, 1.0).ring, IsEmpty());
  EXPECT_THAT(FitRing({{0, 0}, {50, 0}, {100, 0}}, 1.0, 1.0).ring, IsEmpty());
}

TEST(FitRing, KeepsPrecisionFarFromTheOrigin) {
  const Eigen::Vector2d far(691000.0, 5335000.0);
  Ring moved = kSlanted;
  for (Eigen::Vector2d& p : moved) p += far;
  const Ring fitted = FitRing(moved, 1.0, 1.0).ring;
  ASSERT_THAT(fitted, SizeIs(4));
  for (const Eigen::Vector2d& p : moved) EXPECT_LT(DistanceToNearest(p, fitted), 1e-4);
}

}  // namespace
}  // namespace soffit
