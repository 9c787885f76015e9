#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "service/facade/facade.h"
#include "service/facade/light.h"
#include "service/image/veil.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr int kMinDarkValue = 10;       // Of 255: below, a hue is noise.
constexpr double kMinHueShare = 0.003;  // Of a class's pixels: rarer hues are stray.
constexpr int kHueReach = 4;            // Of 256.
constexpr double kShadeSaturation =
    0.60;  // Of the class's own saturation: what shade and haze may leave of it.
constexpr double kSurelySkyRise = 0.12;  // Tangent above the horizon: few things reach higher.
constexpr double kDarkestSky = 0.60;     // Of the median of what is surely sky.
constexpr double kSurelyGroundRise = -0.05;
constexpr double kGroundShare =
    0.25;  // Of the lowest ray's fall: what lies above may be things on the ground.
constexpr std::size_t kMinGround_px = 100;
constexpr double kMinToneShare = 0.08;  // Of the ground: a rarer colour may be that of a thing.
constexpr int kMaxSkyStep = 5;          // Of 255, from pixel to pixel: how fast sky fades.
constexpr double kMinSkyShare = 2e-4;
constexpr double kMinOpenSkyShare = 0.03;  // Of the picture.
constexpr double kChromaReach = 0.022;
constexpr double kDarkNoise = 4.0;      // Of 255: what noise and JPEG do to the chromaticity of dark pixels.
constexpr double kDeepestShade = 0.18;  // Of the lit ground's median.
constexpr double kHazeFall = 0.08;      // Tangent below the horizon: nearer ground is not hazy.
constexpr std::size_t kMinHaze_px = 200;
constexpr float kMostBeside = 0.06F;     // Of the way from the ground's light to that of the haze.
constexpr double kMostVeilError = 0.08;  // Of the haze's share.
constexpr int kMinSpeck_px = 8;

/// Height of each pixel's ray above the horizon, as a tangent: affine in the pixel.
struct Horizon {
  double per_x = 0.0;
  double per_y = 0.0;
  double at_origin = 0.0;

  explicit Horizon(const View& view) {
    const Eigen::Matrix3d rotation = view.map_from_camera.rotation.toRotationMatrix();
    const Intrinsics& k = view.intrinsics;
    per_x = rotation(2, 0) / k.fx_px;
    per_y = rotation(2, 1) / k.fy_px;
    at_origin = rotation(2, 2) - k.cx_px * per_x - k.cy_px * per_y;
  }
  double Rise(int x, int y) const { return per_x * x + per_y * y + at_origin; }
};

