#include "service/outline/region.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace soffit {
namespace {

/// Neighbours in a row with the same label.
struct Run {
  int row = 0;
  int begin = 0;
  int end = 0;  ///< Excluded.
  std::uint8_t label = 0;
};

/// The first pixel from `at` on with another label than `at`.
int FindEnd(const std::uint8_t* row, int at, int end) {
  const std::uint8_t label = row[at];
  const std::uint64_t eight_labels = 0x0101010101010101u * label;
  for (std::uint64_t eight = 0; at + 8 <= end; at += 8) {
    std::memcpy(&eight, row + at, sizeof eight);
    if (eight != eight_labels) break;
  }
  while (at < end && row[at] == label) ++at;
  return at;
}

/// The runs of all labels but 0, row by row, and which of them belong together.
class Runs {
 public:
  explicit Runs(const cv::Mat1b& labels) {
    std::size_t above = 0;
    for (int row = 0; row < labels.rows; ++row) {
      const std::size_t first = runs_.size();
      AddRow(labels, row);
      JoinToRowAbove(above, first);
      above = first;
    }
    area_px_.assign(runs_.size(), 0.0);
    for (std::size_t i = 0; i < runs_.size(); ++i) area_px_[FindRoot(i)] += runs_[i].end - runs_[i].begin;
  }

  std::size_t size() const { return runs_.size(); }
  const Run& operator[](std::size_t i) const { return runs_[i]; }

  /// The first run of the region of run `i`.
  std::size_t FindRoot(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  double AreaOf_px(std::size_t root) const { return area_px_[root]; }

 private:
  void AddRow(const cv::Mat1b& labels, int row) {
    const std::uint8_t* pixels = labels[row];
    for (int begin = 0, end = 0; begin < labels.cols; begin = end) {
      end = FindEnd(pixels, begin, labels.cols);
      if (pixels[begin] == 0) continue;
      parent_.push_back(runs_.size());
      runs_.push_back({row, begin, end, pixels[begin]});
    }
  }

  void JoinToRowAbove(std::size_t above, std::size_t first) {
    const std::size_t end_above = first;
    for (std::size_t i = first; i < runs_.size(); ++i) {
      while (above < end_above && runs_[above].end <= runs_[i].begin) ++above;
      for (std::size_t k = above; k < end_above && runs_[k].begin < runs_[i].end; ++k) {
        if (runs_[k].label == runs_[i].label) Join(k, i);
      }
    }
  }

  void Join(std::size_t a, std::size_t b) {
    const auto [first, second] = std::minmax({FindRoot(a), FindRoot(b)});
    parent_[second] = first;
  }

  std::vector<Run> runs_;
  std::vector<std::size_t> parent_;
  std::vector<double> area_px_;
};

/// Follows the sides of pixels with the region on the left (y taken as up).
class Tracer {
 public:
  explicit Tracer(const cv::Mat1b& labels) : labels_(labels), is_visited_(labels.total(), false) {}

  /// Whether a ring that was not followed yet has the upper side of `pixel`.
  bool StartsRing(cv::Point pixel) const {
    return !IsInside(pixel - cv::Point(0, 1), labels_(pixel)) && !is_visited_[IndexOf(pixel)];
  }

  /// The ring through the upper side of `start`.
  Ring Follow(cv::Point start) {
    const std::uint8_t label = labels_(start);
    Ring ring;
    cv::Point inside = start;  // The pixel on the left.
    cv::Point direction(1, 0);
    do {
      if (direction == cv::Point(1, 0)) is_visited_[IndexOf(inside)] = true;
      const cv::Point right(direction.y, -direction.x);
      const cv::Point ahead = inside + direction;
      cv::Point turned = direction;
      cv::Point next = ahead;
      if (!IsInside(ahead, label)) {
        turned = -right;
        next = inside;
      } else if (IsInside(ahead + right, label)) {
        turned = right;
        next = ahead + right;
      }
      if (turned != direction) {
        ring.emplace_back(inside.x + 0.5 * (direction.x + right.x), inside.y + 0.5 * (direction.y + right.y));
      }
      inside = next;
      direction = turned;
    } while (inside != start || direction != cv::Point(1, 0));
    return ring;
  }

 private:
  bool IsInside(cv::Point p, std::uint8_t label) const {
    return p.x >= 0 && p.y >= 0 && p.x < labels_.cols && p.y < labels_.rows && labels_(p) == label;
  }
  std::size_t IndexOf(cv::Point p) const {
    return static_cast<std::size_t>(p.y) * static_cast<std::size_t>(labels_.cols) +
           static_cast<std::size_t>(p.x);
  }

  const cv::Mat1b& labels_;
  std::vector<bool> is_visited_;
};

}  // namespace

std::vector<Region> TraceRegions(const cv::Mat1b& labels, double min_area_px) {
  Runs runs(labels);
  Tracer tracer(labels);
  std::vector<Region> regions;
  std::vector<std::size_t> region_of_root(runs.size(), runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::size_t root = runs.FindRoot(i);
    if (runs.AreaOf_px(root) < min_area_px) continue;
    const Run& run = runs[i];
    for (int col = run.begin;
         col<run.end; col = run.row> 0 ? FindEnd(labels[run.row - 1], col, run.end) : run.end) {
      const cv::Point pixel(col, run.row);
      if (!tracer.StartsRing(pixel)) continue;
      Ring ring = tracer.Follow(pixel);
      if (region_of_root[root] == runs.size()) {  // The uppermost side of a region is on its outer ring.
        region_of_root[root] = regions.size();
        regions.push_back({run.label, {std::move(ring), {}}});
      } else if (-SignedArea(ring) >= min_area_px) {
        regions[region_of_root[root]].boundary.holes.push_back(std::move(ring));
      }
    }
  }
  std::stable_sort(regions.begin(), regions.end(),
                   [](const Region& a, const Region& b) { return Area(a.boundary) > Area(b.boundary); });
  return regions;
}

}  // namespace soffit
