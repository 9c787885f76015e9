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
constexpr int kContrast = 16;        // Of 255, in one channel, across a side,
constexpr int kWeakContrast = 8;     // where a strip that is known goes on.
constexpr int kMinWidth_px = 3;      // Between both sides.
constexpr double kMaxWidth = 0.1;    // Of the picture's.
constexpr int kMaxGap_px = 12;       // Rows that may not show it, or half as many as showed it before.
constexpr int kMaxDrift_px = 2;      // Of a side, from row to row, and
constexpr int kMaxDriftShare = 8;    // one of so many parts of the width: a broad bar has blurred sides.
constexpr int kMinCrossing_px = 12;  // Rows before background.
constexpr int kMinCover_px = 4;      // Rows before the model.
constexpr int kMinInSky_px = 12;     // Rows before the sky, where it does not look like sky.
constexpr double kFootShare = 0.12;  // Of the depth of a foot: how well it is known.
constexpr double kFootSigmas = 2.0;
constexpr int kBeside_px = 4;  // Where the model has to be seen beside it.

/// Where a row of the picture shows something that stands out on both sides.
struct Run {
  int y = 0;
  int left = 0;
  int right = 0;
  bool is_strong = false;
  int Middle() const { return (left + right) / 2; }
};

using Strip = std::vector<Run>;  ///< Downward.

/// What FindBars() needs of a picture, turned so that bars are upright in it.
struct Canvas {
  cv::Mat3b bgr;
  cv::Mat1b seen;
  cv::Mat1b predicted;
  cv::Mat1f depth_m;
  bool is_upright = true;
  double slope_std = 0.0;  ///< Of the depth of a place on the ground, over its square.

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
    if (side.Height() < kWeakContrast) continue;
    const bool is_same = !sides.empty() && x - sides.back().x <= kStep_px;
    if (!is_same) {
      sides.push_back(side);
    } else if (side.Height() > sides.back().Height()) {
      sides.back() = side;
    }
  }
  return sides;
}

/// By how much what is between both sides is darker, or brighter, than what is beside.
int Contrast(const Side& left, const Side& right) {
  int contrast = 0;
  for (int c = 0; c < 3; ++c) {
    if ((left.jump[c] < 0) != (right.jump[c] < 0))
      contrast = std::max(contrast, std::min(std::abs(left.jump[c]), std::abs(right.jump[c])));
  }
  return contrast;
}

int MostGap(const Strip& strip) { return std::max(kMaxGap_px, static_cast<int>(strip.size() / 2)); }

bool GoesOn(const Strip& strip, const Run& to) {
  const Run& from = strip.back();
  const int drift_px = kMaxDrift_px + (from.right - from.left) / kMaxDriftShare;
  return to.y > from.y && to.y - from.y <= MostGap(strip) && std::abs(to.left - from.left) <= drift_px &&
         std::abs(to.right - from.right) <= drift_px;
}

std::vector<Strip> FindStrips(const Canvas& canvas) {
  std::vector<Strip> ended, growing;
  const int most_px = static_cast<int>(kMaxWidth * std::max(canvas.bgr.cols, canvas.bgr.rows));
  for (int y = 0; y < canvas.bgr.rows; ++y) {
    const std::vector<Side> sides = FindSides(canvas.bgr, y);
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
      const int contrast = Contrast(sides[i], sides[i + 1]);
      const Run run{y, sides[i].x, sides[i + 1].x, contrast >= kContrast};
      const int width_px = run.right - run.left;
      if (width_px < kMinWidth_px || width_px > most_px || contrast < kWeakContrast) continue;
      const auto before =
          std::find_if(growing.begin(), growing.end(), [&](const Strip& s) { return GoesOn(s, run); });
      if (before != growing.end()) {
        before->push_back(run);
      } else if (run.is_strong) {
        growing.push_back({run});
      }
    }
    const auto is_ended = [&](const Strip& strip) { return y - strip.back().y > MostGap(strip); };
    std::copy_if(growing.begin(), growing.end(), std::back_inserter(ended), is_ended);
    std::erase_if(growing, is_ended);
  }
  ended.insert(ended.end(), growing.begin(), growing.end());
  return ended;
}

