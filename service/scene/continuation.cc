#include "service/scene/continuation.h"

#include <algorithm>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr int kSameColor = 10;     // Of 255, in each channel.
constexpr int kMixed_px = 2;       // Rows and columns in which the colours of both sides of an edge mix.
constexpr double kMostWide = 1.3;  // Times as wide as it begins.
constexpr int kHorizon_px = 10;    // Within which ground fades into what is above.
constexpr int kLeastTall_px = 4;   // Less than that is the edge of the region itself.

class Follower {
 public:
  Follower(const Sight& sight, int reach_px) : seen_(sight.seen), reach_px_(reach_px) {
    cv::GaussianBlur(sight.bgr, smooth_, cv::Size(3, 3), 0.0);
  }

  Continuation Follow(int y, int left, int right) const {
    Continuation found;
    const int first_y = y + kMixed_px;
    if (first_y >= seen_.rows) return found;
    const int inset = (right - left + 1) / 4;  // Off the edges, where colours mix.
    cv::Vec3i color = MeanColor(first_y, left + inset, right - inset, std::nullopt);
    int slack_px = reach_px_ + kMixed_px;
    double most_px = 0.0;
    for (int row = first_y; row < seen_.rows; ++row) {
      const std::optional<Continuation::Row> next = Next({row, left, right}, color, slack_px);
      if (!next) {
        found.meets_structure = ShowsStructure(row, left, right);
        break;
      }
      const int width = next->right - next->left + 1;
      if (most_px == 0.0) most_px = kMostWide * width + kMixed_px;
      if (width > most_px || next->left == 0 || next->right == seen_.cols - 1) break;
      found.rows.push_back(*next);
      left = next->left;
      right = next->right;
      color = MeanColor(row, left, right, color);
      slack_px = 1;
    }
    const auto framed = std::count_if(found.rows.begin(), found.rows.end(),
                                      [&](const Continuation::Row& row) { return IsFramed(row); });
    if (static_cast<int>(found.rows.size()) < kLeastTall_px || 2 * framed > std::ssize(found.rows)) return {};
    for (int above = first_y - 1; above >= y; --above)
      found.rows.insert(found.rows.begin(), {above, found.rows.front().left, found.rows.front().right});
    return found;
  }

 private:
  bool IsAlike(int y, int x, const cv::Vec3i& color) const {
    if (seen_(y, x) == static_cast<uchar>(Seen::kStructure)) return false;
    const cv::Vec3b& pixel = smooth_(y, x);
    return std::max({std::abs(pixel[0] - color[0]), std::abs(pixel[1] - color[1]),
                     std::abs(pixel[2] - color[2])}) <= kSameColor;
  }

  /// Of the pixels that are alike, if a colour is given.
  cv::Vec3i MeanColor(int y, int left, int right, const std::optional<cv::Vec3i>& like) const {
    cv::Vec3i sum(0, 0, 0);
    int count = 0;
    for (int x = left; x <= right; ++x) {
      if (like && !IsAlike(y, x, *like)) continue;
      sum += cv::Vec3i(smooth_(y, x));
      ++count;
    }
    return count == 0 ? like.value_or(cv::Vec3i()) : sum / count;
  }

  bool ShowsStructure(int y, int left, int right) const {
    int count = 0;
    for (int x = left; x <= right; ++x) count += seen_(y, x) == static_cast<uchar>(Seen::kStructure) ? 1 : 0;
    return 2 * count > right - left + 1;
  }

  /// Whether it lies between structure: ground seen through an opening is as wide as that.
  bool IsFramed(const Continuation::Row& row) const {
    const int left = std::max(0, row.left - 2 * kMixed_px);
    const int right = std::min(seen_.cols - 1, row.right + 2 * kMixed_px);
    const auto structure = static_cast<uchar>(Seen::kStructure);
    return seen_(row.y, left) == structure && seen_(row.y, right) == structure;
  }

  /// The even part of the row below; none when it ends or has no edge within the slack.
  std::optional<Continuation::Row> Next(Continuation::Row row, const cv::Vec3i& color, int slack_px) const {
    int alike = 0;
    for (int x = row.left; x <= row.right; ++x) alike += IsAlike(row.y, x, color) ? 1 : 0;
    if (2 * alike < row.right - row.left + 1) return std::nullopt;
    const int least = std::max(0, row.left - slack_px), most = std::min(seen_.cols - 1, row.right + slack_px);
    while (row.left < row.right && !IsAlike(row.y, row.left, color)) ++row.left;
    while (row.right > row.left && !IsAlike(row.y, row.right, color)) --row.right;
    while (row.left > 0 && IsAlike(row.y, row.left - 1, color)) {
      if (--row.left < least) return std::nullopt;
    }
    while (row.right + 1 < seen_.cols && IsAlike(row.y, row.right + 1, color)) {
      if (++row.right > most) return std::nullopt;
    }
    return row;
  }

  const cv::Mat1b& seen_;
  int reach_px_;
  cv::Mat3b smooth_;
};

}  // namespace

std::vector<Continuation> FollowDown(const Sight& sight, const cv::Mat1b& strange, int reach_px) {
  SOFFIT_EXPECT(strange.size() == sight.seen.size());
  const Follower follower(sight, reach_px);
  // The row of ground below the region's end; right at the horizon there may be neither; -1: none.
  const auto ground_below = [&](int y, int x) {
    if (strange(y, x) == 0 || strange(y + 1, x) != 0) return -1;
    for (int below = y + 1; below <= std::min(y + kHorizon_px, strange.rows - 1); ++below) {
      if (sight.seen(below, x) == static_cast<uchar>(Seen::kGround)) return below;
      if (sight.seen(below, x) != static_cast<uchar>(Seen::kUnexplained)) return -1;
    }
    return -1;
  };
  std::vector<Continuation> found;
  cv::Mat1b is_taken(strange.size(), uchar{0});
  for (int y = 0; y + 1 < strange.rows; ++y) {
    for (int x = 0; x < strange.cols; ++x) {
      int lowest = ground_below(y, x);
      if (lowest < 0 || is_taken(y, x) != 0) continue;
      int right = x;  // The horizon may be tilted: the region's lower edge is followed to the right.
      for (int at = y; right + 1 < strange.cols; ++right) {
        int ground = -1;
        for (const int step : {0, 1, -1}) {
          const int row = at + step;
          if (row < 0 || row + 1 >= strange.rows) continue;
          ground = ground_below(row, right + 1);
          if (ground < 0) continue;
          at = row;
          break;
        }
        if (ground < 0) break;
        is_taken(at, right + 1) = 1;
        lowest = std::max(lowest, ground);
      }
      Continuation continuation = follower.Follow(lowest, x, right);
      if (!continuation.rows.empty()) found.push_back(std::move(continuation));
    }
  }
  return found;
}

}  // namespace soffit
