#include "test/bench/overview.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

namespace soffit::bench {
namespace {

constexpr int kColumns = 6;
constexpr int kRows = 4;

/// Noise of several grains, as of grass and soil.
cv::Mat3b Ground(cv::Size size, cv::RNG& random) {
  cv::Mat3f ground(size, cv::Vec3f(70, 105, 100));
  for (const int grain_px : {1, 8, 64}) {
    cv::Mat1f coarse(size / grain_px + cv::Size(1, 1));
    random.fill(coarse, cv::RNG::NORMAL, 0.0, 10.0);
    cv::Mat1f fine;
    cv::resize(coarse, fine, size, 0.0, 0.0, cv::INTER_LINEAR);
    cv::Mat3f gray;
    cv::merge(std::vector<cv::Mat>{fine, fine, fine}, gray);
    ground += gray;
  }
  cv::Mat3b result;
  ground.convertTo(result, CV_8U);
  return result;
}

void PaintBoxes(cv::Mat3b& picture, cv::RNG& random) {
  const cv::Scalar paints[] = {{40, 35, 190}, {190, 70, 30}, {30, 190, 215}};  // Red, blue, yellow; BGR.
  const float cell = static_cast<float>(picture.cols) / kColumns;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const cv::Point2f center((static_cast<float>(i % kColumns) + 0.5f) * cell,
                             (static_cast<float>(i / kColumns) + 0.6f) * cell);
    const cv::Size2f sides(cell * random.uniform(0.25f, 0.6f), cell * random.uniform(0.2f, 0.5f));
    cv::Point2f corner[4];
    cv::RotatedRect(center, sides, random.uniform(0.0f, 180.0f)).points(corner);
    const std::vector<cv::Point> ring(corner, corner + 4);
    cv::fillConvexPoly(picture, ring, paints[i % 3], cv::LINE_AA);
  }
}

void AddSensorNoise(cv::Mat3b& picture, cv::RNG& random) {
  cv::Mat noise(picture.size(), CV_16SC3);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 6.0);
  cv::add(picture, noise, picture, cv::noArray(), CV_8UC3);
}

}  // namespace

Capture MakeOverview(int width_px, bool has_lens) {
  cv::RNG random(7);
  const cv::Size size(width_px, width_px * 3 / 4);
  cv::Mat3b picture = Ground(size, random);
  PaintBoxes(picture, random);
  AddSensorNoise(picture, random);

  Capture capture;
  capture.purpose = Purpose::kOverview;
  capture.intrinsics = {size.width,
                        size.height,
                        0.8 * width_px,
                        0.8 * width_px,
                        0.5 * (size.width - 1),
                        0.5 * (size.height - 1),
                        {}};
  if (has_lens) capture.intrinsics.distortion = {-0.05, 0.02, 0.0005, -0.0004, 0.0};
  capture.map_from_camera = {CameraAttitude(0.0, -std::numbers::pi / 2), {0.0, 0.0, 60.0}};
  cv::imencode(".jpg", picture, capture.bytes, {cv::IMWRITE_JPEG_QUALITY, 90});
  return capture;
}

std::vector<Polygon> MakeVectorMap(std::size_t count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<Polygon> map;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d half(4.0 + 8.0 * unit(random), 4.0 + 8.0 * unit(random));
    const Eigen::Rotation2Dd turn(2.0 * std::numbers::pi * unit(random));
    const Eigen::Vector2d center(40.0 * static_cast<double>(i % 32), 40.0 * static_cast<double>(i / 32));
    const auto cuts = static_cast<int>(4.0 * unit(random));
    Polygon building;
    const Eigen::Vector2d signs[] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector2d corner = signs[k].cwiseProduct(half);
      if (k >= cuts) {
        building.outer.push_back(corner);
        continue;
      }
      const Eigen::Vector2d cut = -signs[k].cwiseProduct(half) * (0.3 + 0.5 * unit(random));
      const Eigen::Vector2d along_x(cut.x(), 0.0);
      const Eigen::Vector2d along_y(0.0, cut.y());
      const bool comes_along_x = k % 2 == 1;  // The side before an odd corner is horizontal.
      building.outer.push_back(corner + (comes_along_x ? along_x : along_y));
      building.outer.push_back(corner + cut);
      building.outer.push_back(corner + (comes_along_x ? along_y : along_x));
    }
    for (Eigen::Vector2d& corner : building.outer) corner = center + turn * corner;
    map.push_back(std::move(building));
  }
  return map;
}

}  // namespace soffit::bench
