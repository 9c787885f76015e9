#include "service/mask/mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "service/mask/median.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

struct HueRange {
  const char* color;
  double from_deg;  ///< Included; the range may run through 360.
  double to_deg;    ///< Excluded.
};

/// Every hue belongs to one colour. Ochre ground lies in `yellow` and sky in `blue`: saturation tells them
/// apart.
constexpr std::array<HueRange, 7> kHueRanges = {{{"red", 340.0, 18.0},
                                                 {"orange", 18.0, 36.0},
                                                 {"yellow", 36.0, 66.0},
                                                 {"green", 66.0, 160.0},
                                                 {"cyan", 160.0, 204.0},
                                                 {"blue", 204.0, 262.0},
                                                 {"magenta", 262.0, 340.0}}};

constexpr int kHues = 256;                        // HSV_FULL
constexpr std::size_t kMinTintedSaturation = 25;  ///< Of 255; below, hues are noise.
constexpr double kMinModeDistance = 0.18;
constexpr double kMaxSaturationThreshold = 0.60;

const HueRange* FindHueRange(const std::string& color) {
  const auto found = std::find_if(kHueRanges.begin(), kHueRanges.end(),
                                  [&](const HueRange& range) { return color == range.color; });
  return found == kHueRanges.end() ? nullptr : &*found;
}

bool Holds(const HueRange& range, double hue_deg) {
  if (range.from_deg <= range.to_deg) return hue_deg >= range.from_deg && hue_deg < range.to_deg;
  return hue_deg >= range.from_deg || hue_deg < range.to_deg;
}

/// For each hue, the 1-based class that it belongs to, or 0.
std::array<std::uint8_t, kHues> ClassOfHue(const std::vector<std::string>& colors) {
  std::array<std::uint8_t, kHues> table{};
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const HueRange* range = FindHueRange(colors[i]);
    SOFFIT_EXPECT(range != nullptr);
    for (int hue = 0; hue < kHues; ++hue) {
      if (Holds(*range, hue * 360.0 / kHues))
        table[static_cast<std::size_t>(hue)] = static_cast<std::uint8_t>(i + 1);
    }
  }
  return table;
}

cv::Mat1b GammaTable(double gamma) {
  cv::Mat1b table(1, 256);
  for (int i = 0; i < 256; ++i) table(i) = cv::saturate_cast<uchar>(255.0 * std::pow(i / 255.0, 1.0 / gamma));
  return table;
}

/// By saturation, the sum of the values of pixels: dark ones tell less.
using Histogram = std::array<std::uint64_t, 256>;

/// All but the last step of the segmentation.
struct Classified {
  cv::Mat1b label;  ///< By hue and value alone.
  cv::Mat1b saturation;
  std::vector<Histogram> histograms;  ///< By label.
};

/// Filters, converts and classifies a few rows at a time, which then stay in the cache.
Classified Classify(const cv::Mat3b& bgr, const MaskOptions& options) {
  constexpr int kBandRows = 32;
  const std::array<std::uint8_t, kHues> class_of_hue = ClassOfHue(options.colors);
  const cv::Mat1b gamma_table = GammaTable(options.gamma);
  const int min_value = static_cast<int>(std::lround(255.0 * options.min_value));
  Classified result{cv::Mat1b(bgr.size()), cv::Mat1b(bgr.size()),
                    std::vector<Histogram>(options.colors.size() + 1)};
  cv::Mat3b hsv;
  for (int first = 0; first < bgr.rows; first += kBandRows) {
    FilterMedian(bgr, cv::Range(first, std::min(first + kBandRows, bgr.rows)), options.median_px, hsv);
    if (options.gamma != 1.0) cv::LUT(hsv, gamma_table, hsv);
    cv::cvtColor(hsv, hsv, cv::COLOR_BGR2HSV_FULL);
    for (int row = 0; row < hsv.rows; ++row) {
      const cv::Vec3b* pixels = hsv[row];
      std::uint8_t* labels = result.label[first + row];
      std::uint8_t* saturations = result.saturation[first + row];
      for (int col = 0; col < hsv.cols; ++col) {
        const auto [hue, saturation, value] = pixels[col].val;
        const std::uint8_t label = value < min_value ? std::uint8_t{0} : class_of_hue[hue];
        labels[col] = label;
        saturations[col] = saturation;
        result.histograms[label][saturation] += value;
      }
    }
  }
  return result;
}

