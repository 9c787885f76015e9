#include "service/edge/drawing/space_pen.h"

#include <algorithm>

namespace soffit {
namespace {

constexpr double kNear_m = 0.05;

}  // namespace

bool SpacePen::IsVisible(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d& eye = view_.map_from_camera.translation_m;
  const double distance_m = (point - eye).norm();
  return !solids_.IsBlocked(eye, (point - eye) / distance_m, distance_m - 0.3 * step_m_);
}

std::optional<Eigen::Vector2d> SpacePen::ToPixel(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d forward = view_.map_from_camera.rotation * Eigen::Vector3d::UnitZ();
  if (!(forward.dot(point - view_.map_from_camera.translation_m) > kNear_m)) return std::nullopt;
  return Project(view_, point);
}

void SpacePen::Draw(Canvas& canvas, const std::vector<Eigen::Vector3d>& line, const Stroke& stroke,
                    bool shows_hidden) const {
  PixelLine run;
  bool run_is_visible = true;
  const auto finish = [&] {
    if (run_is_visible) {
      canvas.DrawLine(run, stroke);
    } else if (shows_hidden) {
      canvas.DrawLine(run, {stroke.color, 0.7 * stroke.width_px, true, false});
    }
    run.clear();
  };
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const int steps = std::max(1, static_cast<int>((line[i + 1] - line[i]).norm() / step_m_));
    for (int k = 0; k <= steps; ++k) {
      const Eigen::Vector3d point = line[i] + (line[i + 1] - line[i]) * k / steps;
      const auto pixel = ToPixel(point);
      const bool is_visible = IsVisible(point);
      if (!pixel || is_visible != run_is_visible) {
        if (pixel) run.push_back(*pixel);
        finish();
        run_is_visible = is_visible;
      }
      if (pixel) run.push_back(*pixel);
    }
  }
  finish();
}

}  // namespace soffit
