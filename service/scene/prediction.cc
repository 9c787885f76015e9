#include "service/scene/prediction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace soffit {
namespace {

constexpr double kNear_m = 0.05;

using Corners = std::vector<Eigen::Vector3d>;

/// The part of a polygon (camera coordinates) that lies before the near plane.
Corners ClipNear(const Corners& polygon) {
  Corners kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d& a = polygon[i];
    const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
    if (a.z() >= kNear_m) kept.push_back(a);
    if ((a.z() >= kNear_m) != (b.z() >= kNear_m))
      kept.push_back(a + (kNear_m - a.z()) / (b.z() - a.z()) * (b - a));
  }
  return kept;
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Fills the triangle's pixels where it is nearer; 1 / depth is linear in the picture.
void Draw(const std::array<Eigen::Vector3d, 3>& corners, const Intrinsics& k, Prediction& picture) {
  std::array<Eigen::Vector2d, 3> p;
  std::array<double, 3> inverse{};
  for (std::size_t i = 0; i < 3; ++i) {
    inverse[i] = 1.0 / corners[i].z();
    p[i] = {k.fx_px * corners[i].x() * inverse[i] + k.cx_px, k.fy_px * corners[i].y() * inverse[i] + k.cy_px};
  }
  const double area = Cross(p[1] - p[0], p[2] - p[0]);
  if (std::abs(area) < 1e-12) return;
  const auto [left, right] = std::minmax({p[0].x(), p[1].x(), p[2].x()});
  const auto [upper, lower] = std::minmax({p[0].y(), p[1].y(), p[2].y()});
  const int x0 = static_cast<int>(std::clamp(std::ceil(left), 0.0, static_cast<double>(picture.label.cols)));
  const int x1 = static_cast<int>(std::clamp(std::floor(right), -1.0, picture.label.cols - 1.0));
  const int y0 = static_cast<int>(std::clamp(std::ceil(upper), 0.0, static_cast<double>(picture.label.rows)));
  const int y1 = static_cast<int>(std::clamp(std::floor(lower), -1.0, picture.label.rows - 1.0));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2d q(x, y);
      const double w0 = Cross(p[1] - q, p[2] - q) / area;
      const double w1 = Cross(p[2] - q, p[0] - q) / area;
      const double w2 = 1.0 - w0 - w1;
      if (w0 < 0.0 || w1 < 0.0 || w2 < 0.0) continue;
      const float depth = static_cast<float>(1.0 / (w0 * inverse[0] + w1 * inverse[1] + w2 * inverse[2]));
      if (depth >= picture.depth_m(y, x)) continue;
      picture.depth_m(y, x) = depth;
      picture.label(y, x) = static_cast<uchar>(Seen::kStructure);
    }
  }
}

void DrawGround(const View& view, Prediction& picture) {
  const Eigen::Matrix3d rotation = view.map_from_camera.rotation.toRotationMatrix();
  const double camera_height = view.map_from_camera.translation_m.z();
  const Intrinsics& k = view.intrinsics;
  for (int y = 0; y < picture.label.rows; ++y) {
    for (int x = 0; x < picture.label.cols; ++x) {
      const Eigen::Vector3d ray((x - k.cx_px) / k.fx_px, (y - k.cy_px) / k.fy_px, 1.0);
      const double rise = rotation.row(2).dot(ray);
      const bool is_ground = rise < 0.0 && camera_height > 0.0;
      picture.label(y, x) = static_cast<uchar>(is_ground ? Seen::kGround : Seen::kSky);
      picture.depth_m(y, x) =
          is_ground ? static_cast<float>(-camera_height / rise) : std::numeric_limits<float>::infinity();
    }
  }
}

}  // namespace

Prediction Predict(const View& view, const std::vector<const Mesh*>& meshes) {
  const Intrinsics& k = view.intrinsics;
  Prediction picture{cv::Mat1b(k.height_px, k.width_px), cv::Mat1f(k.height_px, k.width_px)};
  DrawGround(view, picture);
  const Pose<Camera, Map> camera_from_map = view.map_from_camera.Inverse();
  for (const Mesh* mesh : meshes) {
    Corners in_camera;
    for (const Eigen::Vector3d& p : mesh->vertices_in_map_m) {
      in_camera.push_back((camera_from_map * Point<Map>{p}).xyz_m);
    }
    for (const std::array<int, 3>& t : mesh->triangles) {
      const Corners clipped =
          ClipNear({in_camera[static_cast<std::size_t>(t[0])], in_camera[static_cast<std::size_t>(t[1])],
                    in_camera[static_cast<std::size_t>(t[2])]});
      for (std::size_t i = 2; i < clipped.size(); ++i)
        Draw({clipped[0], clipped[i - 1], clipped[i]}, k, picture);
    }
  }
  return picture;
}

Mesh RaiseBlock(const Ring& outer, double height_m) {
  Mesh mesh;
  const int n = static_cast<int>(outer.size());
  for (const double z : {0.0, height_m}) {
    for (const Eigen::Vector2d& p : outer) mesh.vertices_in_map_m.emplace_back(p.x(), p.y(), z);
  }
  for (int i = 0; i < n; ++i) {  // Walls only: no horizontal camera sees the roof before them.
    const int j = (i + 1) % n;
    mesh.triangles.push_back({i, j, j + n});
    mesh.triangles.push_back({i, j + n, i + n});
  }
  return mesh;
}

}  // namespace soffit
