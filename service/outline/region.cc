#include "service/outline/region.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace soffit {
namespace {

/// Neighbours in a row with the same label.
struct Run {
  int begin = 0;
  int end = 0;  ///< Excluded.
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

/// The runs of all labels but 0, row by row, and which of them belong together. Noise has a run for every
/// four pixels: little is kept of each.
class Runs {
 public:
  explicit Runs(const cv::Mat1b& labels) {
    for (int row = 0; row < labels.rows; ++row) {
      first_of_row_.push_back(runs_.size());
      AddRow(labels, row);
      if (row > 0) JoinToRowAbove(labels, row);
    }
    first_of_row_.push_back(runs_.size());
  }

  std::size_t size() const { return runs_.size(); }
  std::size_t FirstOfRow(int row) const { return first_of_row_[static_cast<std::size_t>(row)]; }
  const Run& operator[](std::size_t i) const { return runs_[i]; }

  /// The first run of the region of run `i`.
  std::size_t FindRoot(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  /// The roots of the greatest regions, at most `max_regions`, in ascending order.
  std::vector<std::size_t> FindGreatest(double min_area_px, std::size_t max_regions) {
    std::vector<std::uint32_t> area_px(runs_.size(), 0);
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      area_px[FindRoot(i)] += static_cast<std::uint32_t>(runs_[i].end - runs_[i].begin);
    }
    std::vector<std::size_t> roots;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (parent_[i] == i && area_px[i] >= min_area_px) roots.push_back(i);
    }
    if (roots.size() <= max_regions) return roots;
    const auto end = roots.begin() + static_cast<std::ptrdiff_t>(max_regions);
    std::nth_element(roots.begin(), end, roots.end(), [&](std::size_t a, std::size_t b) {
      return area_px[a] != area_px[b] ? area_px[a] > area_px[b] : a < b;
    });
    roots.erase(end, roots.end());
    std::sort(roots.begin(), roots.end());
    return roots;
  }

 private:
  void AddRow(const cv::Mat1b& labels, int row) {
    const std::uint8_t* pixels = labels[row];
    for (int begin = 0, end = 0; begin < labels.cols; begin = end) {
      end = FindEnd(pixels, begin, labels.cols);
      if (pixels[begin] == 0) continue;
      parent_.push_back(static_cast<std::uint32_t>(runs_.size()));
      runs_.push_back({begin, end});
    }
  }

  void JoinToRowAbove(const cv::Mat1b& labels, int row) {
    const std::size_t first = FirstOfRow(row);
    std::size_t above = FirstOfRow(row - 1);
    for (std::size_t i = first; i < runs_.size(); ++i) {
      while (above < first && runs_[above].end <= runs_[i].begin) ++above;
      for (std::size_t k = above; k < first && runs_[k].begin < runs_[i].end; ++k) {
        if (labels(row - 1, runs_[k].begin) == labels(row, runs_[i].begin)) Join(k, i);
      }
    }
  }

  void Join(std::size_t a, std::size_t b) {
    const auto [first, second] = std::minmax({FindRoot(a), FindRoot(b)});
    parent_[second] = static_cast<std::uint32_t>(first);
  }

  std::vector<std::size_t> first_of_row_;
  std::vector<Run> runs_;
  std::vector<std::uint32_t> parent_;
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

std::vector<Region> SortByArea(std::vector<Region> regions) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < regions.size(); ++i) order.emplace_back(-Area(regions[i].boundary), i);
  std::sort(order.begin(), order.end());
  std::vector<Region> sorted;
  for (const auto& [_, i] : order) sorted.push_back(std::move(regions[i]));
  return sorted;
}

}  // namespace

std::vector<Region> TraceRegions(const cv::Mat1b& labels, double min_area_px, std::size_t max_regions) {
  Runs runs(labels);
  Tracer tracer(labels);
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> region_of_root(runs.size(), kNone);
  std::uint32_t count = 0;
  for (const std::size_t root : runs.FindGreatest(min_area_px, max_regions)) region_of_root[root] = count++;
  std::vector<Region> regions(count);
  for (int row = 0; row < labels.rows; ++row) {
    for (std::size_t i = runs.FirstOfRow(row); i < runs.FirstOfRow(row + 1); ++i) {
      const std::uint32_t index = region_of_root[runs.FindRoot(i)];
      if (index == kNone) continue;
      Region& region = regions[index];
      const auto [begin, end] = runs[i];
      for (int col = begin; col<end; col = row> 0 ? FindEnd(labels[row - 1], col, end) : end) {
        const cv::Point pixel(col, row);
        if (!tracer.StartsRing(pixel)) continue;
        Ring ring = tracer.Follow(pixel);
        if (region.boundary.outer.empty()) {  // The uppermost side of a region is on its outer ring.
          region = {labels(pixel), {std::move(ring), {}}};
        } else if (-SignedArea(ring) >= min_area_px) {
          region.boundary.holes.push_back(std::move(ring));
        }
      }
    }
  }
  return SortByArea(std::move(regions));
}

}  // namespace soffit