double Quantile(std::vector<float>& values, double share) {
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

/// The hues of one colour class as this picture shows them, and the least saturation that goes with each.
std::array<int, 256> LearnHues(const cv::Mat3b& hsv, const cv::Mat1b& label, int class_label) {
  std::array<double, 256> count{};
  std::array<double, 256> saturation_sum{};
  double total = 0.0;
  for (int y = 0; y < hsv.rows; ++y) {
    for (int x = 0; x < hsv.cols; ++x) {
      if (label(y, x) != class_label) continue;
      const cv::Vec3b& pixel = hsv(y, x);
      count[pixel[0]] += 1.0;
      saturation_sum[pixel[0]] += pixel[1];
      total += 1.0;
    }
  }
  std::array<int, 256> least_saturation;
  least_saturation.fill(256);
  for (int hue = 0; hue < 256; ++hue) {
    const std::size_t h = static_cast<std::size_t>(hue);
    if (count[h] < std::max(50.0, kMinHueShare * total)) continue;
    const int least = static_cast<int>(kShadeSaturation * saturation_sum[h] / count[h]);
    for (int step = -kHueReach; step <= kHueReach; ++step) {
      int& entry = least_saturation[static_cast<std::size_t>((hue + step) & 255)];
      entry = std::min(entry, least);
    }
  }
  return least_saturation;
}

void MarkStructure(const cv::Mat3b& smooth, const cv::Mat1b& unveil, const Mask& buildings, cv::Mat1b& seen) {
  cv::Mat3b hsv;
  cv::LUT(smooth, unveil, hsv);
  cv::cvtColor(hsv, hsv, cv::COLOR_BGR2HSV_FULL);
  std::array<int, 256> least_saturation;
  least_saturation.fill(256);
  for (std::size_t i = 0; i < buildings.classes.size(); ++i) {
    const std::array<int, 256> of_class = LearnHues(hsv, buildings.label, static_cast<int>(i + 1));
    for (std::size_t h = 0; h < 256; ++h) least_saturation[h] = std::min(least_saturation[h], of_class[h]);
  }
  for (int y = 0; y < hsv.rows; ++y) {
    for (int x = 0; x < hsv.cols; ++x) {
      const cv::Vec3b& pixel = hsv(y, x);
      if (pixel[2] >= kMinDarkValue && pixel[1] >= least_saturation[pixel[0]]) {
        seen(y, x) = static_cast<uchar>(Seen::kStructure);
      }
    }
  }
}

/// A set of colours, kept as cells of 8 levels a side.
class ColorSet {
 public:
  void Add(const cv::Vec3b& color) { ++count_[Cell(color)]; }
  /// Drops what is rarer than `share` and takes in the neighbouring cells.
  void Close(double share) {
    double total = 0.0;
    for (const int count : count_) total += count;
    has_.assign(count_.size(), false);
    for (int cell = 0; cell < static_cast<int>(count_.size()); ++cell) {
      if (count_[static_cast<std::size_t>(cell)] < std::max(3.0, share * total)) continue;
      for (int b = -1; b <= 1; ++b) {
        for (int g = -1; g <= 1; ++g) {
          for (int r = -1; r <= 1; ++r) Take(cell, b, g, r);
        }
      }
    }
  }
  bool Has(const cv::Vec3b& color) const { return has_[Cell(color)]; }

 private:
  static std::size_t Cell(const cv::Vec3b& color) {
    return static_cast<std::size_t>(((color[0] >> 3) << 10) | ((color[1] >> 3) << 5) | (color[2] >> 3));
  }
  void Take(int cell, int b, int g, int r) {
    const int blue = (cell >> 10) + b;
    const int green = ((cell >> 5) & 31) + g;
    const int red = (cell & 31) + r;
    if (std::min({blue, green, red}) < 0 || std::max({blue, green, red}) > 31) return;
    has_[static_cast<std::size_t>((blue << 10) | (green << 5) | red)] = true;
  }
  std::vector<int> count_ = std::vector<int>(32 * 32 * 32, 0);
  std::vector<bool> has_ = std::vector<bool>(32 * 32 * 32, false);
};

int LargestStep(const cv::Vec3b& a, const cv::Vec3b& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

int Brightness(const cv::Vec3b& color) { return color[0] + color[1] + color[2]; }

/// What reaches high and is much darker than most of what is up there is a pole or a tree.
double LeastSkyBrightness(const cv::Mat3b& smooth, const Horizon& horizon, const cv::Mat1b& seen) {
  std::vector<float> values;
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      if (seen(y, x) == 0 && horizon.Rise(x, y) > kSurelySkyRise)
        values.push_back(static_cast<float>(Brightness(smooth(y, x))));
    }
  }
  return values.empty() ? 0.0 : kDarkestSky * Quantile(values, 0.5);
}

/// 1 where nothing of a building is above: what is seen below a lintel may be a pole as well as sky. Where
/// buildings leave next to nothing of the sky, all that reaches high.
cv::Mat1b FindOpenSky(const Horizon& horizon, const cv::Mat1b& seen) {
  cv::Mat1b high(seen.size(), uchar{0}), open(seen.size(), uchar{0});
  for (int x = 0; x < seen.cols; ++x) {
    bool is_open = true;
    for (int y = 0; y < seen.rows && horizon.Rise(x, y) > kSurelySkyRise; ++y) {
      is_open = is_open && seen(y, x) == 0;
      high(y, x) = seen(y, x) == 0 ? 1 : 0;
      open(y, x) = is_open ? 1 : 0;
    }
  }
  return cv::countNonZero(open) >= kMinOpenSkyShare * static_cast<double>(seen.total()) ? open : high;
}

