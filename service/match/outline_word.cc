// Highway compiles this file once for each instruction set: everything in HWY_NAMESPACE is built several
// times, and HWY_DYNAMIC_DISPATCH calls the best one. Left out are sets whose vectors have no size that a
// compiler knows, so that no array can hold them.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "service/match/outline_word.cc"
#include "service/match/outline_word.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "shared/result/result.h"

#ifndef SOFFIT_SERVICE_MATCH_SILHOUETTE_ONCE
#define SOFFIT_SERVICE_MATCH_SILHOUETTE_ONCE
namespace soffit {

using Eigen::Vector2d;

constexpr int kSteps = OutlineWord::kSteps;
constexpr int kStretches = OutlineWord::kStretches;
constexpr int kBand = kSteps / 6;           ///< Steps that an alignment may run ahead or fall behind.
constexpr int kOffsets = 2 * kBand + 1;     ///< Between the letters of two words, from -kBand on.
constexpr int kMaxLanes = 16;               ///< Floats in the widest vector.
constexpr float kEditPrice = 0.05f;         ///< Of a step that stands for one more.
constexpr float kMissingPrice = 0.9f;       ///< Of a step that stands for nothing.
constexpr double kComplexityOfPlain = 0.5;  ///< So that plain shapes are not infinitely different.
constexpr double kHolePrice = 1.0;

/// Letters of a word from `kBand` before its start to beyond its end, so that every alignment of every start
/// finds its letters in one run.
constexpr int kColumns = (kSteps + 2 * kBand + 3 * kMaxLanes) / kMaxLanes * kMaxLanes;
using UnrolledLetters = std::array<std::array<float, kColumns>, kStretches>;
/// Price of each letter of one word for each of the other.
using Prices = std::array<std::array<float, kColumns>, kSteps>;

}  // namespace soffit
#endif

HWY_BEFORE_NAMESPACE();
namespace soffit {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;

void PriceLetters(const OutlineWord& a, const UnrolledLetters& b, Prices& prices) {
  const Floats floats;
  const int lanes = static_cast<int>(hn::Lanes(floats));
  for (int i = 0; i < kSteps; ++i) {
    for (int column = 0; column < kColumns; column += lanes) {
      Vector sum = hn::Zero(floats);
      for (int k = 0; k < kStretches; ++k) {
        sum = hn::Add(sum, hn::AbsDiff(hn::Set(floats, a.letters[k][i]), hn::LoadU(floats, &b[k][column])));
      }
      hn::StoreU(sum, floats, &prices[i][column]);
    }
  }
}

/// The least cost over all starts. Each lane of two vectors has a start of its own, `costs` those of the best
/// edits so far for each offset; from letter to letter it is brought up to date in place.
float AlignFromAllStarts(const Prices& prices) {
  const Floats floats;
  const int lanes = static_cast<int>(hn::Lanes(floats));
  const Vector missing = hn::Set(floats, kMissingPrice);
  const Vector edit = hn::Set(floats, kEditPrice);
  const Vector infinite = hn::Set(floats, std::numeric_limits<float>::infinity());
  std::array<float, (kOffsets + 1) * 2 * kMaxLanes> costs;
  const auto relax = [&](Vector price, Vector both, Vector only_a, Vector only_b) HWY_ATTR {
    return hn::Min(hn::Add(both, price),
                   hn::Add(hn::Min(only_a, only_b), hn::Min(missing, hn::Add(edit, price))));
  };
  Vector least = infinite;
  for (int start = 0; start < kSteps; start += 2 * lanes) {
    costs.fill(std::numeric_limits<float>::infinity());
    float* const no_offset = &costs[static_cast<std::size_t>(kBand * 2 * lanes)];
    std::fill(no_offset, no_offset + 2 * lanes, 0.0f);
    for (int i = 0; i < kSteps; ++i) {
      const float* price = &prices[i][(i + start) % kSteps];
      float* cost = costs.data();
      Vector before1 = infinite, before2 = infinite;
      Vector here1 = hn::LoadU(floats, cost), here2 = hn::LoadU(floats, cost + lanes);
      for (int offset = 0; offset < kOffsets; ++offset, cost += 2 * lanes, ++price) {
        const Vector after1 = hn::LoadU(floats, cost + 2 * lanes);
        const Vector after2 = hn::LoadU(floats, cost + 3 * lanes);
        before1 = relax(hn::LoadU(floats, price), here1, after1, before1);
        before2 = relax(hn::LoadU(floats, price + lanes), here2, after2, before2);
        hn::StoreU(before1, floats, cost);
        hn::StoreU(before2, floats, cost + lanes);
        here1 = after1;
        here2 = after2;
      }
    }
    least = hn::Min(least, hn::Min(hn::LoadU(floats, no_offset), hn::LoadU(floats, no_offset + lanes)));
  }
  return hn::GetLane(hn::MinOfLanes(floats, least));
}

float AlignSteps(const OutlineWord& a, const UnrolledLetters& b) {
  Prices prices;
  PriceLetters(a, b, prices);
  return AlignFromAllStarts(prices);
}

}  // namespace HWY_NAMESPACE
}  // namespace soffit
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace soffit {
HWY_EXPORT(AlignSteps);

namespace {

/// `count` points at equal distances along the ring.
Ring Resample(const Ring& ring, std::size_t count) {
  const double step = Perimeter(ring) / static_cast<double>(count);
  Ring points;
  double at = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
    const double length = side.norm();
    for (; at < length && points.size() < count; at += step) points.push_back(ring[i] + side * (at / length));
    at -= length;
  }
  points.resize(count, ring.front());  // When rounding took the last one.
  return points;
}

/// The ring without what is finer than steps: the stairs of pixels, and noise.
Ring Smooth(const Ring& ring) {
  constexpr int kFine = 8;  ///< Points between two steps.
  constexpr int kPoints = kFine * kSteps;
  constexpr int kReach = 3 * kFine;
  const Ring fine = Resample(ring, kPoints);
  Ring smooth(kPoints, Vector2d::Zero());
  double sum = 0.0;
  for (int k = -kReach; k <= kReach; ++k) {
    const double ratio = static_cast<double>(k) / kFine;
    const double weight = std::exp(-0.5 * ratio * ratio);
    sum += weight;
    for (int i = 0; i < kPoints; ++i) {
      smooth[static_cast<std::size_t>(i)] +=
          weight * fine[static_cast<std::size_t>((i + k + kPoints) % kPoints)];
    }
  }
  for (Vector2d& point : smooth) point /= sum;
  return smooth;
}

/// Points at equal distances along the smoothed ring, from its farthest on.
Ring TakeSteps(const Ring& ring) {
  Ring smooth = Smooth(ring);
  const Vector2d middle = Centroid({smooth, {}});
  const auto is_nearer = [&](const Vector2d& a, const Vector2d& b) {
    return (a - middle).squaredNorm() < (b - middle).squaredNorm();
  };
  std::rotate(smooth.begin(), std::max_element(smooth.begin(), smooth.end(), is_nearer), smooth.end());
  return Resample(smooth, kSteps);
}

/// For each step the mean height of the `stretch`th part of the rest over the tangent.
std::array<double, kSteps> MeasureHeights(const Ring& points, int stretch) {
  constexpr int kStretch = (kSteps - 1) / kStretches;
  static_assert(kStretch * kStretches == kSteps - 1);
  const auto point = [&](int i) -> const Vector2d& { return points[static_cast<std::size_t>(i % kSteps)]; };
  std::array<double, kSteps> heights{};
  for (int i = 0; i < kSteps; ++i) {
    Vector2d middle = Vector2d::Zero();
    for (int k = 1; k <= kStretch; ++k) middle += point(i + stretch * kStretch + k) / kStretch;
    const Vector2d tangent = point(i + 1) - point(i + kSteps - 1);
    const Vector2d normal(-tangent.y(), tangent.x());
    const double length = normal.norm();
    if (length > 0.0) heights[static_cast<std::size_t>(i)] = normal.dot(middle - point(i)) / length;
  }
  return heights;
}

UnrolledLetters Unroll(const OutlineWord& word) {
  UnrolledLetters unrolled;
  for (std::size_t k = 0; k < kStretches; ++k) {
    for (int column = 0; column < kColumns; ++column) {
      unrolled[k][static_cast<std::size_t>(column)] =
          word.letters[k][static_cast<std::size_t>((column + kSteps - kBand) % kSteps)];
    }
  }
  return unrolled;
}

double CompareHoles(const OutlineWord& a, const OutlineWord& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < std::max(a.hole_areas.size(), b.hole_areas.size()); ++i) {
    const double of_a = i < a.hole_areas.size() ? a.hole_areas[i] : 0.0;
    const double of_b = i < b.hole_areas.size() ? b.hole_areas[i] : 0.0;
    sum += std::abs(of_a - of_b);
  }
  return sum;
}

}  // namespace

