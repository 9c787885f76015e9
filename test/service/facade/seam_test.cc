#include "service/facade/seam.h"

#include <gtest/gtest.h>

namespace soffit {
namespace {

const cv::Vec3b kWall(30, 30, 150);
const cv::Vec3b kSky(235, 225, 215);

/// A wall up to column 20, sky from column 26, and in between a seam of light that mixes evenly.
Elevation Blurred() {
  Elevation view;
  view.cell_m = view.pixel_m = 0.01;
  view.seen = cv::Mat1b(12, 60, static_cast<uchar>(Seen::kSky));
  view.bgr = cv::Mat3b(12, 60, kSky);
  view.seen.colRange(0, 20).setTo(static_cast<uchar>(Seen::kStructure));
  view.bgr.colRange(0, 20).setTo(kWall);
  for (int column = 20; column < 26; ++column) {
    const double share = (column - 19.5) / 6.0;
    cv::Vec3b mixed;
    for (int c = 0; c < 3; ++c)
      mixed[c] = cv::saturate_cast<uchar>(
          std::sqrt((1.0 - share) * kWall[c] * kWall[c] + share * kSky[c] * kSky[c]));
    view.seen.col(column).setTo(static_cast<uchar>(Seen::kUnexplained));
    view.bgr.col(column).setTo(mixed);
  }
  return view;
}

TEST(SplitSeams, PutsTheEdgeWhereLightMixesEvenly) {
  const cv::Mat1b open = SplitSeams(Blurred());
  EXPECT_EQ(open(6, 22), 0);
  EXPECT_EQ(open(6, 23), 255);
}

TEST(SplitSeams, LeavesWhatIsNoMixture) {
  Elevation view = Blurred();
  view.bgr.colRange(20, 26).setTo(cv::Vec3b(20, 160, 20));  // A green post beside the wall.
  EXPECT_EQ(cv::countNonZero(SplitSeams(view)), 12 * 60);
}

TEST(SplitSeams, ChangesNothingWithoutAWallOrWithoutABackground) {
  Elevation view = Blurred();
  view.seen.setTo(static_cast<uchar>(Seen::kSky));
  EXPECT_EQ(cv::countNonZero(SplitSeams(view)), 12 * 60);
  view.seen.setTo(static_cast<uchar>(Seen::kStructure));
  EXPECT_EQ(cv::countNonZero(SplitSeams(view)), 12 * 60);
}

}  // namespace
}  // namespace soffit
