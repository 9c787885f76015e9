#include "test/sim/render/film.h"

#include <gtest/gtest.h>

#include <limits>

namespace soffit::sim {
namespace {

TEST(Develop, TakesAPixelWithoutANumberForBlack) {
  CameraModel camera;
  camera.intrinsics = {4, 4, 4.0, 4.0, 1.5, 1.5, {}};
  camera.blur_px = 0.0;
  camera.noise_levels = 0.0;
  cv::Mat3f light(4, 4, cv::Vec3f(0.2F, 0.2F, 0.2F));
  light(1, 2) = cv::Vec3f::all(std::numeric_limits<float>::quiet_NaN());
  const cv::Mat3b developed = Develop(light, camera, 1.0, 1);
  EXPECT_EQ(developed(1, 2), cv::Vec3b(0, 0, 0));
  EXPECT_GT(developed(2, 2)[1], 60);
}

}  // namespace
}  // namespace soffit::sim
