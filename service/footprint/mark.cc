#include "service/footprint/mark.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "service/footprint/cross.h"

namespace soffit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMinCos = 0.5;  // Of 60 degrees.

void AddMarks(const Cover& cover, const View& view, const Vector3d& from, const Vector3d& to,
              std::size_t edge, double step_px, std::vector<Mark>& marks) {
  constexpr double kBeside_px = 1.0;
  const auto a = Project(view, from);
  const auto b = Project(view, to);
  if (!a || !b) return;
  const Vector2d side = *b - *a;
  const double length = side.norm();
  if (length < 1.0) return;
  const Vector2d along = side / length;
  const Vector2d left(-along.y(), along.x());
  const int count = std::max(1, static_cast<int>(std::lround(length / step_px)));
  for (int k = 0; k < count; ++k) {
    const Vector2d pixel = *a + side * ((k + 0.5) / count);
    const bool is_left = cover.Contains(pixel + kBeside_px * left);
    const bool is_right = cover.Contains(pixel - kBeside_px * left);
    if (is_left != is_right) marks.push_back({pixel, is_left ? along : Vector2d(-along), edge});
  }
}

}  // namespace

bool IsWellInside(const View& view, const Vector2d& pixel) {
  constexpr double kRim_px = 4.0;
  return pixel.x() > kRim_px && pixel.y() > kRim_px && pixel.x() < view.intrinsics.width_px - 1 - kRim_px &&
         pixel.y() < view.intrinsics.height_px - 1 - kRim_px;
}

std::vector<Mark> SampleOutline(const Silhouette& silhouette, double step_px) {
  std::vector<Ring> rings = silhouette.outline.polygon_px.holes;
  rings.push_back(silhouette.outline.polygon_px.outer);
  std::vector<Mark> marks;
  for (const Ring& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
      const int count = std::max(1, static_cast<int>(std::lround(side.norm() / step_px)));
      for (int k = 0; k < count; ++k) {
        const Vector2d pixel = ring[i] + side * ((k + 0.5) / count);
        if (!silhouette.outline.is_cut || IsWellInside(silhouette.view, pixel))
          marks.push_back({pixel, side.normalized(), 0});
      }
    }
  }
  return marks;
}

std::vector<Mark> PredictOutline(const Wireframe& frame, const View& view, double step_px) {
  const Cover cover(frame, view);
  std::vector<Mark> marks;
  for (std::size_t edge = 0; edge < frame.edges.size(); ++edge) {
    const auto& [from, to] = frame.edges[edge];
    AddMarks(cover, view, frame.corners[from].in_map_m, frame.corners[to].in_map_m, edge, step_px, marks);
  }
  return marks;
}

NearestMark FindNearest(const Mark& mark, const std::vector<Mark>& others, double step_px) {
  NearestMark nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < others.size(); ++i) {
    const double squared = (others[i].pixel - mark.pixel).squaredNorm();
    if (squared < least && others[i].along.dot(mark.along) > kMinCos) {
      least = squared;
      nearest.index = i;
    }
  }
  if (!std::isfinite(least)) return nearest;
  const double across =
      std::abs(Cross(others[nearest.index].along, mark.pixel - others[nearest.index].pixel));
  nearest.distance_px = std::sqrt(std::max(across * across, least - step_px * step_px));
  return nearest;
}

}  // namespace soffit
