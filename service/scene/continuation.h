#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "service/facade/facade.h"

namespace soffit {

/// What goes on below a strange thing in the colours of the ground: rows from the top down.
struct Continuation {
  struct Row {
    int y = 0;
    int left = 0;
    int right = 0;  ///< The last one.
  };
  std::vector<Row> rows;
  bool meets_structure = false;  ///< It ends before or on a building; else the last row is its foot.
};

/// Colour tells a thing from the ground above the horizon alone: below, a grey thing on grey ground has the
/// ground's colours. But it stands on something. From where each strange region ends above ground, this
/// follows it down, row by row, as long as the picture shows one even colour between two edges about as far
/// apart. Where there are no such edges, nothing goes on: there it is open ground that begins.
///
/// @param strange  255 where a picture shows what is neither building nor background, of the sight's size.
/// @param reach_px  How far beside its ends a region may be wider than `strange` shows it.
std::vector<Continuation> FollowDown(const Sight& sight, const cv::Mat1b& strange, int reach_px);

}  // namespace soffit
