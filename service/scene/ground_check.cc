#include "service/scene/ground_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr float kUnseen = std::numeric_limits<float>::quiet_NaN();
constexpr float kMaxDispute = 0.30F;     // Of the logarithm of brightness.
constexpr int kMinDisputed = 3;          // Of the 9 places around one: single ones are noise, a rope makes a line.
constexpr int kMisfit = 2;               // Places by which two pictures may lie beside each other.
constexpr std::size_t kMinCommon = 50;   // Places that two pictures must share to be compared.

struct Raster {
  Eigen::Vector2d low_m;
  double cell_m = 0.0;
  int columns = 0;
  int rows = 0;
  Eigen::Vector3d At(int column, int row) const {
    return {low_m.x() + (column + 0.5) * cell_m, low_m.y() + (row + 0.5) * cell_m, 0.0};
  }
};

/// Where the picture shows this point of the ground, and takes it for ground.
std::optional<cv::Point> FindGroundPixel(const Sight& sight, const Prediction& prediction, const Eigen::Vector3d& point) {
  const auto pixel = Project(sight.view, point);
  if (!pixel) return std::nullopt;
  if (!(pixel->x() >= 1.0 && pixel->y() >= 1.0 && pixel->x() <= sight.seen.cols - 2.0 &&
        pixel->y() <= sight.seen.rows - 2.0)) {
    return std::nullopt;
  }
  const cv::Point at(static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())));
  if (sight.seen(at) != static_cast<uchar>(Seen::kGround)) return std::nullopt;
  if (prediction.label(at) != static_cast<uchar>(Seen::kGround)) return std::nullopt;
  return at;
}

/// Brightness (logarithm) of each place as one picture shows it; NaN where it does not.
cv::Mat1f ReadBrightness(const Sight& sight, const Prediction& prediction, const Raster& raster) {
  cv::Mat1b grey;
  cv::cvtColor(sight.bgr, grey, cv::COLOR_BGR2GRAY);
  cv::blur(grey, grey, cv::Size(3, 3));
  cv::Mat1f brightness(raster.rows, raster.columns, kUnseen);
  for (int row = 0; row < raster.rows; ++row) {
    for (int column = 0; column < raster.columns; ++column) {
      const auto at = FindGroundPixel(sight, prediction, raster.At(column, row));
      if (at) brightness(row, column) = std::log(static_cast<float>(grey(*at)) + 4.0F);
    }
  }
  return brightness;
}

struct Range {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
};

Range Around(const cv::Mat1f& brightness, int row, int column) {
  Range range;
  for (int y = std::max(0, row - kMisfit); y <= std::min(brightness.rows - 1, row + kMisfit); ++y) {
    for (int x = std::max(0, column - kMisfit); x <= std::min(brightness.cols - 1, column + kMisfit); ++x) {
      if (std::isnan(brightness(y, x))) continue;
      range.low = std::min(range.low, brightness(y, x));
      range.high = std::max(range.high, brightness(y, x));
    }
  }
  return range;
}

float Outside(float value, const Range& range) { return std::max(range.low - value, value - range.high); }

cv::Mat1b FindDisputed(const cv::Mat1f& a, const cv::Mat1f& b) {
  cv::Mat1b disputed(a.size(), uchar{0});
  std::vector<float> gains;
  for (int row = 0; row < a.rows; ++row) {
    for (int column = 0; column < a.cols; ++column) {
      const float gain = a(row, column) - b(row, column);
      if (!std::isnan(gain)) gains.push_back(gain);
    }
  }
  if (gains.size() < kMinCommon) return disputed;
  const auto middle = gains.begin() + static_cast<std::ptrdiff_t>(gains.size() / 2);
  std::nth_element(gains.begin(), middle, gains.end());
  const float gain = *middle;
  for (int row = 0; row < a.rows; ++row) {
    for (int column = 0; column < a.cols; ++column) {
      if (std::isnan(a(row, column)) || std::isnan(b(row, column))) continue;
      const float apart = std::max(Outside(a(row, column) - gain, Around(b, row, column)),
                                   Outside(b(row, column) + gain, Around(a, row, column)));
      if (apart > kMaxDispute) disputed(row, column) = 1;
    }
  }
  cv::Mat1b around;
  cv::boxFilter(disputed, around, CV_8U, cv::Size(3, 3), cv::Point(-1, -1), false, cv::BORDER_CONSTANT);
  cv::Mat1b lone;
  cv::compare(around, static_cast<double>(kMinDisputed), lone, cv::CMP_LT);
  disputed.setTo(0, lone);
  return disputed;
}

void Withdraw(const cv::Mat1b& disputed, const Raster& raster, const Prediction& prediction, Sight& sight) {
  for (int row = 0; row < raster.rows; ++row) {
    for (int column = 0; column < raster.columns; ++column) {
      if (disputed(row, column) == 0) continue;
      const auto at = FindGroundPixel(sight, prediction, raster.At(column, row));
      if (!at) continue;
      const double depth = prediction.depth_m(*at);
      const double camera_height = sight.view.map_from_camera.translation_m.z();
      const Intrinsics& k = sight.view.intrinsics;
      const int half_x = 1 + static_cast<int>(0.5 * raster.cell_m * k.fx_px / depth);
      const int half_y = 1 + static_cast<int>(0.5 * raster.cell_m * k.fy_px * camera_height / (depth * depth));
      const cv::Rect patch(at->x - half_x, at->y - half_y, 2 * half_x + 1, 2 * half_y + 1);
      sight.seen(patch & cv::Rect(0, 0, sight.seen.cols, sight.seen.rows)).setTo(static_cast<uchar>(Seen::kUnexplained));
    }
  }
}

}  // namespace

void RejectDisputedGround(const std::vector<Prediction>& predictions, const Eigen::Vector2d& low_m,
                          const Eigen::Vector2d& high_m, double cell_m, std::vector<Sight>& sights) {
  SOFFIT_EXPECT(predictions.size() == sights.size() && cell_m > 0.0);
  const Eigen::Vector2d size = high_m - low_m;
  if (!(size.minCoeff() > 0.0)) return;
  const Raster raster{low_m, cell_m, static_cast<int>(size.x() / cell_m), static_cast<int>(size.y() / cell_m)};
  if (raster.columns < 3 || raster.rows < 3) return;
  std::vector<cv::Mat1f> brightness;
  for (std::size_t i = 0; i < sights.size(); ++i) brightness.push_back(ReadBrightness(sights[i], predictions[i], raster));
  std::vector<cv::Mat1b> disputed(sights.size(), cv::Mat1b());
  for (std::size_t i = 0; i < sights.size(); ++i) {
    for (std::size_t j = i + 1; j < sights.size(); ++j) {
      const cv::Mat1b of_pair = FindDisputed(brightness[i], brightness[j]);
      for (const std::size_t k : {i, j}) {
        if (disputed[k].empty()) {
          disputed[k] = of_pair.clone();
        } else {
          cv::bitwise_or(disputed[k], of_pair, disputed[k]);
        }
      }
    }
  }
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (!disputed[i].empty()) Withdraw(disputed[i], raster, predictions[i], sights[i]);
  }
}

}  // namespace soffit
