#include "service/mask/mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "service/image/picture_memory.h"
#include "service/image/veil.h"
#include "service/mask/classify.h"
#include "service/mask/median.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr std::size_t kMinTintedSaturation = 25;  ///< Of 255; below, hues are noise.
constexpr double kMinModeDistance = 0.18;
constexpr double kMaxSaturationThreshold = 0.60;

/// What each level becomes before it is classified: freed of the picture's haze, and gamma corrected.
cv::Mat1b CorrectionTable(const Image& image, double gamma) {
  cv::Mat1b table = UnveilTable(image);
  for (uchar& level : table) level = cv::saturate_cast<uchar>(255.0 * std::pow(level / 255.0, 1.0 / gamma));
  return table;
}

bool ChangesNothing(const cv::Mat1b& table) {
  for (int level = 0; level < table.cols; ++level) {
    if (table(0, level) != level) return false;
  }
  return true;
}

/// Labels the pixels of some rows, which then stay in the cache.
class BandClassifier {
 public:
  BandClassifier(const Image& image, const MaskOptions& options)
      : bgr_(image.bgr), options_(options), table_(CorrectionTable(image, options.gamma)) {
    if (ChangesNothing(table_)) table_.release();
  }

  /// The rows as they are classified, filtered and corrected; until the next call.
  const cv::Mat3b& Classify(cv::Range rows, const ColorClasses& classes, cv::Mat1b labels) {
    FilterMedian(bgr_, rows, options_.median_px, filtered_);
    if (!table_.empty()) cv::LUT(filtered_, table_, filtered_);
    for (int row = 0; row < filtered_.rows; ++row) {
      ClassifyPixels(filtered_.ptr(row), static_cast<std::size_t>(filtered_.cols), classes, labels[row]);
    }
    return filtered_;
  }

 private:
  const cv::Mat3b& bgr_;
  const MaskOptions& options_;
  cv::Mat1b table_;  ///< Empty when it would change nothing, as in most pictures.
  cv::Mat3b filtered_;
};

/// By saturation, the sum of the values of pixels: dark ones tell less.
using Histogram = std::array<std::uint64_t, 256>;

/// For each class and, first, for none: what rows all over the picture show of it, however pale.
std::vector<Histogram> SampleSaturations(BandClassifier& classifier, cv::Size size,
                                         const MaskOptions& options) {
  constexpr int kBands = 64;
  constexpr int kBandRows = 2;
  const std::vector<double> however_pale(options.colors.size(), 0.0);
  const ColorClasses classes = MakeColorClasses(options.colors, options.min_value, however_pale);
  const int stride = std::max(kBandRows, size.height / kBands / kBandRows * kBandRows);
  std::vector<Histogram> histograms(options.colors.size() + 1);
  cv::Mat1b labels(kBandRows, size.width);
  for (int first = 0; first < size.height; first += stride) {
    const cv::Range rows(first, std::min(first + kBandRows, size.height));
    const cv::Mat3b& band = classifier.Classify(rows, classes, labels);
    for (int row = 0; row < band.rows; ++row) {
      const cv::Vec3b* pixels = band[row];
      for (int col = 0; col < band.cols; ++col) {
        const auto [blue, green, red] = pixels[col].val;
        const int value = std::max({blue, green, red});
        if (value == 0) continue;
        const int range = value - std::min({blue, green, red});
        histograms[labels(row, col)][static_cast<std::size_t>((255 * range + value / 2) / value)] +=
            static_cast<std::uint64_t>(value);
      }
    }
  }
  return histograms;
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
  BandClassifier classifier(image, options);
  const std::vector<Histogram> histograms = SampleSaturations(classifier, image.bgr.size(), options);
  Mask mask;
  mask.classes = options.colors;
  mask.confidence = 1.0;
  std::vector<double> min_saturations;
  for (std::size_t i = 1; i < histograms.size(); ++i) {
    const Separation separation = PartSaturations(histograms[i], options.min_saturation);
    min_saturations.push_back(separation.threshold);
    mask.confidence = std::min(mask.confidence, separation.confidence);
  }
  const ColorClasses classes = MakeColorClasses(options.colors, options.min_value, min_saturations);
  mask.label = NewPicture(image.bgr.size(), CV_8UC1);
  constexpr int kBandRows = 32;
  for (int first = 0; first < image.bgr.rows; first += kBandRows) {
    const cv::Range rows(first, std::min(first + kBandRows, image.bgr.rows));
    classifier.Classify(rows, classes, mask.label.rowRange(rows));
  }
  return mask;
}

}  // namespace soffit
