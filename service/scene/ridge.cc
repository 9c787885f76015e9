#include "service/scene/ridge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

constexpr double kSmoothing_px = 1.0;
constexpr float kWeakHeight = 1.0F;   // Second derivative, of 255 per square pixel, of any ridge,
constexpr float kClearHeight = 2.0F;  // and somewhere on a clear one.
constexpr float kWeak = 2.0F;         // Times the height that is usual about it.
constexpr float kClear = 3.0F;
constexpr int kAbout_px = 31;
constexpr float kMostAlong = 0.4F;      // Curvature along a ridge, over that across.
constexpr float kMostBeside_px = 0.7F;  // From a ridge's middle to its pixel.
constexpr float kSameDirection = 0.9F;  // Cosine.
constexpr int kGap_px = 2;
constexpr double kSameLine = 0.985;  // Cosine,
constexpr double kBesideLine_px = 2.5;
constexpr double kMostGap_px = 12.0;
constexpr double kLeastLong_px = 5.0;
constexpr double kClearlyLong_px = 12.0;
constexpr double kMostPixels = 1.3;  // Of a clear one, per pixel of length: texture is wider.

/// How brightness is curved at a pixel.
struct Crest {
  float height = 0.0F;  ///< Second derivative across a ridge; 0: there is none.
  float x = 0.0F;       ///< Unit vector across.
  float y = 0.0F;
  bool is_middle = false;  ///< The ridge's middle is within the pixel.
};

Crest FindCrest(const float* above, const float* here, const float* below) {
  const float xx = here[-1] - 2.0F * here[0] + here[1];
  const float yy = above[0] - 2.0F * here[0] + below[0];
  const float xy = 0.25F * (above[-1] - above[1] - below[-1] + below[1]);
  const float mean = 0.5F * (xx + yy);
  const float spread = std::sqrt(0.25F * (xx - yy) * (xx - yy) + xy * xy);
  const float across = mean >= 0.0F ? mean + spread : mean - spread;
  const float along = mean >= 0.0F ? mean - spread : mean + spread;
  if (std::abs(across) < kWeakHeight || std::abs(along) > kMostAlong * std::abs(across)) return {};
  const bool is_steep = std::abs(across - xx) > std::abs(across - yy);
  const float x = is_steep ? xy : across - yy;
  const float y = is_steep ? across - xx : xy;
  const float norm = std::hypot(x, y);
  const float slope = 0.5F * ((here[1] - here[-1]) * x + (below[0] - above[0]) * y);
  return {across, x / norm, y / norm, std::abs(slope) <= kMostBeside_px * norm * std::abs(across)};
}

/// Of each pixel but those at the picture's edge, where it is the highest one across.
class Crests {
 public:
  explicit Crests(const cv::Mat1b& picture) : crests_(picture.total()), size_(picture.size()) {
    cv::Mat1f smooth;
    picture.convertTo(smooth, CV_32F);
    cv::GaussianBlur(smooth, smooth, cv::Size(), kSmoothing_px);
    cv::Laplacian(smooth, usual_, CV_32F);
    cv::blur(cv::abs(usual_), usual_, cv::Size(kAbout_px, kAbout_px));
    std::vector<Crest> all(crests_.size());
    for (int y = 1; y + 1 < size_.height; ++y) {
      for (int x = 1; x + 1 < size_.width; ++x)
        all[Number({x, y})] = FindCrest(&smooth(y - 1, x), &smooth(y, x), &smooth(y + 1, x));
    }
    for (int y = 1; y + 1 < size_.height; ++y) {
      for (int x = 1; x + 1 < size_.width; ++x) {
        const Crest& crest = all[Number({x, y})];
        const cv::Point beside(cvRound(crest.x), cvRound(crest.y));
        const float highest = std::max(std::abs(all[Number(cv::Point(x, y) + beside)].height),
                                       std::abs(all[Number(cv::Point(x, y) - beside)].height));
        if (crest.is_middle && std::abs(crest.height) >= highest) At({x, y}) = crest;
      }
    }
  }

  bool IsCrest(const cv::Point& at) const { return StandsOut(at, kWeakHeight, kWeak); }
  bool IsClear(const cv::Point& at) const { return StandsOut(at, kClearHeight, kClear); }

  struct Chain {
    std::vector<cv::Point> pixels;
    bool is_clear = false;  ///< Somewhere.
  };

