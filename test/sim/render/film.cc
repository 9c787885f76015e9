#include "test/sim/render/film.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "test/sim/world/noise.h"

namespace soffit::sim {
namespace {

/// The automatic exposure follows the picture's mean only partly, as cameras do.
double FindGain(const cv::Mat3f& light, double nominal_gain) {
  constexpr double kMiddle = 0.27, kFollow = 0.4, kLeast = 0.75, kMost = 1.5;
  const cv::Scalar mean = cv::mean(light);
  const double brightness = (0.07 * mean[0] + 0.72 * mean[1] + 0.21 * mean[2]) * nominal_gain;
  return nominal_gain * std::clamp(std::pow(kMiddle / std::max(brightness, 1e-3), kFollow), kLeast, kMost);
}

float ToneOf(float linear) {
  constexpr float kShoulder = 0.75F;  // Above it highlights are compressed.
  const float rest = 1.0F - kShoulder;
  const float bounded = linear < kShoulder ? linear : 1.0F - rest * std::exp((kShoulder - linear) / rest);
  return bounded <= 0.0031308F ? 12.92F * bounded : 1.055F * std::pow(bounded, 1.0F / 2.4F) - 0.055F;
}

/// ToneOf by table: 255 levels need no more than a 12 bit one on a square root scale.
class ToneCurve {
 public:
  ToneCurve() {
    for (int i = 0; i < kSize; ++i) {
      const float root = kMaxRoot * static_cast<float>(i) / (kSize - 1);
      table_[i] = 255.0F * ToneOf(root * root);
    }
  }
  float operator()(float linear) const {
    const float at = std::min(std::sqrt(std::max(linear, 0.0F)) / kMaxRoot, 1.0F) * (kSize - 1);
    const int index = std::min(static_cast<int>(at), kSize - 2);
    return table_[index] + (at - static_cast<float>(index)) * (table_[index + 1] - table_[index]);
  }

 private:
  static constexpr int kSize = 4096;
  static constexpr float kMaxRoot = 2.0F;
  std::array<float, kSize> table_{};
};

}  // namespace

cv::Mat3b Develop(const cv::Mat3f& light, const CameraModel& camera, double nominal_gain,
                  std::uint64_t seed) {
  static const ToneCurve kTone;
  cv::Mat3f picture = light.clone();
  cv::patchNaNs(picture, 0.0);  // A ray that went astray is black.
  const double found = FindGain(picture, nominal_gain);
  if (camera.blur_px > 0.0) cv::GaussianBlur(picture, picture, {}, camera.blur_px);
  const auto gain = static_cast<float>(found * std::exp2(camera.exposure_ev));
  cv::Mat3f noise(picture.size(), cv::Vec3f(0, 0, 0));
  cv::RNG random(Mix(seed));
  if (camera.noise_levels > 0.0) random.fill(noise, cv::RNG::NORMAL, 0.0, camera.noise_levels);

  cv::Mat3b developed(picture.size());
  const auto middle_x = static_cast<float>(camera.intrinsics.cx_px),
             middle_y = static_cast<float>(camera.intrinsics.cy_px);
  const float corner2 = middle_x * middle_x + middle_y * middle_y;
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const float x = static_cast<float>(column) - middle_x, y = static_cast<float>(row) - middle_y;
      const float dim = 1.0F - static_cast<float>(camera.vignetting) * (x * x + y * y) / corner2;
      const cv::Vec3f in = gain * dim * picture(row, column);
      for (int c = 0; c < 3; ++c) {
        const float level = kTone(in[c]);
        const float grain = 0.6F + 0.7F * std::sqrt(level / 255.0F);  // Photons come by chance.
        developed(row, column)[c] = cv::saturate_cast<std::uint8_t>(level + grain * noise(row, column)[c]);
      }
    }
  }
  return developed;
}

}  // namespace soffit::sim
