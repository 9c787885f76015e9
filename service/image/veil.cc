#include "service/image/veil.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace soffit {
namespace {

constexpr double kDarkestShare = 0.005;  // Of the pixels.
constexpr double kMostOfUsual = 0.33;    // Of the median light.
constexpr double kLifted = 0.9;          // Of the veil: what is darkest is not quite black.
constexpr int kLeastLevel = 24;          // Of 255: shade is no darker without haze.
constexpr int kSampledRows = 256;
constexpr double kDownward = -0.5;  // Of the optical axis' rise.

/// Of the channel in which each pixel is darkest, in some rows of the picture.
std::array<int, 256> SampleDarkChannel(const cv::Mat3b& bgr) {
  std::array<int, 256> histogram{};
  const int stride = std::max(1, bgr.rows / kSampledRows);
  for (int y = stride / 2; y < bgr.rows; y += stride) {
    for (int x = 0; x < bgr.cols; ++x) {
      const cv::Vec3b& color = bgr(y, x);
      ++histogram[std::min({color[0], color[1], color[2]})];
    }
  }
  return histogram;
}

int Quantile(const std::array<int, 256>& histogram, double share) {
  double count = 0.0;
  for (const int pixels : histogram) count += pixels;
  double below = 0.0;
  int level = 0;
  while (level < 255 && (below += histogram[static_cast<std::size_t>(level)]) <= share * count) ++level;
  return level;
}

}  // namespace

cv::Mat1b UnveilTable(const Image& image) {
  cv::Mat1b table(1, 256);
  std::iota(table.begin(), table.end(), uchar{0});
  const Eigen::Vector3d axis = image.view.map_from_camera.rotation * Eigen::Vector3d::UnitZ();
  if (!image.has_trusted_pose || axis.z() < kDownward) return table;
  const std::array<int, 256> dark = SampleDarkChannel(image.bgr);
  const int darkest = Quantile(dark, kDarkestShare);
  if (darkest < kLeastLevel) return table;
  const double usual = Quantile(dark, 0.5);
  const double veil = kLifted * std::min<double>(darkest * darkest, kMostOfUsual * usual * usual);
  for (int level = 0; level < 256; ++level)
    table(0, level) = cv::saturate_cast<uchar>(std::sqrt(std::max(0.0, level * level - veil)));
  return table;
}

}  // namespace soffit
