#include <algorithm>
#include <cmath>
#include <limits>

#include "service/match/match.h"
#include "service/outline/region.h"
#include "service/outline/ring_fit.h"

namespace soffit {
namespace {

constexpr double kTolerance_px = 0.8;        ///< Of the polygons of a clean bitmap.
constexpr double kLeastTolerance_px = 1.2;   ///< When roughness is measured: less explains noise by sides.
constexpr double kMaxToleranceRatio = 0.12;  ///< Of the square root of the area.
constexpr double kCorrelation_px = 4.0;      ///< Pixels along a boundary that err alike.
constexpr double kPixelVariance = 1.0 / 12.0;
constexpr double kMinHoleArea_px = 12.0;
constexpr double kMinShareOfLargest = 0.004;  ///< Smaller shapes are specks.
constexpr std::size_t kMaxReferenceShapes = 64;

void Reflect(Ring& ring) {
  for (Eigen::Vector2d& p : ring) p.y() = -p.y();
  std::reverse(ring.begin(), ring.end());
}

/// How far a boundary scatters about the polygon that explains it best: of a rough one not every tooth is a
/// side, of a clean one no side is noise. Bayesian information criterion over tolerances (G. Schwarz,
/// "Estimating the dimension of a model", Annals of Statistics 6(2), 1978).
double MeasureRoughness(const Ring& boundary) {
  const double greatest_px = kMaxToleranceRatio * std::sqrt(std::abs(SignedArea(boundary)));
  const double independent = std::max(8.0, Perimeter(boundary) / kCorrelation_px);
  double roughness = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (double tolerance_px = kLeastTolerance_px; tolerance_px <= std::max(kLeastTolerance_px, greatest_px);
       tolerance_px *= 1.4) {
    const FittedRing fitted = FitRing(boundary, 1.0, tolerance_px);
    if (fitted.ring.empty()) continue;
    const double variance = fitted.roughness * fitted.roughness + kPixelVariance;
    const double sides = static_cast<double>(fitted.ring.size());
    const double criterion = independent * std::log(variance) + 2.0 * sides * std::log(independent);
    if (criterion < least) {
      least = criterion;
      roughness = fitted.roughness;
    }
  }
  return roughness;
}

}  // namespace

std::vector<TracedShape> ReadShapes(const cv::Mat1b& bitmap, double min_area_px) {
  cv::Mat1b black;
  cv::compare(bitmap, 128.0, black, cv::CMP_LT);
  std::vector<TracedShape> shapes;
  for (const Region& region : TraceRegions(black, std::min(min_area_px, kMinHoleArea_px))) {
    const Polygon& boundary = region.boundary;
    if (Area(boundary) < min_area_px) break;
    FittedRing outer = FitRing(boundary.outer, 1.0, kTolerance_px);
    if (outer.ring.empty()) continue;
    TracedShape shape{{std::move(outer.ring), {}}, MeasureRoughness(boundary.outer)};
    for (const Ring& boundary_of_hole : boundary.holes) {
      FittedRing hole = FitRing(boundary_of_hole, 1.0, kTolerance_px);
      if (!hole.ring.empty()) shape.polygon.holes.push_back(std::move(hole.ring));
    }
    Reflect(shape.polygon.outer);
    std::for_each(shape.polygon.holes.begin(), shape.polygon.holes.end(), Reflect);
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

Result<Reference> ReadReference(const cv::Mat1b& bitmap) {
  if (bitmap.empty()) return InvalidInput("the reference has no pixels");
  Reference reference{ReadShapes(bitmap, 12.0)};
  if (reference.shapes.empty()) return InvalidInput("the reference shows no black shape on white");
  const double largest = Area(reference.shapes.front().polygon);
  if (largest > 0.98 * static_cast<double>(bitmap.total())) {
    return InvalidInput("the reference is all black: it should show black shapes on white");
  }
  std::erase_if(reference.shapes,
                [&](const TracedShape& shape) { return Area(shape.polygon) < kMinShareOfLargest * largest; });
  if (reference.shapes.size() > kMaxReferenceShapes) {
    return InvalidInput("the reference has " + std::to_string(reference.shapes.size()) +
                        " shapes, more than " + std::to_string(kMaxReferenceShapes));
  }
  return reference;
}

}  // namespace soffit
