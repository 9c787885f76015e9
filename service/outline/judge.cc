#include "service/outline/judge.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <sstream>

namespace soffit {
namespace {

using Eigen::Vector2d;

constexpr double kMinEvenRatio = 0.5;
constexpr double kShortSideRatio = 0.15;  ///< Of the square root of the area: shorter sides are teeth.
constexpr double kMaxTurnOnCurve_rad = 0.9;
/// Buildings in rendered overviews have 11 and more, shadows of trees on a real road less than 3.
constexpr double kMinContrast = 4.0;
constexpr double kSpacing_px = 4.0;      ///< Of the places along an outline that are looked at.
constexpr double kMaxAcross_px = 5.0;    ///< How far from it; nearer in what is thin.
constexpr std::size_t kPlacesAlong = 2;  ///< From one to the next that it is compared with for texture.
constexpr int kSmooth_px = 5;            ///< Finer texture does not count.
constexpr double kLeastTexture = 1.0;    ///< Of 255; smooth pictures are no reason for more contrast.
constexpr std::size_t kLeastPlaces = 8;
constexpr double kMaxPlaces = 400.0;

double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Colours on either side of a place on an outline, smoothed.
struct Place {
  cv::Vec3d in;
  cv::Vec3d out;
};

class PlaceReader {
 public:
  explicit PlaceReader(const Image& image)
      : bgr_(image.bgr), inside_(image.seen & cv::Rect({0, 0}, image.bgr.size())) {
    const cv::Point reach(kSmooth_px / 2, kSmooth_px / 2);
    inside_ = cv::Rect(inside_.tl() + reach, inside_.br() - reach);
  }

  /// Nothing where it lies outside of what the lens saw.
  std::optional<Place> Read(const Vector2d& in, const Vector2d& out) const {
    const cv::Point in_pixel = ToPixel(in);
    const cv::Point out_pixel = ToPixel(out);
    if (!inside_.contains(in_pixel) || !inside_.contains(out_pixel)) return std::nullopt;
    return Place{MeanAround(in_pixel), MeanAround(out_pixel)};
  }

 private:
  static cv::Point ToPixel(const Vector2d& p) {
    return {static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))};
  }

  cv::Vec3d MeanAround(cv::Point center) const {
    cv::Vec3i sum(0, 0, 0);
    for (int row = center.y - kSmooth_px / 2; row <= center.y + kSmooth_px / 2; ++row) {
      for (int col = center.x - kSmooth_px / 2; col <= center.x + kSmooth_px / 2; ++col) {
        sum += cv::Vec3i(bgr_(row, col));
      }
    }
    return cv::Vec3d(sum) / (kSmooth_px * kSmooth_px);
  }

  const cv::Mat3b& bgr_;
  cv::Rect inside_;
};

/// How much more the picture changes across the outline than along it, inside or outside, whichever is more
/// textured; medians. Nothing when too little of it lies within the picture.
std::optional<double> ContrastOf(const Outline& outline, const PlaceReader& reader) {
  const Ring& ring = outline.polygon_px.outer;
  const double perimeter = Perimeter(ring);
  const double spacing = std::max(kSpacing_px, perimeter / kMaxPlaces);
  const double reach = std::clamp(0.5 * Area(outline.polygon_px) / perimeter, 2.0, kMaxAcross_px);
  std::vector<std::optional<Place>> places;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
    const Vector2d inward = reach * Vector2d(-side.y(), side.x()).normalized();
    const int count = static_cast<int>(std::lround(side.norm() / spacing));
    for (int k = 0; k < count; ++k) {
      const Vector2d on_side = ring[i] + side * ((k + 0.5) / count);
      places.push_back(reader.Read(on_side + inward, on_side - inward));
    }
  }
  std::vector<double> across, inside, outside;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto& place = places[i];
    const auto& next = places[(i + kPlacesAlong) % places.size()];
    if (!place || !next) continue;
    across.push_back(cv::norm(place->in - place->out));
    inside.push_back(cv::norm(place->in - next->in));
    outside.push_back(cv::norm(place->out - next->out));
  }
  if (across.size() < kLeastPlaces) return std::nullopt;
  return Median(across) / std::max({kLeastTexture, Median(inside), Median(outside)});
}

double TurnBetween(const Vector2d& before, const Vector2d& after) {
  return std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after));
}

/// Share of a ring on sides that are not short for its area. Sides that bend gently to one hand are one
/// curve.
double EvenRatio(const Ring& ring) {
  const double least = kShortSideRatio * std::sqrt(std::abs(SignedArea(ring)));
  const std::size_t n = ring.size();
  const auto side = [&](std::size_t i) -> Vector2d { return ring[(i + 1) % n] - ring[i % n]; };
  const auto turn_after = [&](std::size_t i) { return TurnBetween(side(i), side(i + 1)); };
  const auto bend_alike = [&](std::size_t i) {  // Into side i + 1, and out of it.
    const double in = turn_after(i);
    const double out = turn_after(i + 1);
    return in * out > 0.0 && std::max(std::abs(in), std::abs(out)) < kMaxTurnOnCurve_rad;
  };
  const auto goes_on_after = [&](std::size_t i) { return bend_alike(i) || bend_alike(i + n - 1); };
  std::size_t begin = 0;
  while (begin < n && goes_on_after(begin)) ++begin;
  if (begin == n) return 1.0;
  double even = 0.0;
  double length = 0.0;
  for (std::size_t i = begin + 1; i <= begin + n; ++i) {
    length += side(i).norm();
    if (goes_on_after(i)) continue;
    if (length >= least) even += length;
    length = 0.0;
  }
  return even / Perimeter(ring);
}

std::string FindReasonAgainst(const Outline& outline, const PlaceReader& reader) {
  std::ostringstream reason;
  reason.precision(2);
  const double even_ratio = EvenRatio(outline.polygon_px.outer);
  if (even_ratio < kMinEvenRatio) {
    reason << "ragged: " << even_ratio << " of it on long sides, not " << kMinEvenRatio;
    return reason.str();
  }
  const std::optional<double> contrast = ContrastOf(outline, reader);
  if (contrast && *contrast < kMinContrast)
    reason << "no edge: contrast " << *contrast << " of its texture, not " << kMinContrast;
  return reason.str();
}

}  // namespace

JudgedOutlines JudgeOutlines(std::vector<Outline> outlines, const Image& image) {
  const PlaceReader reader(image);
  JudgedOutlines judged;
  for (Outline& outline : outlines) {
    std::string reason = FindReasonAgainst(outline, reader);
    if (reason.empty()) {
      judged.buildings.push_back(std::move(outline));
    } else {
      judged.refused.push_back({std::move(outline), std::move(reason)});
    }
  }
  return judged;
}

}  // namespace soffit