/// Sky fades smoothly downward from what is surely sky; the colours met on the way are then sky in openings
/// too.
void MarkSky(const cv::Mat3b& smooth, const Horizon& horizon, cv::Mat1b& seen) {
  const double least = LeastSkyBrightness(smooth, horizon, seen);
  ColorSet high;
  const cv::Mat1b is_open = FindOpenSky(horizon, seen);
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      if (is_open(y, x) != 0 && Brightness(smooth(y, x)) >= least) high.Add(smooth(y, x));
    }
  }
  high.Close(kMinSkyShare);
  ColorSet all;
  cv::Mat1b faded(seen.size(), uchar{0});
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      if (seen(y, x) != 0 || horizon.Rise(x, y) <= 0.0) continue;
      const cv::Vec3b& color = smooth(y, x);
      if (Brightness(color) < least) continue;
      const bool goes_on =
          y > 0 && faded(y - 1, x) != 0 && LargestStep(color, smooth(y - 1, x)) <= kMaxSkyStep;
      if (!goes_on && !(horizon.Rise(x, y) > kSurelySkyRise && high.Has(color))) continue;
      faded(y, x) = 1;
      all.Add(color);
    }
  }
  all.Close(kMinSkyShare);
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      if (seen(y, x) == 0 && horizon.Rise(x, y) > 0.0 && all.Has(smooth(y, x))) {
        seen(y, x) = static_cast<uchar>(Seen::kSky);
      }
    }
  }
}

struct Chroma {
  float red = 0.0F;
  float green = 0.0F;
  float sum = 0.0F;

  explicit Chroma(const cv::Vec3b& color) : sum(static_cast<float>(color[0] + color[1] + color[2])) {
    red = sum > 0.0F ? static_cast<float>(color[2]) / sum : 0.0F;
    green = sum > 0.0F ? static_cast<float>(color[1]) / sum : 0.0F;
  }
};

/// One colour of the ground, in light or in shade.
struct Tone {
  double red = 0.0;
  double green = 0.0;
  double spread = 0.0;  ///< Median absolute deviation of the chromaticity.

  bool Explains(const Chroma& seen) const {
    const double reach = kChromaReach + 3.0 * spread + kDarkNoise / std::max(1.0F, seen.sum);
    return std::hypot(seen.red - red, seen.green - green) <= reach;
  }
};

Tone LearnTone(const std::vector<Chroma>& samples) {
  std::vector<float> reds, greens, deviations;
  for (const Chroma& sample : samples) {
    reds.push_back(sample.red);
    greens.push_back(sample.green);
  }
  Tone tone;
  tone.red = Quantile(reds, 0.5);
  tone.green = Quantile(greens, 0.5);
  for (const float red : reds) deviations.push_back(std::abs(red - static_cast<float>(tone.red)));
  for (const float green : greens) deviations.push_back(std::abs(green - static_cast<float>(tone.green)));
  tone.spread = Quantile(deviations, 0.5);
  return tone;
}

/// The ground's colours: shade is lit by the sky alone, so it has a tone of its own.
struct GroundModel {
  std::vector<Tone> tones;
  double least_sum = 0.0;
  double most_sum = -1.0;

  bool Explains(const cv::Vec3b& color) const {
    const Chroma seen(color);
    if (seen.sum < least_sum || seen.sum > most_sum) return false;
    return std::any_of(tones.begin(), tones.end(), [&](const Tone& tone) { return tone.Explains(seen); });
  }
};

/// The brightness that tells light from shade best (Otsu 1979).
float SplitBrightness(const std::vector<Chroma>& samples) {
  std::array<double, 96> count{};  // 8 levels of the sum of three channels each.
  double all = 0.0, all_sum = 0.0;
  for (const Chroma& sample : samples) {
    const std::size_t bin = std::min<std::size_t>(95, static_cast<std::size_t>(sample.sum / 8.0F));
    count[bin] += 1.0;
    all += 1.0;
    all_sum += static_cast<double>(bin);
  }
  double below = 0.0, below_sum = 0.0, best = -1.0;
  std::size_t split = 0;
  for (std::size_t bin = 0; bin + 1 < count.size(); ++bin) {
    below += count[bin];
    below_sum += count[bin] * static_cast<double>(bin);
    if (below == 0.0 || below == all) continue;
    const double apart = below_sum / below - (all_sum - below_sum) / (all - below);
    const double between = below * (all - below) * apart * apart;
    if (between > best) {
      best = between;
      split = bin;
    }
  }
  return 8.0F * static_cast<float>(split + 1);
}

