#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "shared/geometry/polygon.h"
#include "shared/options/options.h"
#include "shared/result/result.h"

namespace soffit {

/// A shape, and how well it is known: what differs by no more may be the same.
struct TracedShape {
  Polygon polygon;            ///< y-up.
  double roughness = 0.0;     ///< Standard deviation of the outline, in the polygon's unit.
  double position_std = 0.0;  ///< Of its place among the other shapes, in the polygon's unit.
};

/// The wanted building or group: shapes in a y-up frame, unit reference pixel (x right, y up = -row).
struct Reference {
  std::vector<TracedShape> shapes;  ///< At least one.
};

/// The black shapes of a black-on-white bitmap as polygons, by decreasing area, in a y-up frame (x right, y =
/// -row), unit pixel. Shapes of less than `min_area_px` are left out, and tiny holes. Pure.
std::vector<TracedShape> ReadShapes(const cv::Mat1b& bitmap, double min_area_px);

/// Reads a small black-on-white map. An error when it is all white, all black or has too many shapes.
Result<Reference> ReadReference(const cv::Mat1b& bitmap);

/// One place where the reference was found.
struct Match {
  std::vector<std::size_t> shapes;  ///< For each shape of the reference, the index of the map's shape.
  double scale = 0.0;               ///< Map units per reference pixel.
  double rotation_cw_rad =
      0.0;  ///< By this the reference is turned clockwise to lie like the building, [0, 2 pi).
  std::vector<double>
      equivalent_rotations_cw_rad;  ///< All that fit as well (symmetry), including the one above.
  Eigen::Vector2d translation = Eigen::Vector2d::Zero();  ///< map = scale * turn(reference) + translation.
  double score = 0.0;                                     ///< 0 to 1; 1 is perfect.
  bool is_ambiguous = false;                              ///< Another place fits about as well.
};

struct MatchOptions {
  double min_score = 0.80;
  double ambiguity_margin = 0.10;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("min_score", self.min_score, OptionInfo{0.0, 1.0, "", "Worse matches are none"});
    field("ambiguity_margin", self.ambiguity_margin,
          OptionInfo{0.0, 1.0, "", "A runner-up within this is a rival"});
  }
};

/// All places of the map where the reference lies, best first, for any scale and rotation; mirror images are
/// other shapes. Syntactic: each ring is a cyclic word of primitives (side length over perimeter, turning
/// angle), compared by cyclic edit distance (Bielecki & Smigielski 2021, section 2.3), then refined by least
/// squares on the outline. A group is matched as a constellation of neighbours. `map` is y-up. Pure.
std::vector<Match> FindMatches(const std::vector<TracedShape>& map, const Reference& reference,
                               const MatchOptions& options);

}  // namespace soffit
