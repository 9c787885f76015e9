#include "service/outline/outline.h"

#include <algorithm>

#include "service/outline/region.h"
#include "service/outline/ring_fit.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr double kThinnest_px = 3.0;  // What is thinner is the mixed pixels along an edge.

/// Of a rectangle much longer than wide: its width.
double Thickness(const Polygon& polygon) { return 2.0 * Area(polygon) / Perimeter(polygon.outer); }

bool TouchesEdge(const Ring& boundary, const cv::Rect& seen) {
  return std::any_of(boundary.begin(), boundary.end(), [&](const Eigen::Vector2d& p) {
    return p.x() < seen.x || p.y() < seen.y || p.x() > seen.x + seen.width - 1 ||
           p.y() > seen.y + seen.height - 1;
  });
}

Polygon Shift(Polygon polygon, const Eigen::Vector2d& by) {
  for (Eigen::Vector2d& p : polygon.outer) p += by;
  for (Ring& hole : polygon.holes) {
    for (Eigen::Vector2d& p : hole) p += by;
  }
  return polygon;
}

}  // namespace

std::vector<Outline> TraceOutlines(const Mask& mask, const cv::Rect& seen, const OutlineOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  const cv::Rect inside = seen & cv::Rect(0, 0, mask.label.cols, mask.label.rows);
  std::vector<Outline> outlines;
  if (inside.empty()) return outlines;
  for (Region& region : TraceRegions(mask.label(inside), options.min_area_px)) {
    SOFFIT_EXPECT(region.label <= mask.classes.size());
    const Polygon boundary = Shift(std::move(region.boundary), Eigen::Vector2d(inside.x, inside.y));
    FittedRing outer = FitRing(boundary.outer, 1.0, options.simplify_px);
    if (outer.ring.empty()) continue;
    Outline outline;
    outline.color = mask.classes[region.label - 1U];
    outline.polygon_px.outer = std::move(outer.ring);
    outline.corner_std_px = std::move(outer.corner_std);
    outline.is_cut = TouchesEdge(boundary.outer, inside);
    for (const Ring& boundary_of_hole : boundary.holes) {
      FittedRing hole = FitRing(boundary_of_hole, 1.0, options.simplify_px);
      if (!hole.ring.empty()) outline.polygon_px.holes.push_back(std::move(hole.ring));
    }
    if (Thickness(outline.polygon_px) >= kThinnest_px) outlines.push_back(std::move(outline));
  }
  std::stable_sort(outlines.begin(), outlines.end(), [](const Outline& a, const Outline& b) {
    return Area(a.polygon_px) > Area(b.polygon_px);
  });
  return outlines;
}

}  // namespace soffit
