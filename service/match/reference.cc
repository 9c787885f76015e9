#include <algorithm>
#include <cmath>

#include "service/match/match.h"
#include "service/outline/region.h"
#include "service/outline/ring_fit.h"

namespace soffit {
namespace {

constexpr double kTolerance_px = 1.2;
constexpr double kMinShareOfLargest = 0.02;  ///< Smaller shapes are specks.
constexpr std::size_t kMaxReferenceShapes = 64;

void Reflect(Ring& ring) {
  for (Eigen::Vector2d& p : ring) p.y() = -p.y();
  std::reverse(ring.begin(), ring.end());
}

}  // namespace

std::vector<Polygon> ReadShapes(const cv::Mat1b& bitmap, double min_area_px) {
  cv::Mat1b black;
  cv::compare(bitmap, 128.0, black, cv::CMP_LT);
  std::vector<Polygon> shapes;
  for (const Region& region : TraceRegions(black, min_area_px)) {
    const Polygon& boundary = region.boundary;
    Polygon shape{FitRing(boundary.outer, 1.0, kTolerance_px).ring, {}};
    if (shape.outer.empty()) continue;
    for (const Ring& hole : boundary.holes) {
      Ring fitted = FitRing(hole, 1.0, kTolerance_px).ring;
      if (!fitted.empty()) shape.holes.push_back(std::move(fitted));
    }
    Reflect(shape.outer);
    std::for_each(shape.holes.begin(), shape.holes.end(), Reflect);
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

Result<Reference> ReadReference(const cv::Mat1b& bitmap) {
  if (bitmap.empty()) return InvalidInput("the reference has no pixels");
  Reference reference{ReadShapes(bitmap, 12.0)};
  if (reference.shapes.empty()) return InvalidInput("the reference shows no black shape on white");
  const double largest = Area(reference.shapes.front());
  if (largest > 0.98 * static_cast<double>(bitmap.total())) {
    return InvalidInput("the reference is all black: it should show black shapes on white");
  }
  std::erase_if(reference.shapes, [&](const Polygon& p) { return Area(p) < kMinShareOfLargest * largest; });
  if (reference.shapes.size() > kMaxReferenceShapes) {
    return InvalidInput("the reference has " + std::to_string(reference.shapes.size()) + " shapes, more than " +
                        std::to_string(kMaxReferenceShapes));
  }
  return reference;
}

}  // namespace soffit
