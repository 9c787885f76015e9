#pragma once

#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "service/footprint/footprint.h"
#include "service/image/image.h"
#include "service/mask/mask.h"
#include "service/outline/outline.h"

namespace soffit::test {

/// A building with plumb walls and a level roof.
struct Block {
  Ring ring_in_map_m;  ///< Counter-clockwise.
  double height_m = 0.0;
  double floor_m = 0.0;  ///< Of a block that hangs in the air.
};

inline Ring Turned(Ring ring, double angle_rad, const Eigen::Vector2d& to = Eigen::Vector2d::Zero()) {
  for (Eigen::Vector2d& p : ring) p = Eigen::Rotation2Dd(angle_rad) * p + to;
  return ring;
}

inline Ring Box(double width, double depth) {
  return {{-width / 2, -depth / 2}, {width / 2, -depth / 2}, {width / 2, depth / 2}, {-width / 2, depth / 2}};
}

inline Ring LShape() { return {{0, 0}, {4, 0}, {4, 1.5}, {1.5, 1.5}, {1.5, 3}, {0, 3}}; }

/// A camera of 1280 x 960 pixels that looks straight down, tilted by `tilt_rad`.
inline View LookDown(const Eigen::Vector3d& from_m, double yaw_rad = 0.3, double tilt_rad = 0.0) {
  View view;
  view.intrinsics = {1280, 960, 850.0, 850.0, 635.2, 483.1, {}};
  view.map_from_camera.rotation = CameraAttitude(yaw_rad, tilt_rad - std::numbers::pi / 2);
  view.map_from_camera.translation_m = from_m;
  return view;
}

inline void FillFace(cv::Mat1b& label, const View& view, const std::vector<Eigen::Vector3d>& face_in_map_m) {
  constexpr int kShift = 8;
  std::vector<cv::Point> pixels;
  for (const Eigen::Vector3d& corner : face_in_map_m) {
    const Eigen::Vector2d p = *Project(view, corner) * (1 << kShift);
    pixels.emplace_back(static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y())));
  }
  cv::fillPoly(label, std::vector<std::vector<cv::Point>>{pixels}, cv::Scalar(1), cv::LINE_8, kShift);
}

/// Roofs and walls of the blocks, all red, as a mask without any noise.
inline Mask Photograph(const View& view, const std::vector<Block>& blocks) {
  Mask mask;
  mask.classes = {"red"};
  mask.confidence = 1.0;
  mask.label = cv::Mat1b(view.intrinsics.height_px, view.intrinsics.width_px, uchar{0});
  for (const Block& block : blocks) {
    std::vector<Eigen::Vector3d> roof;
    const std::size_t n = block.ring_in_map_m.size();
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector2d& a = block.ring_in_map_m[i];
      const Eigen::Vector2d& b = block.ring_in_map_m[(i + 1) % n];
      roof.emplace_back(a.x(), a.y(), block.height_m);
      FillFace(mask.label, view,
               {{a.x(), a.y(), block.floor_m},
                {b.x(), b.y(), block.floor_m},
                {b.x(), b.y(), block.height_m},
                {a.x(), a.y(), block.height_m}});
    }
    FillFace(mask.label, view, roof);
  }
  return mask;
}

/// What is made of a picture of the blocks; `reported`: where the camera is believed to be, if not there.
inline std::vector<Footprint> TraceBlocks(const View& view, std::uint32_t capture_id,
                                          const std::vector<Block>& blocks,
                                          const std::optional<View>& reported = std::nullopt) {
  const Mask mask = Photograph(view, blocks);
  Image image;
  image.capture_id = capture_id;
  image.view = reported.value_or(view);
  image.seen = cv::Rect({0, 0}, mask.label.size());
  return TraceFootprints(image, TraceOutlines(mask, image.seen, {}), {});
}

/// Area in one but not in both, over the area of the first, on a grid.
inline double RelativeDifference(const Ring& a, const Ring& b) {
  Eigen::Vector2d low = a.front();
  Eigen::Vector2d high = low;
  for (const Ring* ring : {&a, &b}) {
    for (const Eigen::Vector2d& p : *ring) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  constexpr int kCells = 200;
  int in_a = 0;
  int in_one = 0;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const Eigen::Vector2d p =
          low + (high - low).cwiseProduct(Eigen::Vector2d((i + 0.5) / kCells, (j + 0.5) / kCells));
      const bool is_in_a = Contains(a, p);
      in_a += is_in_a ? 1 : 0;
      in_one += is_in_a != Contains(b, p) ? 1 : 0;
    }
  }
  return static_cast<double>(in_one) / in_a;
}

}  // namespace soffit::test