/// What a strip covers.
struct Covered {
  int background = 0;          ///< Runs with background on both sides,
  int mixed = 0;               ///< on one side,
  int model = 0;               ///< and on none.
  int sky = 0;                 ///< Runs where sky is expected and something else is seen.
  float model_depth_m = 0.0F;  ///< The greatest; 0 when the model has none there.
};

Covered FindCovered(const Canvas& canvas, const Strip& strip) {
  Covered covered;
  for (const Run& run : strip) {
    const int beside = canvas.CountModelBeside(run);
    ++(beside == 0 ? covered.background : beside == 1 ? covered.mixed : covered.model);
    const auto predicted = static_cast<Seen>(canvas.predicted(run.y, run.Middle()));
    const auto seen = static_cast<Seen>(canvas.seen(run.y, run.Middle()));
    covered.sky += predicted == Seen::kSky && seen != Seen::kSky ? 1 : 0;
    if (beside == 2 && predicted == Seen::kStructure)
      covered.model_depth_m = std::max(covered.model_depth_m, canvas.depth_m(run.y, run.Middle()));
  }
  return covered;
}

/// Depth of the ground where the strip ends on it.
std::optional<float> FootDepth(const Canvas& canvas, const Strip& strip) {
  const Run& foot = strip.back();
  if (!canvas.is_upright || foot.y + kBeside_px >= canvas.predicted.rows) return std::nullopt;
  if (canvas.predicted(foot.y, foot.Middle()) != static_cast<uchar>(Seen::kGround)) return std::nullopt;
  return canvas.depth_m(foot.y, foot.Middle());
}

std::optional<Bar> Judge(const Canvas& canvas, const Strip& strip) {
  const Covered covered = FindCovered(canvas, strip);
  if (covered.background < kMinCrossing_px || covered.background < covered.mixed / 3) return std::nullopt;
  const bool is_before_model = covered.model >= kMinCover_px && covered.model_depth_m > 0.0F;
  const auto foot_m = FootDepth(canvas, strip);
  if (!is_before_model && !(foot_m && covered.sky >= kMinInSky_px)) return std::nullopt;
  Bar bar;
  bar.far_m = is_before_model ? covered.model_depth_m : std::numeric_limits<float>::infinity();
  if (foot_m) {
    const float share = static_cast<float>(kFootShare + canvas.slope_std * *foot_m);
    bar.near_m = (1.0F - share) * *foot_m;
    bar.far_m = std::min(bar.far_m, (1.0F + share) * *foot_m);
  }
  for (const Run& run : strip) bar.runs_px.emplace_back(run.left, run.y, run.right - run.left + 1, 1);
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
  turned.is_upright = false;
  cv::transpose(canvas.bgr, turned.bgr);
  cv::transpose(canvas.seen, turned.seen);
  cv::transpose(canvas.predicted, turned.predicted);
  cv::transpose(canvas.depth_m, turned.depth_m);
  return turned;
}

}  // namespace

std::vector<Bar> FindBars(const Sight& sight, const Prediction& prediction) {
  Canvas canvas{{}, sight.seen, prediction.label, prediction.depth_m};
  canvas.slope_std = kFootSigmas * sight.view.orientation_std_rad /
                     std::max(0.1, sight.view.map_from_camera.translation_m.z());
  cv::GaussianBlur(sight.bgr, canvas.bgr, cv::Size(3, 3), 0.0);
  std::vector<Bar> bars = FindUpright(canvas);
  for (Bar& bar : FindUpright(Turn(canvas))) {
    for (cv::Rect& run : bar.runs_px) run = {run.y, run.x, run.height, run.width};
    bars.push_back(std::move(bar));
  }
  return bars;
}

}  // namespace soffit
