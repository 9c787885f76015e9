#include "service/outline/outline.h"

#include <algorithm>

#include "service/outline/region.h"
#include "service/outline/ring_fit.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

bool TouchesEdge(const Ring& boundary, const cv::Rect& seen) {
  return std::any_of(boundary.begin(), boundary.end(), [&](const Eigen::Vector2d& p) {
    return p.x() < seen.x || p.y() < seen.y || p.x() > seen.x + seen.width - 1 || p.y() > seen.y + seen.height - 1;
  });
}

}  // namespace

std::vector<Outline> TraceOutlines(const Mask& mask, const cv::Rect& seen, const OutlineOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  const cv::Rect inside = seen & cv::Rect(0, 0, mask.label.cols, mask.label.rows);
  std::vector<Outline> outlines;
  if (inside.empty()) return outlines;
  for (std::size_t i = 0; i < mask.classes.size(); ++i) {
    cv::Mat1b region(mask.label.size(), uchar{0});
    cv::compare(mask.label(inside), static_cast<double>(i + 1), region(inside), cv::CMP_EQ);
    for (const Polygon& boundary : TraceRegions(region, options.min_area_px)) {
      FittedRing outer = FitRing(boundary.outer, 1.0, options.simplify_px);
      if (outer.ring.empty()) continue;
      Outline outline;
      outline.color = mask.classes[i];
      outline.polygon_px.outer = std::move(outer.ring);
      outline.corner_std_px = std::move(outer.corner_std);
      outline.is_cut = TouchesEdge(boundary.outer, inside);
      for (const Ring& boundary_of_hole : boundary.holes) {
        FittedRing hole = FitRing(boundary_of_hole, 1.0, options.simplify_px);
        if (!hole.ring.empty()) outline.polygon_px.holes.push_back(std::move(hole.ring));
      }
      outlines.push_back(std::move(outline));
    }
  }
  std::stable_sort(outlines.begin(), outlines.end(), [](const Outline& a, const Outline& b) {
    return Area(a.polygon_px) > Area(b.polygon_px);
  });
  return outlines;
}

}  // namespace soffit