OutlineWord SpellOutline(const Polygon& polygon) {
  const double area = std::abs(SignedArea(polygon.outer));
  SOFFIT_EXPECT(polygon.outer.size() >= 3 && std::isfinite(area) && area > 0.0);
  const Ring points = TakeSteps(polygon.outer);
  OutlineWord word;
  for (int stretch = 0; stretch < kStretches; ++stretch) {
    const std::array<double, kSteps> heights = MeasureHeights(points, stretch);
    double greatest = 0.0, mean = 0.0, squares = 0.0;
    for (const double height : heights) {
      greatest = std::max(greatest, std::abs(height));
      mean += height / kSteps;
      squares += height * height / kSteps;
    }
    if (greatest <= 0.0) continue;
    word.complexity += std::sqrt(std::max(0.0, squares - mean * mean)) / greatest / kStretches;
    const double weight = 1.0 / (greatest * std::min(stretch + 1, kStretches - stretch));
    auto& letters = word.letters[static_cast<std::size_t>(stretch)];
    std::transform(heights.begin(), heights.end(), letters.begin(),
                   [&](double height) { return static_cast<float>(weight * height); });
  }
  for (const Ring& hole : polygon.holes) word.hole_areas.push_back(std::abs(SignedArea(hole)) / area);
  std::sort(word.hole_areas.rbegin(), word.hole_areas.rend());
  return word;
}

OutlineWord Mirror(const OutlineWord& word) {
  OutlineWord mirrored = word;
  std::reverse(mirrored.letters.begin(), mirrored.letters.end());
  for (auto& letters : mirrored.letters) std::reverse(letters.begin(), letters.end());
  return mirrored;
}

double WordDistance(const OutlineWord& a, const OutlineWord& b) {
  const auto cost = static_cast<double>(HWY_DYNAMIC_DISPATCH(AlignSteps)(a, Unroll(b)));
  return cost / kSteps / (kComplexityOfPlain + a.complexity + b.complexity) + kHolePrice * CompareHoles(a, b);
}

}  // namespace soffit
#endif