  /// Takes all crests that hang together with this one, and about run along one another.
  Chain Take(const cv::Point& first) {
    Chain chain{{first}, IsClear(first)};
    std::vector<cv::Point>& taken = chain.pixels;
    std::vector<Crest> directions = {At(first)};
    At(first) = {};
    for (std::size_t i = 0; i < taken.size(); ++i) {
      for (int k = 0; k < kWindow * kWindow; ++k) {
        const cv::Point next = taken[i] + cv::Point(k % kWindow - kGap_px, k / kWindow - kGap_px);
        if (!cv::Rect({}, size_).contains(next)) continue;
        const Crest crest = At(next);
        const float cosine = crest.x * directions[i].x + crest.y * directions[i].y;
        if (!IsCrest(next) || std::abs(cosine) < kSameDirection) continue;
        chain.is_clear = chain.is_clear || IsClear(next);
        taken.push_back(next);
        directions.push_back(crest);
        At(next) = {};
      }
    }
    return chain;
  }

 private:
  static constexpr int kWindow = 2 * kGap_px + 1;

  std::size_t Number(const cv::Point& at) const {
    return static_cast<std::size_t>(at.y) * static_cast<std::size_t>(size_.width) +
           static_cast<std::size_t>(at.x);
  }
  Crest& At(const cv::Point& at) { return crests_[Number(at)]; }

  bool StandsOut(const cv::Point& at, float least, float times) const {
    const float height = std::abs(crests_[Number(at)].height);
    return height >= least && height >= times * usual_(at);
  }

  std::vector<Crest> crests_;
  cv::Size size_;
  cv::Mat1f usual_;
};

Ridge Measure(std::vector<cv::Point> pixels) {
  cv::Vec4d line;
  cv::fitLine(pixels, line, cv::DIST_L2, 0.0, 0.01, 0.01);
  Ridge ridge;
  ridge.along = {line[0], line[1]};
  const cv::Point2d middle(line[2], line[3]);
  const auto place = [&](const cv::Point& pixel) { return (cv::Point2d(pixel) - middle).dot(ridge.along); };
  const auto [first, last] =
      std::minmax_element(pixels.begin(), pixels.end(),
                          [&](const cv::Point& a, const cv::Point& b) { return place(a) < place(b); });
  ridge.ends_px[0] = middle + place(*first) * ridge.along;
  ridge.ends_px[1] = middle + place(*last) * ridge.along;
  ridge.pixels = std::move(pixels);
  return ridge;
}

/// Whether the other ridge reaches beyond an end of this one, in its line.
bool GoesOn(const Ridge& ridge, const Ridge& other, double pixel) {
  if (std::abs(ridge.along.dot(other.along)) < kSameLine) return false;
  const double gap_px = kMostGap_px * pixel;
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (const cv::Point2d& end : other.ends_px) {
    const cv::Point2d from = end - ridge.ends_px[0];
    if (std::abs(from.cross(ridge.along)) > kBesideLine_px * pixel) return false;
    first = std::min(first, from.dot(ridge.along));
    last = std::max(last, from.dot(ridge.along));
  }
  const bool is_beyond = first < -pixel || last > ridge.length_px() + pixel;
  return is_beyond && last > -gap_px && first < ridge.length_px() + gap_px;
}

}  // namespace

std::vector<Ridge> FindRidges(const cv::Mat1b& picture) {
  std::vector<Ridge> ridges;
  if (picture.empty()) return ridges;
  Crests crests(picture);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      if (!crests.IsCrest({x, y})) continue;
      Crests::Chain chain = crests.Take({x, y});
      if (static_cast<double>(chain.pixels.size()) < kLeastLong_px) continue;
      Ridge ridge = Measure(std::move(chain.pixels));
      ridge.is_clear = chain.is_clear && ridge.length_px() >= kClearlyLong_px &&
                       static_cast<double>(ridge.pixels.size()) <= kMostPixels * ridge.length_px();
      if (ridge.length_px() >= kLeastLong_px) ridges.push_back(std::move(ridge));
    }
  }
  return ridges;
}

Ridge JoinRidges(Ridge ridge, const std::vector<Ridge>& others, double pixel) {
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (const Ridge& other : others) {
      if (!GoesOn(ridge, other, pixel)) continue;
      const double before_px = ridge.length_px();
      std::vector<cv::Point> pixels = ridge.pixels;
      pixels.insert(pixels.end(), other.pixels.begin(), other.pixels.end());
      Ridge joined = Measure(std::move(pixels));
      joined.is_clear = ridge.is_clear;
      if (joined.length_px() < before_px + pixel) continue;
      ridge = std::move(joined);
      has_grown = true;
    }
  }
  return ridge;
}

}  // namespace soffit