GroundModel LearnGround(const cv::Mat3b& smooth, const Horizon& horizon, const cv::Mat1b& seen) {
  double lowest_rise = 0.0;
  for (const int x : {0, seen.cols - 1}) lowest_rise = std::min(lowest_rise, horizon.Rise(x, seen.rows - 1));
  const double below = std::min(kSurelyGroundRise, kGroundShare * lowest_rise);
  std::vector<Chroma> samples;
  std::vector<float> sums;
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      if (seen(y, x) != 0 || horizon.Rise(x, y) > below) continue;
      samples.emplace_back(smooth(y, x));
      sums.push_back(samples.back().sum);
    }
  }
  GroundModel model;
  if (samples.size() < kMinGround_px) return model;
  const float split = SplitBrightness(samples);
  std::vector<Chroma> dark, light;
  for (const Chroma& sample : samples) (sample.sum < split ? dark : light).push_back(sample);
  for (const std::vector<Chroma>* part : {&dark, &light}) {
    if (static_cast<double>(part->size()) >= kMinToneShare * static_cast<double>(samples.size())) {
      model.tones.push_back(LearnTone(*part));
    }
  }
  model.least_sum = kDeepestShade * Quantile(sums, 0.5);
  model.most_sum = 1.15 * Quantile(sums, 0.995);
  return model;
}

void MarkGround(const cv::Mat3b& smooth, const Horizon& horizon, cv::Mat1b& seen) {
  const GroundModel model = LearnGround(smooth, horizon, seen);
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      if (seen(y, x) == 0 && horizon.Rise(x, y) < 0.0 && model.Explains(smooth(y, x))) {
        seen(y, x) = static_cast<uchar>(Seen::kGround);
      }
    }
  }
}

/// Median light of the pixels of one label whose rays rise between two tangents; none when there are few.
std::optional<cv::Vec3f> MedianLight(const cv::Mat3b& smooth, const Horizon& horizon, const cv::Mat1b& seen,
                                     Seen label, double from, double to) {
  std::array<std::vector<float>, 3> channels;
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      const double rise = horizon.Rise(x, y);
      if (seen(y, x) != static_cast<uchar>(label) || rise < from || rise > to) continue;
      const cv::Vec3f light = Light(smooth(y, x));
      for (int c = 0; c < 3; ++c) channels[static_cast<std::size_t>(c)].push_back(light[c]);
    }
  }
  if (channels[0].size() < kMinHaze_px) return std::nullopt;
  cv::Vec3f light;
  for (int c = 0; c < 3; ++c)
    light[c] = static_cast<float>(Quantile(channels[static_cast<std::size_t>(c)], 0.5));
  return light;
}

/// Far ground as haze veils it: light fades exponentially with the distance (H. Koschmieder, 1924), which
/// goes with 1 / fall, the tangent below the horizon.
struct Haze {
  cv::Vec3f ground;
  cv::Vec3f sky;
  double density = 0.0;  ///< Height of the camera over the distance at which 1 / e of the light is left.

  /// Share of the haze in a pixel's light; none when its colour is no mixture.
  std::optional<double> Veil(const cv::Vec3b& color) const {
    const cv::Vec3f way = sky - ground;
    const cv::Vec3f step = Light(color) - ground;
    const float share = way.dot(step) / std::max(1.0F, way.dot(way));
    if (cv::norm(step - share * way) > kMostBeside * cv::norm(way)) return std::nullopt;
    return share;
  }
  bool Explains(const cv::Vec3b& color, double fall) const {
    const std::optional<double> veil = Veil(color);
    return veil && std::abs(*veil - (1.0 - std::exp(-density / fall))) < kMostVeilError;
  }
};

