#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace soffit {

/// A thin line in a picture: a ridge or a valley of brightness, half a pixel to four pixels wide.
struct Ridge {
  bool is_clear = false;          ///< It stands out, goes on for at least 12 pixels, and is no blotch.
  std::vector<cv::Point> pixels;  ///< Of its middle, in no order.
  cv::Point2d ends_px[2];         ///< On the straight line through it.
  cv::Point2d along;              ///< Unit vector from the first end to the second.
  double length_px() const { return cv::norm(ends_px[1] - ends_px[0]); }
};

/// All ridges of 5 pixels or more, noise and texture among them; those that are clear stand out from the
/// texture that is usual about them. Empty picture: none. Pure; O(pixels).
///
/// They are where the second derivative across is great and the first one vanishes (Steger, "An Unbiased
/// Detector of Curvilinear Structures", PAMI 20 (2), 1998).
std::vector<Ridge> FindRidges(const cv::Mat1b& picture);

/// The ridge with all others, however faint, that go on in its straight line: where it crosses an edge of the
/// background, or background as bright as itself, a line is broken.
///
/// @param pixel  Of the picture in which they were found, in the unit of their coordinates.
Ridge JoinRidges(Ridge ridge, const std::vector<Ridge>& others, double pixel);

}  // namespace soffit
