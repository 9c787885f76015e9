#include <algorithm>
#include <cmath>
#include <limits>

#include "service/match/match.h"
#include "service/outline/region.h"
#include "service/outline/ring_fit.h"

namespace soffit {
namespace {

constexpr double kTolerance_px = 0.3;        ///< Of the outlines, from the middles of pixel sides.
constexpr double kLeastTolerance_px = 1.2;   ///< When roughness is measured: less explains noise by sides.
constexpr double kMaxToleranceRatio = 0.12;  ///< Of the square root of the area.
constexpr double kCorrelation_px = 4.0;      ///< Pixels along a boundary that err alike.
constexpr double kPixelVariance = 1.0 / 12.0;
constexpr double kMinHoleArea_px = 12.0;
constexpr double kMinShareOfLargest = 0.001;  ///< Smaller shapes are specks.
constexpr std::size_t kMaxReferenceShapes = 64;
constexpr std::size_t kMaxShapes = 10000;
constexpr std::size_t kMaxHoles = 64;
constexpr std::size_t kMaxMeasuredShapes = 100;

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

/// Of shapes by decreasing area. All shapes of a drawing are drawn alike, and small ones do not tell how
/// roughly: none is less rough than the median of the greatest.
std::vector<double> MeasureRoughnesses(const std::vector<Region>& regions) {
  std::vector<double> measured;
  for (std::size_t i = 0; i < std::min(regions.size(), kMaxMeasuredShapes); ++i) {
    measured.push_back(MeasureRoughness(regions[i].boundary.outer));
  }
  if (measured.empty()) return {};
  std::vector<double> roughnesses = measured;
  const auto middle = measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2);
  std::nth_element(measured.begin(), middle, measured.end());
  roughnesses.resize(regions.size(), *middle);
  for (double& roughness : roughnesses) roughness = std::max(roughness, *middle);
  return roughnesses;
}

/// The shapes of the regions, y-up.
std::vector<TracedShape> DrawShapes(std::vector<Region> regions) {
  const std::vector<double> roughnesses = MeasureRoughnesses(regions);
  std::vector<TracedShape> shapes;
  for (std::size_t i = 0; i < regions.size(); ++i) {
    auto& [outer, holes] = regions[i].boundary;
    std::stable_sort(holes.begin(), holes.end(), [](const Ring& a, const Ring& b) {
      return std::abs(SignedArea(a)) > std::abs(SignedArea(b));
    });
    holes.resize(std::min(holes.size(), kMaxHoles));
    TracedShape shape{{ThinRing(outer, kTolerance_px), {}}, roughnesses[i]};
    for (const Ring& hole : holes) shape.polygon.holes.push_back(ThinRing(hole, kTolerance_px));
    Reflect(shape.polygon.outer);
    std::for_each(shape.polygon.holes.begin(), shape.polygon.holes.end(), Reflect);
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

std::vector<Region> FindRegions(const cv::Mat1b& bitmap, double min_area_px, std::size_t max_regions) {
  cv::Mat1b black;
  cv::compare(bitmap, 128.0, black, cv::CMP_LT);
  std::vector<Region> regions = TraceRegions(black, std::min(min_area_px, kMinHoleArea_px), max_regions);
  std::erase_if(regions, [&](const Region& region) { return Area(region.boundary) < min_area_px; });
  return regions;
}

}  // namespace

std::vector<TracedShape> ReadShapes(const cv::Mat1b& bitmap, double min_area_px) {
  return DrawShapes(FindRegions(bitmap, min_area_px, kMaxShapes));
}

Result<Reference> ReadReference(const cv::Mat1b& bitmap) {
  if (bitmap.empty()) return InvalidInput("the reference has no pixels");
  std::vector<Region> regions = FindRegions(bitmap, kMinHoleArea_px, kMaxReferenceShapes + 1);
  if (regions.empty()) return InvalidInput("the reference shows no black shape on white");
  const double largest = Area(regions.front().boundary);
  if (largest > 0.98 * static_cast<double>(bitmap.total())) {
    return InvalidInput("the reference is all black: it should show black shapes on white");
  }
  std::erase_if(regions,
                [&](const Region& region) { return Area(region.boundary) < kMinShareOfLargest * largest; });
  if (regions.size() > kMaxReferenceShapes) {
    return InvalidInput("the reference has more than " + std::to_string(kMaxReferenceShapes) + " shapes");
  }
  return Reference{DrawShapes(std::move(regions))};
}

}  // namespace soffit
