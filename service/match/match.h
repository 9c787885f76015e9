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

/// The black shapes of a black-on-white bitmap, by decreasing area, in a y-up frame (x right, y = -row), unit
/// pixel. Their rings follow the pixels closely: sides that were fitted would be truer, but elsewhere where a
/// notch is as small as a pixel. Shapes of less than `min_area_px` are left out, tiny holes, and all but the
/// 10,000 greatest shapes and 64 greatest holes of each. Pure.
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
  bool is_ambiguous = false;  ///< Other places fit too, or nearly: it may be one of them.
};

struct MatchOptions {
  double min_score = 0.80;
  double symmetry_margin = 0.10;
  double max_rivals = 0.3;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("min_score", self.min_score, OptionInfo{0.0, 1.0, "", "Worse matches are none"});
    field("symmetry_margin", self.symmetry_margin,
          OptionInfo{0.0, 1.0, "", "Rotations whose scores lie within this of the best are equivalent"});
    field("max_rivals", self.max_rivals,
          OptionInfo{0.0, 1.0, "",
                     "Matches are ambiguous when more places are to be expected to fit by chance"});
  }
};

/// All places of the map where the reference lies, best first, for any scale and rotation; mirror images are
/// other shapes. Syntactic: each ring is a cyclic word of primitives (side length over perimeter, turning
/// angle), compared by cyclic edit distance (Bielecki & Smigielski 2021, section 2.3), then refined by least
/// squares on the outline. A group is matched as a constellation of neighbours. `map` is y-up. Pure.
std::vector<Match> FindMatches(const std::vector<TracedShape>& map, const Reference& reference,
                               const MatchOptions& options);

}  // namespace soffit
