#pragma once

#include <vector>

#include "service/facade/align.h"
#include "service/scene/prediction.h"
#include "service/scene/scene.h"
#include "service/solid/boolean.h"
#include "service/solid/solid.h"

namespace soffit::test {

/// A small world of plain colours: a grey ground, a bright sky and things of one colour each.
struct Thing {
  Mesh mesh;
  cv::Vec3b bgr;
};

inline const cv::Vec3b kBlueWall(150, 50, 30);
inline const cv::Vec3b kGreyGround(120, 122, 124);
inline const cv::Vec3b kBrightSky(235, 225, 215);

inline Ring Box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

inline Prism Upright(const Ring& ring, double bottom_m, double top_m) {
  Prism prism;
  prism.ring = ring;
  prism.origin_m.z() = bottom_m;
  prism.sweep_m = {0.0, 0.0, top_m - bottom_m};
  return prism;
}

inline Thing Block(const Ring& ring, double bottom_m, double top_m, const cv::Vec3b& bgr) {
  return {Subtract(Upright(ring, bottom_m, top_m), {}).value(), bgr};
}

/// Level camera at `position`, looking along `yaw_rad`.
inline View LevelView(const Eigen::Vector3d& position_m, double yaw_rad) {
  View view;
  view.intrinsics = {640, 480, 440.0, 440.0, 319.5, 239.5, {}};
  view.map_from_camera = {CameraAttitude(yaw_rad, 0.0), position_m};
  return view;
}

inline cv::Mat3b Paint(const View& view, const std::vector<Thing>& things) {
  const Prediction empty = Predict(view, {});
  cv::Mat3b picture(empty.label.size());
  cv::Mat1f depth = empty.depth_m.clone();
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      picture(y, x) = empty.label(y, x) == static_cast<uchar>(Seen::kGround) ? kGreyGround : kBrightSky;
    }
  }
  for (const Thing& thing : things) {
    const Prediction alone = Predict(view, {&thing.mesh});
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) {
        if (alone.label(y, x) != static_cast<uchar>(Seen::kStructure) || alone.depth_m(y, x) >= depth(y, x))
          continue;
        depth(y, x) = alone.depth_m(y, x);
        picture(y, x) = thing.bgr;
      }
    }
  }
  return picture;
}

struct Seeing {
  std::vector<Image> images;
  std::vector<Mask> masks;
  std::vector<Sight> sights;
};

/// Horizontal pictures of the world, labelled; `reported` differ from the true `views` when poses are noisy.
inline Seeing Look(const std::vector<View>& views, const std::vector<Thing>& things,
                   const std::vector<View>& reported = {}) {
  Seeing seeing;
  for (std::size_t i = 0; i < views.size(); ++i) {
    Image image;
    image.capture_id = static_cast<std::uint32_t>(i + 1);
    image.purpose = Purpose::kWall;
    image.has_trusted_pose = true;
    image.bgr = Paint(views[i], things);
    image.seen = cv::Rect(0, 0, image.bgr.cols, image.bgr.rows);
    image.view = reported.empty() ? views[i] : reported[i];
    seeing.masks.push_back(SegmentBuildings(image, {}));
    seeing.sights.push_back(LabelSight(image, seeing.masks.back(), {}));
    seeing.images.push_back(std::move(image));
  }
  return seeing;
}

/// A block 4 m x 1.5 m and 2.3 m high about the origin, its long sides (0 and 2) to the south and north.
struct Arch {
  double width_m = 1.6;
  double height_m = 1.5;
  double depth_m = 1.5;  ///< Less than 1.5: a recess in the south wall.
  double sill_m = 0.0;   ///< More: a window.

  Footprint footprint() const {
    Footprint object;
    object.object_id = 1;
    object.color = "blue";
    object.polygon_in_map_m.outer = Box(-2.0, -0.75, 2.0, 0.75);
    object.corner_std_m.assign(4, 0.002);
    object.height_m = 2.3;
    object.height_std_m = 0.01;
    return object;
  }
  Thing thing() const {
    const double end = depth_m < 1.5 ? -0.75 + depth_m : 1.0;
    const Ring opening = Box(-0.5 * width_m, -1.0, 0.5 * width_m, end);
    return {Subtract(Upright(footprint().polygon_in_map_m.outer, 0.0, 2.3),
                     {Upright(opening, sill_m > 0.0 ? sill_m : -0.1, height_m)})
                .value(),
            kBlueWall};
  }
};

inline View FromSouth() { return LevelView({0.15, -5.0, 1.1}, M_PI_2); }
inline View FromNorth() { return LevelView({-0.1, 5.0, 1.1}, -M_PI_2); }
inline View FromEast() { return LevelView({6.5, 0.1, 1.1}, M_PI); }
inline View FromWest() { return LevelView({-6.5, 0.0, 1.1}, 0.0); }

}  // namespace soffit::test
