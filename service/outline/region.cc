#include "service/outline/region.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

/// Follows the sides of pixels with the region on the left (y taken as up).
class Tracer {
 public:
  explicit Tracer(const cv::Mat1b& bitmap) : bitmap_(bitmap), is_visited_(bitmap.size(), uchar{0}) {}

  bool StartsRing(cv::Point pixel) const {
    return IsInside(pixel) && !IsInside(pixel - cv::Point(0, 1)) && is_visited_(pixel) == 0;
  }

  /// The ring through the upper side of `start`.
  Ring Follow(cv::Point start) {
    Ring ring;
    cv::Point inside = start;      // The pixel on the left.
    cv::Point direction(1, 0);
    do {
      if (direction == cv::Point(1, 0)) is_visited_(inside) = 1;
      const cv::Point right(direction.y, -direction.x);
      const cv::Point ahead = inside + direction;
      cv::Point turned = direction;
      cv::Point next = ahead;
      if (!IsInside(ahead)) {
        turned = -right;
        next = inside;
      } else if (IsInside(ahead + right)) {
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
  bool IsInside(cv::Point p) const {
    return p.x >= 0 && p.y >= 0 && p.x < bitmap_.cols && p.y < bitmap_.rows && bitmap_(p) != 0;
  }

  const cv::Mat1b& bitmap_;
  cv::Mat1b is_visited_;
};

}  // namespace

std::vector<Polygon> TraceRegions(const cv::Mat1b& bitmap, double min_area_px) {
  if (bitmap.empty()) return {};
  cv::Mat1i component;
  cv::Mat1i statistics;
  cv::Mat1d centroids;
  const int count = cv::connectedComponentsWithStats(bitmap, component, statistics, centroids, 4, CV_32S);
  std::vector<Polygon> of_component(static_cast<std::size_t>(count));
  Tracer tracer(bitmap);
  for (int row = 0; row < bitmap.rows; ++row) {
    for (int col = 0; col < bitmap.cols; ++col) {
      const cv::Point pixel(col, row);
      if (!tracer.StartsRing(pixel)) continue;
      const int id = component(pixel);
      Ring ring = tracer.Follow(pixel);
      if (statistics(id, cv::CC_STAT_AREA) < min_area_px) continue;
      const double area = SignedArea(ring);
      Polygon& polygon = of_component[static_cast<std::size_t>(id)];
      if (area > 0.0) {
        polygon.outer = std::move(ring);
      } else if (-area >= min_area_px) {
        polygon.holes.push_back(std::move(ring));
      }
    }
  }
  std::erase_if(of_component, [](const Polygon& polygon) { return polygon.outer.empty(); });
  std::stable_sort(of_component.begin(), of_component.end(),
                   [](const Polygon& a, const Polygon& b) { return Area(a) > Area(b); });
  return of_component;
}

}  // namespace soffit
