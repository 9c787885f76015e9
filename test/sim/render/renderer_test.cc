#include "test/sim/render/renderer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libexif/exif-data.h>

#include <numbers>
#include <opencv2/imgcodecs.hpp>

#include "shared/frames/frames.h"

namespace soffit::sim {
namespace {

Structure Box(const std::string& id, const Eigen::Vector2d& center, const Eigen::Vector2d& size, double low_m,
              double high_m) {
  const Eigen::Vector2d half = size / 2;
  Prism prism;
  prism.section.outer = {{-half.x(), -half.y()}, {half.x(), -half.y()}, half, {-half.x(), half.y()}};
  prism.low_m = low_m;
  prism.high_m = high_m;
  Structure box;
  box.id = id;
  box.position_m = center;
  box.finish = {{0.8, 0.05, 0.05}, Pattern::kPlain, 1.0, 0.0};
  box.parts = {Part{prism, {}}};
  return box;
}

World SmallWorld() {
  World world;
  world.camera.intrinsics = {320, 240, 200, 200, 159.5, 119.5, {-0.1, 0.02, 0.001, -0.001, 0}};
  world.ground = {{0.5, 0.5, 0.5}, Pattern::kPlain, 1.0, 0.0};
  world.sun = {std::numbers::pi, 0.8, 1.0};
  world.sky.haze_m = 1e5;
  world.camera.noise_levels = 0.0;
  return world;
}

Pose<Map, Camera> LookDown(double x, double y, double z) {
  return {CameraAttitude(std::numbers::pi / 2, -std::numbers::pi / 2), {x, y, z}};
}

TEST(Renderer, PutsThingsWhereTheDistortedPinholeCameraSeesThem) {
  World world = SmallWorld();
  world.buildings = {Box("plate", {1.0, 0.6}, {0.4, 0.3}, 0.0, 0.001)};
  const cv::Mat3b picture = Renderer(world, 1).Render({{LookDown(0, 0, 3)}, 1});
  cv::Vec3d sum(0, 0, 0);
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) {
      const double red = std::max(0, picture(v, u)[2] - picture(v, u)[1]);
      sum += red * cv::Vec3d(u, v, 1);
    }
  }
  // The camera's x is east, its y is south; OpenCV's distortion, term by term.
  const double x = 1.0 / 3.0, y = -0.6 / 3.0, r2 = x * x + y * y, radial = 1 - 0.1 * r2 + 0.02 * r2 * r2;
  const double u = 159.5 + 200 * (x * radial + 2 * 0.001 * x * y - 0.001 * (r2 + 2 * x * x));
  const double v = 119.5 + 200 * (y * radial + 0.001 * (r2 + 2 * y * y) - 2 * 0.001 * x * y);
  EXPECT_NEAR(sum[0] / sum[2], u, 0.1);
  EXPECT_NEAR(sum[1] / sum[2], v, 0.1);
}

TEST(Renderer, CastsTheShadowAwayFromTheSun) {
  World world = SmallWorld();
  world.buildings = {Box("box", {0, 0}, {1, 1}, 0.0, 1.0)};
  const cv::Mat3b picture = Renderer(world, 1).Render({{LookDown(0, 0, 8)}, 1});
  const auto at = [&](double x, double y) {
    return static_cast<int>(
        picture(static_cast<int>(119.5 - 200 * y / 8), static_cast<int>(159.5 + 200 * x / 8))[1]);
  };
  EXPECT_LT(at(0.9, 0), 0.7 * at(-0.9, 0));  // The sun stands in the west.
  EXPECT_NEAR(at(0, 2.5), at(0, -2.5), 6);
}

TEST(Renderer, LightsPassagesDimlyButNotBlack) {
  World world = SmallWorld();
  world.camera.intrinsics = {320, 240, 200, 200, 159.5, 119.5, {}};
  world.buildings = {Box("left", {-1.3, 0}, {1, 3}, 0, 1.5), Box("right", {1.3, 0}, {1, 3}, 0, 1.5),
                     Box("top", {0, 0}, {3.6, 3}, 1.5, 2.3)};
  const cv::Mat3b picture =
      Renderer(world, 1).Render({{{CameraAttitude(std::numbers::pi / 2, 0), Eigen::Vector3d(0, -4, 1)}}, 1});
  const int soffit = picture(119 - 200 * 5 / 40, 159)[2], front = picture(119 - 80, 159)[2];
  EXPECT_GT(soffit, 12);
  EXPECT_LT(soffit, front);
}

TEST(Renderer, GivesTheSamePictureOnAnyNumberOfThreads) {
  World world = SmallWorld();
  world.camera.noise_levels = 2.0;
  world.ground.pattern = Pattern::kGrass;
  world.buildings = {Box("box", {0, 0}, {1, 2}, 0.0, 1.0)};
  world.bushes = {{{2, 1}, 0.4}};
  const Exposure exposure{{LookDown(0.2, 0, 5), LookDown(0.22, 0, 5)}, 7};
  const cv::Mat3b one = Renderer(world, 1).Render(exposure), three = Renderer(world, 3).Render(exposure);
  EXPECT_EQ(cv::norm(one, three, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(one, Renderer(world, 1).Render({exposure.path, 8}), cv::NORM_INF), 0.0);  // Other noise.
}

TEST(Renderer, BlursWhatMovesDuringTheExposure) {
  World world = SmallWorld();
  world.camera.blur_px = 0.0;
  world.buildings = {Box("plate", {0, 0}, {1, 1}, 0.0, 0.001)};
  const Renderer renderer(world, 1);
  std::vector<Pose<Map, Camera>> path;
  for (int i = 0; i < 8; ++i) path.push_back(LookDown(0.02 * i, 0, 4));  // Eight pixels.
  const auto blurred_columns = [](const cv::Mat3b& picture) {
    int count = 0;
    for (int u = 100; u < 220; ++u) {
      const int red = picture(119, u)[2] - picture(119, u)[1];
      count += red > 30 && red < 90 ? 1 : 0;
    }
    return count;
  };
  EXPECT_GT(blurred_columns(renderer.Render({path, 1})),
            blurred_columns(renderer.Render({{path[0]}, 1})) + 4);
}

TEST(EncodeJpeg, CarriesTheTimeOfExposure) {
  const cv::Mat3b picture(48, 64, cv::Vec3b(10, 200, 30));
  const auto jpeg = EncodeJpeg(picture, 90, 1'700'000'000'012'345'678LL);
  EXPECT_EQ(cv::imdecode(jpeg, cv::IMREAD_COLOR).size(), picture.size());
  const std::unique_ptr<ExifData, void (*)(ExifData*)> exif(
      exif_data_new_from_data(jpeg.data(), static_cast<unsigned>(jpeg.size())), &exif_data_unref);
  const auto text = [&](ExifTag tag) {
    const ExifEntry* entry = exif_content_get_entry(exif->ifd[EXIF_IFD_EXIF], tag);
    return entry == nullptr ? std::string("none") : std::string(reinterpret_cast<const char*>(entry->data));
  };
  EXPECT_EQ(text(EXIF_TAG_DATE_TIME_ORIGINAL), "2023:11:14 22:13:20");
  EXPECT_EQ(text(EXIF_TAG_SUB_SEC_TIME_ORIGINAL), "012345678");
  EXPECT_EQ(text(EXIF_TAG_OFFSET_TIME_ORIGINAL), "+00:00");
}

}  // namespace
}  // namespace soffit::sim
