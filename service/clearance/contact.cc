#include "service/clearance/contact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/intersection.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>

namespace soffit {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;

constexpr int kArcSegments = 24;

Kernel::Point_3 ToPoint(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

Surface ToSurface(const Mesh& mesh) {
  Surface surface;
  std::vector<Surface::Vertex_index> vertices;
  for (const Eigen::Vector3d& p : mesh.vertices_in_map_m) vertices.push_back(surface.add_vertex(ToPoint(p)));
  for (const std::array<int, 3>& t : mesh.triangles) {
    surface.add_face(vertices[static_cast<std::size_t>(t[0])], vertices[static_cast<std::size_t>(t[1])],
                     vertices[static_cast<std::size_t>(t[2])]);
  }
  return surface;
}

Surface ToSurface(const Prism& prism) {
  Surface surface;
  std::vector<Surface::Vertex_index> near, far;
  for (const Eigen::Vector2d& at : prism.ring) {
    const Eigen::Vector3d corner = prism.origin_m + at.x() * prism.x_axis + at.y() * prism.y_axis;
    near.push_back(surface.add_vertex(ToPoint(corner)));
    far.push_back(surface.add_vertex(ToPoint(corner + prism.sweep_m)));
  }
  for (std::size_t i = 0; i < near.size(); ++i) {
    const std::size_t j = (i + 1) % near.size();
    surface.add_face(near[i], near[j], far[j], far[i]);
  }
  surface.add_face(far);
  surface.add_face(std::vector<Surface::Vertex_index>(near.rbegin(), near.rend()));
  pmp::triangulate_faces(surface);
  return surface;
}

}  // namespace

bool Meets(const Mesh& solid, const Prism& prism) {
  const Surface a = ToSurface(solid);
  const Surface b = ToSurface(prism);
  if (a.is_empty() || b.is_empty() || !CGAL::is_closed(a) || !CGAL::is_closed(b)) return true;
  return pmp::do_intersect(a, b, CGAL::parameters::do_overlap_test_of_bounded_sides(true),
                           CGAL::parameters::do_overlap_test_of_bounded_sides(true));
}

Prism SweepCylinder(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius_m, double bottom_m,
                    double top_m) {
  const double heading = std::atan2(to.y() - from.y(), to.x() - from.x());
  const double circumscribed = radius_m / std::cos(0.5 * M_PI / kArcSegments);
  Prism sweep;
  const auto add_arc = [&](const Eigen::Vector2d& center, double start) {
    for (int i = 0; i < kArcSegments; ++i) {  // Sides parallel to the path lie at exactly the radius.
      const double angle = start + M_PI * (i + 0.5) / kArcSegments;
      sweep.ring.push_back(center + circumscribed * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  };
  add_arc(to, heading - M_PI_2);
  add_arc(from, heading + M_PI_2);
  sweep.origin_m = {0.0, 0.0, bottom_m};
  sweep.sweep_m = {0.0, 0.0, top_m - bottom_m};
  return sweep;
}

}  // namespace soffit
