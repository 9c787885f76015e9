#include "service/query/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace soffit {
namespace {

using Triangle = std::array<Eigen::Vector3d, 3>;

Triangle TriangleOf(const Mesh& mesh, const std::array<int, 3>& corners) {
  Triangle triangle;
  for (std::size_t i = 0; i < 3; ++i)
    triangle[i] = mesh.vertices_in_map_m[static_cast<std::size_t>(corners[i])];
  return triangle;
}

Eigen::AlignedBox3d BoxOf(const Mesh& mesh) {
  Eigen::AlignedBox3d box_m;
  for (const Eigen::Vector3d& vertex_m : mesh.vertices_in_map_m) box_m.extend(vertex_m);
  return box_m;
}

Eigen::Vector3d ClosestPoint(const Triangle& t, const Eigen::Vector3d& p) {
  const Eigen::Vector3d ab = t[1] - t[0];
  const Eigen::Vector3d ac = t[2] - t[0];
  const Eigen::Vector3d ap = p - t[0];
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return t[0];
  const Eigen::Vector3d bp = p - t[1];
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return t[0] + d1 / (d1 - d3) * ab;
  const Eigen::Vector3d cp = p - t[2];
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return t[0] + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  const double scale = 1.0 / (va + vb + vc);
  return t[0] + vb * scale * ab + vc * scale * ac;
}

/// The part of the sphere about `p` that the triangle covers, signed; 4 pi in all for a point inside.
double SolidAngle(const Triangle& t, const Eigen::Vector3d& p) {
  const Eigen::Vector3d a = t[0] - p;
  const Eigen::Vector3d b = t[1] - p;
  const Eigen::Vector3d c = t[2] - p;
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  return 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

bool IsInside(const Mesh& mesh, const Eigen::Vector3d& p) {
  double angle = 0.0;
  for (const auto& corners : mesh.triangles) angle += SolidAngle(TriangleOf(mesh, corners), p);
  return angle > 2.0 * std::numbers::pi;
}

/// Where a plumb line meets the triangle.
std::optional<double> HeightAt(const Triangle& t, const Eigen::Vector2d& place_m) {
  const Eigen::Vector2d ab = (t[1] - t[0]).head<2>();
  const Eigen::Vector2d ac = (t[2] - t[0]).head<2>();
  const Eigen::Vector2d ap = place_m - t[0].head<2>();
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  if (std::abs(area) < 1e-12) return std::nullopt;  // Upright: its edges belong to other triangles too.
  const double u = (ap.x() * ac.y() - ap.y() * ac.x()) / area;
  const double v = (ab.x() * ap.y() - ab.y() * ap.x()) / area;
  if (u < 0.0 || v < 0.0 || u + v > 1.0) return std::nullopt;
  return t[0].z() + u * (t[1].z() - t[0].z()) + v * (t[2].z() - t[0].z());
}

}  // namespace

std::optional<SurfaceDistance> DistanceToModels(const Scene& scene, const Eigen::Vector3d& from_m,
                                                double range_m) {
  double best_m = range_m;
  const Solid* nearest = nullptr;
  SurfaceDistance found;
  for (const Solid& solid : scene.solids) {
    if (BoxOf(solid.mesh).exteriorDistance(from_m) > best_m) continue;
    for (const auto& corners : solid.mesh.triangles) {
      const Eigen::Vector3d point_m = ClosestPoint(TriangleOf(solid.mesh, corners), from_m);
      const double distance_m = (point_m - from_m).norm();
      if (distance_m > best_m || (nearest != nullptr && distance_m == best_m)) continue;
      best_m = distance_m;
      nearest = &solid;
      found = {distance_m, point_m, solid.footprint.object_id};
    }
  }
  if (nearest == nullptr) return std::nullopt;
  if (IsInside(nearest->mesh, from_m)) found.signed_m = -found.signed_m;
  return found;
}

std::optional<double> ModelHeightAt(const Scene& scene, const Eigen::Vector2d& place_m) {
  std::optional<double> height_m;
  for (const Solid& solid : scene.solids) {
    for (const auto& corners : solid.mesh.triangles) {
      const auto here_m = HeightAt(TriangleOf(solid.mesh, corners), place_m);
      if (here_m && !(height_m && *height_m >= *here_m)) height_m = here_m;
    }
  }
  return height_m;
}

}  // namespace soffit
