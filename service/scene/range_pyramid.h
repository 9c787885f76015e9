#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace soffit {

/// Bounds of a picture's values over any window, in a few steps. Level k holds the least and the greatest of
/// squares of 2^k pixels.
class RangePyramid {
 public:
  /// @param low, high  Of the same size, not empty: the least is that of `low`, the greatest that of `high`.
  RangePyramid(const cv::Mat1f& low, const cv::Mat1f& high);

  struct Range {
    float least = 0.0F;
    float greatest = 0.0F;
  };
  /// Bounds over the pixels from (x0, y0) to (x1, y1), both included, which lie in the picture: perhaps wider
  /// than the window's own, never narrower.
  Range Bound(int x0, int y0, int x1, int y1) const;

 private:
  struct Level {
    cv::Mat1f least;
    cv::Mat1f greatest;
  };
  std::vector<Level> levels_;
};

}  // namespace soffit
