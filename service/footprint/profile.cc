#include "service/footprint/profile.h"

#include <algorithm>
#include <limits>

namespace soffit {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {
constexpr double kNearest_m =
    0.1;  ///< A camera that is nearer, or within the building, shows no elevation of it.
}  // namespace

double Profile::Top() const {
  double top = 0.0;
  for (const Vector2d& p : outline) top = std::max(top, p.y());
  return top;
}

std::optional<Vector2d> Profile::Extent(double height_m) const {
  std::optional<Vector2d> extent;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
    if ((a.y() > height_m) == (b.y() > height_m)) continue;
    const double u = a.x() + (b.x() - a.x()) * (height_m - a.y()) / (b.y() - a.y());
    extent = extent ? Vector2d(std::min(extent->x(), u), std::max(extent->y(), u)) : Vector2d(u, u);
  }
  return extent;
}

std::optional<Profile> Elevate(const Silhouette& silhouette, const Ring& drawn) {
  const View& view = silhouette.view;
  Profile profile;
  profile.camera_m = view.map_from_camera.translation_m.head<2>();
  profile.turn_std_rad = view.orientation_std_rad;
  const Vector2d ahead = (Centroid({drawn, {}}) - profile.camera_m).normalized();
  profile.right = {ahead.y(), -ahead.x()};
  double distance_m = std::numeric_limits<double>::infinity();
  for (const Vector2d& corner : drawn)
    distance_m = std::min(distance_m, (corner - profile.camera_m).dot(ahead));
  if (!(distance_m > kNearest_m)) return std::nullopt;
  profile.middle_m = profile.camera_m + distance_m * ahead;
  for (const Vector2d& pixel : silhouette.outline.polygon_px.outer) {
    const Vector3d ray = RayDirection(view, pixel);
    const double along = ray.head<2>().dot(ahead);
    if (!(along > 0.1)) return std::nullopt;
    const Vector3d at = view.map_from_camera.translation_m + ray * (distance_m / along);
    profile.outline.emplace_back((at.head<2>() - profile.middle_m).dot(profile.right), at.z());
  }
  return profile;
}

}  // namespace soffit
