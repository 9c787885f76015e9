#include "service/scene/range_pyramid.h"

#include <algorithm>

#include "shared/result/result.h"

namespace soffit {
namespace {

/// Half the size, rounded up; `choose` takes one of two values.
template <class Choose>
cv::Mat1f Halve(const cv::Mat1f& fine, Choose choose) {
  cv::Mat1f coarse((fine.rows + 1) / 2, (fine.cols + 1) / 2);
  for (int y = 0; y < coarse.rows; ++y) {
    const float* upper = fine[2 * y];
    const float* lower = fine[std::min(2 * y + 1, fine.rows - 1)];
    for (int x = 0; x < coarse.cols; ++x) {
      const int left = 2 * x;
      const int right = std::min(left + 1, fine.cols - 1);
      coarse(y, x) = choose(choose(upper[left], upper[right]), choose(lower[left], lower[right]));
    }
  }
  return coarse;
}

float Less(float a, float b) { return std::min(a, b); }
float Greater(float a, float b) { return std::max(a, b); }

}  // namespace

RangePyramid::RangePyramid(const cv::Mat1f& low, const cv::Mat1f& high) {
  SOFFIT_EXPECT(!low.empty() && low.size() == high.size());
  levels_.push_back({low, high});
  while (levels_.back().least.total() > 1) {
    const Level& last = levels_.back();
    levels_.push_back({Halve(last.least, Less), Halve(last.greatest, Greater)});
  }
}

RangePyramid::Range RangePyramid::Bound(int x0, int y0, int x1, int y1) const {
  const int extent = std::max(x1 - x0, y1 - y0);
  std::size_t level = 0;
  while (level + 1 < levels_.size() && extent >> level > 1) ++level;
  const Level& squares = levels_[level];
  const int shift = static_cast<int>(level);
  Range range{squares.least(y0 >> shift, x0 >> shift), squares.greatest(y0 >> shift, x0 >> shift)};
  for (int y = y0 >> shift; y <= y1 >> shift; ++y) {
    for (int x = x0 >> shift; x <= x1 >> shift; ++x) {
      range.least = std::min(range.least, squares.least(y, x));
      range.greatest = std::max(range.greatest, squares.greatest(y, x));
    }
  }
  return range;
}

}  // namespace soffit
