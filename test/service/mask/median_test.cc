#include "service/mask/median.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "shared/result/result.h"
#include "test/support/instruction_sets.h"

namespace soffit {
namespace {

cv::Mat Noise(cv::Size size, int type, int seed) {
  cv::Mat picture(size, type);
  cv::RNG(static_cast<std::uint64_t>(seed)).fill(picture, cv::RNG::UNIFORM, 0, 256);
  return picture;
}

cv::Mat Ramp(cv::Size size, int type) {
  cv::Mat picture(size, type);
  for (int row = 0; row < size.height; ++row) {
    for (int byte = 0; byte < size.width * picture.channels(); ++byte) {
      picture.ptr(row)[byte] = static_cast<std::uint8_t>(3 * row + 7 * byte);
    }
  }
  return picture;
}

void ExpectEqualsOpenCv(const cv::Mat& picture, int size_px = 7) {
  cv::Mat expected;
  cv::medianBlur(picture, expected, size_px);
  const cv::Mat filtered = FilterMedian(picture, size_px);
  ASSERT_EQ(filtered.size(), expected.size());
  ASSERT_EQ(filtered.type(), expected.type());
  EXPECT_EQ(cv::norm(filtered, expected, cv::NORM_INF), 0.0) << picture.size() << " type " << picture.type();
}

class FilterMedianWith : public test::WithInstructionSet {};
INSTANTIATE_TEST_SUITE_P(InstructionSets, FilterMedianWith, test::AllInstructionSets(), test::NameOfSet);

TEST_P(FilterMedianWith, EqualsOpenCvOnNoiseOfAnySize) {
  int seed = 0;
  for (const int type : {CV_8UC1, CV_8UC3}) {
    for (const cv::Size size : {cv::Size(1, 1),
                                {2, 1},
                                {1, 9},
                                {50, 3},
                                {3, 50},
                                {5, 6},
                                {7, 7},
                                {21, 8},
                                {22, 31},
                                {64, 32},
                                {65, 33},
                                {170, 35},
                                {171, 64},
                                {511, 9},
                                {513, 67}}) {
      ExpectEqualsOpenCv(Noise(size, type, ++seed));
    }
  }
}

TEST_P(FilterMedianWith, EqualsOpenCvOnFlatAndSmoothPictures) {
  for (const int type : {CV_8UC1, CV_8UC3}) {
    ExpectEqualsOpenCv(cv::Mat(40, 60, type, cv::Scalar(0, 0, 0)));
    ExpectEqualsOpenCv(cv::Mat(40, 60, type, cv::Scalar(255, 255, 255)));
    ExpectEqualsOpenCv(Ramp({190, 45}, type));
  }
}

TEST_P(FilterMedianWith,
       EqualsOpenCvWithOnlyTwoValues) {  // All that a sorting network can do wrong shows in zeros and ones.
  for (int seed = 0; seed < 8; ++seed) ExpectEqualsOpenCv(Noise({300, 40}, CV_8UC3, seed) > 20 * seed + 60);
}

TEST(FilterMedian, DoesNotLookOutsideARegionOfInterest) {
  const cv::Mat picture = Noise({200, 90}, CV_8UC3, 1);
  const cv::Mat region = picture(cv::Rect(13, 11, 101, 57));
  ASSERT_FALSE(region.isContinuous());
  ExpectEqualsOpenCv(region);
  EXPECT_EQ(cv::norm(FilterMedian(region, 7), FilterMedian(region.clone(), 7), cv::NORM_INF), 0.0);
}

TEST(FilterMedian, FiltersSomeRowsAsItFiltersAll) {
  const cv::Mat picture = Noise({70, 100}, CV_8UC3, 5);
  for (const int size_px : {1, 5, 7, 9}) {
    const cv::Mat all = FilterMedian(picture, size_px);
    for (const cv::Range rows : {cv::Range(0, 1), {0, 33}, {2, 35}, {31, 98}, {97, 100}, {0, 100}}) {
      cv::Mat some;
      FilterMedian(picture, rows, size_px, some);
      ASSERT_EQ(some.size(), cv::Size(70, rows.size()));
      EXPECT_EQ(cv::norm(some, all.rowRange(rows), cv::NORM_INF), 0.0) << rows.start << " to " << rows.end;
    }
  }
}

TEST(FilterMedian, RefusesRowsOutsideThePicture) {
  const cv::Mat picture = Noise({9, 9}, CV_8UC3, 5);
  cv::Mat filtered;
  EXPECT_THROW(FilterMedian(picture, cv::Range(-1, 3), 7, filtered), ContractViolation);
  EXPECT_THROW(FilterMedian(picture, cv::Range(3, 10), 7, filtered), ContractViolation);
  EXPECT_THROW(FilterMedian(picture, cv::Range::all(), 7, filtered), ContractViolation);
}

TEST(FilterMedian, LeavesItsInputAlone) {
  const cv::Mat picture = Noise({60, 40}, CV_8UC3, 2);
  const cv::Mat before = picture.clone();
  FilterMedian(picture, 7);
  EXPECT_EQ(cv::norm(picture, before, cv::NORM_INF), 0.0);
}

TEST(FilterMedian, LeavesOtherSizesAndTypesToOpenCv) {
  for (const int size_px : {1, 3, 5, 9, 15}) ExpectEqualsOpenCv(Noise({60, 40}, CV_8UC3, size_px), size_px);
  ExpectEqualsOpenCv(Noise({60, 40}, CV_8UC4, 3));
  ExpectEqualsOpenCv(Noise({60, 40}, CV_16UC1, 3), 5);
}

TEST(FilterMedian, RefusesWhatHasNoMedian) {
  EXPECT_THROW(FilterMedian(cv::Mat(), 7), cv::Exception);
  EXPECT_THROW(FilterMedian(Noise({8, 8}, CV_8UC3, 4), 4), cv::Exception);
  EXPECT_THROW(FilterMedian(Noise({8, 8}, CV_8UC3, 4), -7), cv::Exception);
}

}  // namespace
}  // namespace soffit
