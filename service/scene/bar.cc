#include "service/scene/bar.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace soffit {
namespace {

constexpr int kStep_px = 2;          // A side of a bar is looked for across twice that.
constexpr int kContrast = 16;        // Of 255, in one channel, across a side.
constexpr int kMinWidth_px = 3;      // Between both sides.
constexpr double kMaxWidth = 0.1;    // Of the picture's.
constexpr int kMaxGap_px = 12;       // Rows that may not show it.
constexpr int kMaxDrift_px = 2;      // Of a side, from row to row, and
constexpr int kMaxDriftShare = 8;    // one of so many parts of the width: a broad bar has blurred sides.
constexpr int kMinCrossing_px = 12;  // Rows before background.
constexpr int kMinCover_px = 4;      // Rows before the model, next to those.
constexpr int kBeside_px = 4;        // Where the model has to be seen beside it.

/// Where a row of the picture shows something that stands out on both sides.
struct Run {
  int y = 0;
  int left = 0;
  int right = 0;
  int Middle() const { return (left + right) / 2; }
};

using Strip = std::vector<Run>;  ///< Downward.

/// What FindBars() needs of a picture; upright bars are looked for.
struct Canvas {
  cv::Mat3b bgr;
  cv::Mat1b seen;
  cv::Mat1b predicted;
  cv::Mat1f depth_m;

  bool IsSeenModel(int y, int x) const {
    return x >= 0 && x < seen.cols && seen(y, x) == static_cast<uchar>(Seen::kStructure);
  }
  /// On how many sides of the run the model is seen.
  int CountModelBeside(const Run& run) const {
    return IsSeenModel(run.y, run.left - kBeside_px) + IsSeenModel(run.y, run.right + kBeside_px);
  }
};

/// A place in a row where its colour jumps.
struct Side {
  int x = 0;
  cv::Vec3i jump;
  int Height() const { return std::max({std::abs(jump[0]), std::abs(jump[1]), std::abs(jump[2])}); }
};

std::vector<Side> FindSides(const cv::Mat3b& bgr, int y) {
  std::vector<Side> sides;
  for (int x = kStep_px; x + kStep_px < bgr.cols; ++x) {
    const cv::Vec3b& left = bgr(y, x - kStep_px);
    const cv::Vec3b& right = bgr(y, x + kStep_px);
    const Side side{x, {right[0] - left[0], right[1] - left[1], right[2] - left[2]}};
    if (side.Height() < kContrast) continue;
    const bool is_same = !sides.empty() && x - sides.back().x <= kStep_px;
    if (!is_same) {
      sides.push_back(side);
    } else if (side.Height() > sides.back().Height()) {
      sides.back() = side;
    }
  }
  return sides;
}

/// Whether what is between both sides is darker, or brighter, than what is beside.
bool StandsOut(const Side& left, const Side& right) {
  for (int c = 0; c < 3; ++c) {
    const int smaller = std::min(std::abs(left.jump[c]), std::abs(right.jump[c]));
    if (smaller >= kContrast && (left.jump[c] < 0) != (right.jump[c] < 0)) return true;
  }
  return false;
}

bool GoesOn(const Run& from, const Run& to) {
  const int drift_px = kMaxDrift_px + (from.right - from.left) / kMaxDriftShare;
  return to.y > from.y && to.y - from.y <= kMaxGap_px && std::abs(to.left - from.left) <= drift_px &&
         std::abs(to.right - from.right) <= drift_px;
}

std::vector<Strip> FindStrips(const Canvas& canvas) {
  std::vector<Strip> ended, growing;
  const int most_px = static_cast<int>(kMaxWidth * std::max(canvas.bgr.cols, canvas.bgr.rows));
  for (int y = 0; y < canvas.bgr.rows; ++y) {
    const std::vector<Side> sides = FindSides(canvas.bgr, y);
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
      const Run run{y, sides[i].x, sides[i + 1].x};
      const int width_px = run.right - run.left;
      if (width_px < kMinWidth_px || width_px > most_px || !StandsOut(sides[i], sides[i + 1])) continue;
      const auto before =
          std::find_if(growing.begin(), growing.end(), [&](const Strip& s) { return GoesOn(s.back(), run); });
      if (before == growing.end()) {
        growing.push_back({run});
      } else {
        before->push_back(run);
      }
    }
    const auto is_ended = [&](const Strip& strip) { return y - strip.back().y > kMaxGap_px; };
    std::copy_if(growing.begin(), growing.end(), std::back_inserter(ended), is_ended);
    std::erase_if(growing, is_ended);
  }
  ended.insert(ended.end(), growing.begin(), growing.end());
  return ended;
}