/// Labels less saturated than `thresholds` of their class are taken back.
void DropPale(const cv::Mat1b& saturation, const std::vector<int>& thresholds, cv::Mat1b& label) {
  for (int row = 0; row < label.rows; ++row) {
    std::uint8_t* labels = label[row];
    const std::uint8_t* saturations = saturation[row];
    for (int col = 0; col < label.cols; ++col) {
      if (saturations[col] < thresholds[labels[col]]) labels[col] = 0;
    }
  }
}

struct Separation {
  double threshold = 0.0;   ///< Saturation, 0 to 1.
  double confidence = 0.0;  ///< 0 to 1.
};

/// Where to part the saturations of one hue class: ground and sky below, painted buildings above (N. Otsu, "A
/// threshold selection method from gray-level histograms", IEEE SMC 9(1), 1979). Modes on one side of
/// `fallback` (lit roof and shaded wall, or grass and sand) are not parted.
Separation PartSaturations(const Histogram& histogram, double fallback) {
  double count = 0.0;
  double sum = 0.0;
  for (std::size_t i = kMinTintedSaturation; i < histogram.size(); ++i) {
    const auto weight = static_cast<double>(histogram[i]);
    count += weight;
    sum += weight * static_cast<double>(i);
  }
  if (count <= 0.0) return {fallback, 1.0};
  double best = -1.0;
  double low_mean = 0.0;
  double high_mean = 0.0;
  double low_count = 0.0;
  double low_sum = 0.0;
  for (std::size_t i = kMinTintedSaturation; i + 1 < histogram.size(); ++i) {
    const auto weight = static_cast<double>(histogram[i]);
    low_count += weight;
    low_sum += weight * static_cast<double>(i);
    const double high_count = count - low_count;
    if (low_count <= 0.0 || high_count <= 0.0) continue;
    const double low = low_sum / low_count;
    const double high = (sum - low_sum) / high_count;
    const double between = low_count * high_count * (high - low) * (high - low);
    if (between > best) {
      best = between;
      low_mean = low / 255.0;
      high_mean = high / 255.0;
    }
  }
  const double distance = high_mean - low_mean;
  if (best < 0.0 || distance < kMinModeDistance || low_mean > fallback || high_mean < fallback) {
    const double mean = sum / count / 255.0;
    return {fallback, std::min(1.0, std::abs(mean - fallback) / 0.2)};
  }
  return {std::clamp(0.5 * (low_mean + high_mean), 0.75 * fallback, kMaxSaturationThreshold),
          std::min(1.0, distance / 0.4)};
}

}  // namespace

Mask SegmentBuildings(const Image& image, const MaskOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  SOFFIT_EXPECT(options.median_px % 2 == 1);
  SOFFIT_EXPECT(!image.bgr.empty());
  Classified classified = Classify(image.bgr, options);
  Mask mask;
  mask.classes = options.colors;
  mask.label = classified.label;
  mask.confidence = 1.0;
  std::vector<int> thresholds(options.colors.size() + 1, 256);
  for (std::size_t i = 1; i < thresholds.size(); ++i) {
    const Separation separation = PartSaturations(classified.histograms[i], options.min_saturation);
    thresholds[i] = static_cast<int>(std::lround(255.0 * separation.threshold));
    mask.confidence = std::min(mask.confidence, separation.confidence);
  }
  DropPale(classified.saturation, thresholds, mask.label);
  return mask;
}

}  // namespace soffit