/// Learned from what is below the horizon and has no label but may be hazy ground.
std::optional<Haze> LearnHaze(const cv::Mat3b& smooth, const Horizon& horizon, const cv::Mat1b& seen) {
  const auto ground = MedianLight(smooth, horizon, seen, Seen::kGround, -1.0, -kHazeFall);
  const auto sky = MedianLight(smooth, horizon, seen, Seen::kSky, 0.0, kHazeFall);
  if (!ground || !sky) return std::nullopt;
  Haze haze{*ground, *sky};
  std::vector<float> densities;
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      const double fall = -horizon.Rise(x, y);
      if (seen(y, x) != 0 || fall <= 0.0 || fall > kHazeFall) continue;
      const std::optional<double> veil = haze.Veil(smooth(y, x));
      if (veil && *veil > 0.1 && *veil < 0.9)
        densities.push_back(static_cast<float>(-std::log(1.0 - *veil) * fall));
    }
  }
  if (densities.size() < kMinHaze_px) return std::nullopt;
  haze.density = Quantile(densities, 0.5);
  return haze;
}

void MarkHazyGround(const cv::Mat3b& smooth, const Horizon& horizon, cv::Mat1b& seen) {
  const std::optional<Haze> haze = LearnHaze(smooth, horizon, seen);
  if (!haze) return;
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      const double fall = -horizon.Rise(x, y);
      if (seen(y, x) == 0 && fall > 0.0 && fall < kHazeFall && haze->Explains(smooth(y, x), fall))
        seen(y, x) = static_cast<uchar>(Seen::kGround);
    }
  }
}

/// Single noisy pixels take the label that surrounds them; a thin line is not a speck.
void DropSpecks(const Horizon& horizon, cv::Mat1b& seen) {
  cv::Mat1i component;
  cv::Mat stats, centers;
  const int count = cv::connectedComponentsWithStats(seen == 0, component, stats, centers, 8, CV_32S);
  cv::Mat1b around;
  cv::dilate(seen, around, cv::Mat());
  for (int y = 0; y < seen.rows; ++y) {
    for (int x = 0; x < seen.cols; ++x) {
      const int i = component(y, x);
      if (i == 0 || i >= count || stats.at<int>(i, cv::CC_STAT_AREA) >= kMinSpeck_px) continue;
      const bool is_above = horizon.Rise(x, y) > 0.0;
      uchar label = around(y, x);
      if (is_above && label == static_cast<uchar>(Seen::kGround)) label = 0;
      if (!is_above && label == static_cast<uchar>(Seen::kSky)) label = static_cast<uchar>(Seen::kGround);
      seen(y, x) = label;
    }
  }
}

}  // namespace

Sight LabelSight(const Image& image, const Mask& buildings, const FacadeOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  SOFFIT_EXPECT(!image.bgr.empty());
  SOFFIT_EXPECT(buildings.label.size() == image.bgr.size());
  Sight sight;
  sight.capture_id = image.capture_id;
  sight.has_trusted_pose = image.has_trusted_pose;
  sight.view = image.view;
  sight.taken = image.taken;
  sight.bgr = image.bgr;
  sight.seen = cv::Mat1b(image.bgr.size(), static_cast<uchar>(Seen::kUnexplained));
  cv::Mat3b smooth;
  cv::GaussianBlur(image.bgr, smooth, cv::Size(3, 3), 0.0);
  const Horizon horizon(image.view);
  MarkStructure(smooth, UnveilTable(image), buildings, sight.seen);
  MarkSky(smooth, horizon, sight.seen);
  MarkGround(smooth, horizon, sight.seen);
  MarkHazyGround(smooth, horizon, sight.seen);
  DropSpecks(horizon, sight.seen);
  sight.shown = image.seen & cv::Rect(0, 0, sight.seen.cols, sight.seen.rows);
  cv::Mat1b outside(sight.seen.size(), uchar{255});
  outside(sight.shown) = 0;
  sight.seen.setTo(static_cast<uchar>(Seen::kUnexplained), outside);
  return sight;
}

}  // namespace soffit
