#pragma once

#include <vector>

#include "service/edge/drawing/canvas.h"
#include "service/edge/drawing/ray_scene.h"

namespace soffit {

/// Draws lines in space as a camera sees them among solids.
class SpacePen {
 public:
  /// @param solids  Committed; lives longer, as does `view`.
  /// @param step_m  How finely lines are tried. What lies no deeper than a third of it is seen.
  SpacePen(const View& view, const RayScene& solids, double step_m)
      : view_(view), solids_(solids), step_m_(step_m) {}

  /// As `stroke` where it is seen; where a solid hides it, dashed and thin or not at all.
  void Draw(Canvas& canvas, const std::vector<Eigen::Vector3d>& line, const Stroke& stroke,
            bool shows_hidden) const;
  bool IsVisible(const Eigen::Vector3d& point) const;

 private:
  std::optional<Eigen::Vector2d> ToPixel(const Eigen::Vector3d& point) const;

  const View& view_;
  const RayScene& solids_;
  double step_m_;
};

}  // namespace soffit
