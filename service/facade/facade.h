#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "service/footprint/footprint.h"
#include "service/image/image.h"
#include "service/mask/mask.h"
#include "shared/geometry/polygon.h"
#include "shared/options/options.h"

namespace soffit {

/// What a pixel of a picture shows. Zero is the safe one: it proves nothing.
enum class Seen : std::uint8_t { kUnexplained, kStructure, kGround, kSky };

/// One picture, understood pixel by pixel: `seen` holds `Seen` values, size of the picture.
struct Sight {
  std::uint32_t capture_id = 0;
  bool has_trusted_pose = false;
  View view;
  Intrinsics taken;  ///< Of the picture before it was undistorted and shrunk.
  cv::Mat3b bgr;     ///< The picture itself, shared with the Image.
  cv::Mat1b seen;
  cv::Rect shown;  ///< What lies outside shows nothing: the margin of an undistorted picture.
};

/// A prism behind a wall.
struct Recess {
  Ring ring_in_wall_m;  ///< As that of an opening.
  double depth_m = 0.0;
  double std_m = 0.0;  ///< Of the depth.
};

/// An opening of one wall. Wall coordinates: u along the footprint's side from its first corner, v up from
/// the ground.
struct Opening {
  Ring ring_in_wall_m;               ///< Counter-clockwise seen from outside, simple.
  double std_m = 0.0;                ///< Of its sides.
  std::optional<double> left_drift;  ///< Of u along its left jamb, for each metre into the building: 0 leads
                                     ///< straight in. None: the picture does not show the jamb's foot.
  std::optional<double> right_drift;
  bool is_through = false;  ///< Proved by evidence: background seen through it.
  bool shows_background =
      false;  ///< Some background is seen through it; when it is not `is_through`: too little to tell.
  std::optional<Recess> recess;  ///< What it is if it does not go through, where that could be told.
  std::string evidence;          ///< For people: what it was decided from.
  std::vector<std::uint32_t> captures;
};

/// One wall of a building as a vertical rectangle, with its openings.
struct Facade {
  std::uint32_t object_id = 0;
  int side = -1;  ///< The wall stands on side `side` of the footprint's outer ring (corner side to side + 1).
  double width_m = 0.0;
  double height_m = 0.0;
  double height_std_m = 0.0;
  bool was_seen = false;  ///< False: no picture shows enough of it; then `openings` means nothing.
  std::vector<Opening> openings;
  std::uint32_t capture_id = 0;  ///< The picture that it was read from, when it was seen.
};

struct FacadeOptions {
  double resolution_m = 0.005;
  double min_opening_m = 0.15;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("resolution_m", self.resolution_m, OptionInfo{0.001, 1.0, "m", "Finest raster of an elevation"});
    field("min_opening_m", self.min_opening_m,
          OptionInfo{0.01, 10.0, "m", "Smaller openings are not looked for"});
  }
};

/// Labels every pixel of a picture, horizontal or from above. `buildings` is its colour mask.
///
/// Structure has a hue of the mask's classes, also in deep shade. Sky is what is coloured like the upper part
/// of the picture and what fades from there to the horizon. Ground has the chromaticity of the lower part of
/// the picture, lit or in shadow, or fades from there into the haze at the horizon; it lies below the horizon
/// and sky above it. All else is unexplained. Pure; O(pixels).
///
/// A grey thing on grey ground that stays below the horizon is taken for a shadow: colour alone cannot tell.
Sight LabelSight(const Image& image, const Mask& buildings, const FacadeOptions& options);

/// The walls of one object as the horizontal pictures show them, one Facade for each side of its outer ring.
std::vector<Facade> ReadFacades(const Footprint& object, const std::vector<Image>& images,
                                const std::vector<Mask>& masks, const std::vector<Sight>& sights,
                                const FacadeOptions& options);

}  // namespace soffit
