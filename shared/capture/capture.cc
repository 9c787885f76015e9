#include "shared/capture/capture.h"

#include <cmath>

namespace soffit {

bool IsValid(const Intrinsics& i) {
  const bool sized = i.width_px > 0 && i.height_px > 0 && i.fx_px > 0.0 && i.fy_px > 0.0;
  bool finite =
      std::isfinite(i.fx_px) && std::isfinite(i.fy_px) && std::isfinite(i.cx_px) && std::isfinite(i.cy_px);
  for (const double d : i.distortion) finite = finite && std::isfinite(d);
  return sized && finite;
}

const char* ToString(Purpose purpose) {
  switch (purpose) {
    case Purpose::kOverview:
      return "overview";
    case Purpose::kTop:
      return "top";
    case Purpose::kWall:
      return "wall";
    case Purpose::kCorridor:
      return "corridor";
    case Purpose::kUnknown:
      break;
  }
  return "unknown";
}

std::optional<Purpose> PurposeFromString(const std::string& text) {
  for (const Purpose purpose : {Purpose::kOverview, Purpose::kTop, Purpose::kWall, Purpose::kCorridor}) {
    if (text == ToString(purpose)) return purpose;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> Project(const View& view, const Eigen::Vector3d& in_map_m) {
  const Eigen::Vector3d p = (view.map_from_camera.Inverse() * Point<Map>{in_map_m}).xyz_m;
  if (!(p.z() >= 1e-3)) return std::nullopt;
  const Intrinsics& k = view.intrinsics;
  return Eigen::Vector2d(k.fx_px * p.x() / p.z() + k.cx_px, k.fy_px * p.y() / p.z() + k.cy_px);
}

Eigen::Vector2d PixelOf(const Intrinsics& k, const Eigen::Vector2d& direction) {
  const auto& [k1, k2, p1, p2, k3] = k.distortion;
  const double x = direction.x(), y = direction.y();
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {k.fx_px * (radial * x + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)) + k.cx_px,
          k.fy_px * (radial * y + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y) + k.cy_px};
}

Eigen::Vector3d RayDirection(const View& view, const Eigen::Vector2d& pixel) {
  const Intrinsics& k = view.intrinsics;
  const Eigen::Vector3d in_camera((pixel.x() - k.cx_px) / k.fx_px, (pixel.y() - k.cy_px) / k.fy_px, 1.0);
  return (view.map_from_camera.rotation * in_camera).normalized();
}

std::optional<Eigen::Vector2d> MeetHorizontalPlane(const View& view, const Eigen::Vector2d& pixel,
                                                   double height_m) {
  const Eigen::Vector3d direction = RayDirection(view, pixel);
  const Eigen::Vector3d& origin = view.map_from_camera.translation_m;
  const double t = (height_m - origin.z()) / direction.z();
  if (!(t > 0.0) || !std::isfinite(t)) return std::nullopt;
  return (origin + t * direction).head<2>();
}

}  // namespace soffit
