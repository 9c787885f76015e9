#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "service/footprint/footprint.h"
#include "service/footprint/wireframe.h"

namespace soffit {

/// A point of an outline in a picture. The building is on the left when x is to the right and y is up.
struct Mark {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Vector2d along = Eigen::Vector2d::Zero();  ///< Unit.
  std::size_t edge = 0;  ///< Predicted outlines: which edge of the wireframe it is on.
};

/// Whether a pixel is not so near to the end of the picture that an outline there may be no more than that.
bool IsWellInside(const View& view, const Eigen::Vector2d& pixel);

/// Marks on a traced outline, about `step_px` apart; none where it is cut by the end of the picture.
std::vector<Mark> SampleOutline(const Silhouette& silhouette, double step_px);

/// Marks on the outline of a building in a picture: on those of its edges that have it on one side only.
std::vector<Mark> PredictOutline(const Wireframe& frame, const View& view, double step_px);

struct NearestMark {
  std::size_t index = 0;
  double distance_px = std::numeric_limits<double>::infinity();  ///< Across the direction of the mark.
};

/// The one of `others`, which are `step_px` apart, that is nearest to a mark and runs the same way, within 60
/// degrees. Infinitely far when none does.
NearestMark FindNearest(const Mark& mark, const std::vector<Mark>& others, double step_px);

}  // namespace soffit