/// What a strip covers of the model, from a run on, away from the opening.
struct Cover {
  std::ptrdiff_t runs = 0;
  float depth_m = 0.0F;  ///< The greatest; 0 when the model has none there.
  bool IsProof() const { return runs >= kMinCover_px && depth_m > 0.0F; }
};

template <class Iterator>
Cover FollowCover(const Canvas& canvas, Iterator from, Iterator end) {
  Cover cover;
  for (; from != end && canvas.CountModelBeside(*from) == 2; ++from, ++cover.runs) {
    if (canvas.predicted(from->y, from->Middle()) == static_cast<uchar>(Seen::kStructure))
      cover.depth_m = std::max(cover.depth_m, canvas.depth_m(from->y, from->Middle()));
  }
  return cover;
}

/// The part of a strip that crosses an opening, with what it covers of the model at its ends.
std::optional<Bar> Judge(const Canvas& canvas, const Strip& strip) {
  const auto crosses = [&](const Run& run) { return canvas.CountModelBeside(run) == 0; };
  const auto is_within = [&](const Run& run) { return canvas.CountModelBeside(run) < 2; };
  const auto first = std::find_if(strip.begin(), strip.end(), is_within);
  const auto last = std::find_if(strip.rbegin(), strip.rend(), is_within).base();
  if (first >= last) return std::nullopt;
  const auto crossing = std::count_if(first, last, crosses);
  if (crossing < kMinCrossing_px || 4 * crossing < last - first) return std::nullopt;
  const Cover above = FollowCover(canvas, std::make_reverse_iterator(first), strip.rend());
  const Cover below = FollowCover(canvas, last, strip.end());
  if (!above.IsProof() && !below.IsProof()) return std::nullopt;
  Bar bar;
  bar.far_m = std::numeric_limits<float>::infinity();
  for (const Cover& cover : {above, below}) {
    if (cover.IsProof()) bar.far_m = std::min(bar.far_m, cover.depth_m);
  }
  for (auto run = first - above.runs; run != last + below.runs; ++run)
    bar.runs_px.emplace_back(run->left, run->y, run->right - run->left + 1, 1);
  return bar;
}

std::vector<Bar> FindUpright(const Canvas& canvas) {
  std::vector<Bar> bars;
  for (const Strip& strip : FindStrips(canvas)) {
    if (auto bar = Judge(canvas, strip)) bars.push_back(std::move(*bar));
  }
  return bars;
}

Canvas Turn(const Canvas& canvas) {
  Canvas turned;
  cv::transpose(canvas.bgr, turned.bgr);
  cv::transpose(canvas.seen, turned.seen);
  cv::transpose(canvas.predicted, turned.predicted);
  cv::transpose(canvas.depth_m, turned.depth_m);
  return turned;
}

}  // namespace

std::vector<Bar> FindBars(const Sight& sight, const Prediction& prediction) {
  Canvas canvas{{}, sight.seen, prediction.label, prediction.depth_m};
  cv::GaussianBlur(sight.bgr, canvas.bgr, cv::Size(3, 3), 0.0);
  std::vector<Bar> bars = FindUpright(canvas);
  for (Bar& bar : FindUpright(Turn(canvas))) {
    for (cv::Rect& run : bar.runs_px) run = {run.y, run.x, run.height, run.width};
    bars.push_back(std::move(bar));
  }
  return bars;
}

}  // namespace soffit
