#include "service/solid/boolean.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/triangulate_faces.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <map>

namespace soffit {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;

using FaceIndex = Surface::Face_index;
using Origins = Surface::Property_map<FaceIndex, Origin>;

Origins OriginsOf(Surface& surface) { return surface.add_property_map<FaceIndex, Origin>("origin").first; }

/// Parts of a triangle are where it was.
struct KeepOrigins : pmp::Corefinement::Default_visitor<Surface> {
  Origin split;
  void before_subface_creations(FaceIndex whole, Surface& surface) { split = OriginsOf(surface)[whole]; }
  void after_subface_created(FaceIndex part, Surface& surface) { OriginsOf(surface)[part] = split; }
  void after_face_copy(FaceIndex from, Surface& surface, FaceIndex to, Surface& copy) {
    OriginsOf(copy)[to] = OriginsOf(surface)[from];
  }
};

Kernel::Point_3 ToPoint(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

/// Numbers that are not finite end the process in the exact kernel.
bool IsFinite(const Tube& tube) {
  return std::all_of(tube.rings_m.begin(), tube.rings_m.end(), [](const std::vector<Eigen::Vector3d>& ring) {
    return std::all_of(ring.begin(), ring.end(), [](const Eigen::Vector3d& p) { return p.allFinite(); });
  });
}

/// Closed triangle mesh with outward normals; empty when the tube is degenerate or not finite.
Surface Raise(const Tube& tube, std::size_t number) {
  Surface surface;
  const std::size_t corners = tube.rings_m.empty() ? 0 : tube.rings_m.front().size();
  if (corners < 3 || tube.rings_m.size() < 2 || !IsFinite(tube)) return surface;
  Origins origins = OriginsOf(surface);
  std::vector<std::vector<Surface::Vertex_index>> rings;
  for (const std::vector<Eigen::Vector3d>& ring : tube.rings_m) {
    if (ring.size() != corners) return {};
    rings.emplace_back();
    for (const Eigen::Vector3d& corner : ring) rings.back().push_back(surface.add_vertex(ToPoint(corner)));
  }
  for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
    const auto& near = rings[k];
    const auto& far = rings[k + 1];
    for (std::size_t i = 0; i < corners; ++i) {
      const std::size_t j = (i + 1) % corners;
      const Origin origin{number, k, static_cast<int>(i)};
      origins[surface.add_face(near[j], near[i], far[i])] = origin;
      origins[surface.add_face(near[j], far[i], far[j])] = origin;
    }
  }
  std::reverse(rings.back().begin(), rings.back().end());
  for (const std::size_t end : {std::size_t{0}, rings.size() - 1}) {
    const auto before = static_cast<Surface::size_type>(surface.number_of_faces());
    pmp::triangulate_face(surface.add_face(rings[end]), surface);
    for (auto i = before; i < surface.number_of_faces(); ++i) origins[FaceIndex(i)] = {number, end, -1};
  }
  return surface;
}

bool IsSolid(const Surface& surface) {
  return !surface.is_empty() && CGAL::is_triangle_mesh(surface) && CGAL::is_closed(surface) &&
         pmp::is_outward_oriented(surface);
}

/// Vertices and triangles in the order of their coordinates: corefinement's own order follows where
/// its nodes lie in memory, and differs between two runs on the same solids.
Difference ToMesh(Surface& surface) {
  std::vector<std::pair<std::array<double, 3>, Surface::Vertex_index>> ordered;
  for (const auto vertex : surface.vertices()) {
    const auto& p = surface.point(vertex);
    ordered.push_back({{CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())}, vertex});
  }
  std::ranges::sort(ordered, {}, [](const auto& entry) { return entry.first; });

  Difference mesh;
  std::map<Surface::Vertex_index, int> index;
  for (const auto& [at, vertex] : ordered) {
    index[vertex] = static_cast<int>(mesh.vertices_in_map_m.size());
    mesh.vertices_in_map_m.emplace_back(at[0], at[1], at[2]);
  }
  std::vector<std::pair<std::array<int, 3>, Origin>> triangles;
  for (const auto face : surface.faces()) {
    std::array<int, 3> triangle{};
    std::size_t corner = 0;
    for (const auto vertex : surface.vertices_around_face(surface.halfedge(face)))
      triangle[corner++] = index[vertex];
    std::ranges::rotate(triangle, std::ranges::min_element(triangle));
    triangles.emplace_back(triangle, OriginsOf(surface)[face]);
  }
  std::ranges::sort(triangles);
  for (const auto& [triangle, origin] : triangles) {
    mesh.triangles.push_back(triangle);
    mesh.origins.push_back(origin);
  }
  return mesh;
}

}  // namespace

Tube::Tube(const Prism& prism) {
  if (!IsSimple(prism.ring)) return;
  rings_m.resize(2);
  for (const Eigen::Vector2d& at : prism.ring) {
    const Eigen::Vector3d corner = prism.origin_m + at.x() * prism.x_axis + at.y() * prism.y_axis;
    rings_m[0].push_back(corner);
    rings_m[1].push_back(corner + prism.sweep_m);
  }
  if (prism.x_axis.cross(prism.y_axis).dot(prism.sweep_m) > 0.0) std::reverse(rings_m.begin(), rings_m.end());
}

bool IsSound(const Tube& tube) {
  const Surface surface = Raise(tube, 0);
  return IsSolid(surface) && !pmp::does_self_intersect(surface);
}

Result<Difference> Subtract(const Tube& body, const std::vector<Tube>& cuts) {
  Surface rest = Raise(body, 0);
  if (!IsSolid(rest))
    return InvalidInput("the footprint is not a simple counter-clockwise polygon with a height");
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    Surface tool = Raise(cuts[i], i + 1);
    if (!IsSolid(tool)) return InvalidInput("an opening is not a simple counter-clockwise polygon");
    Surface difference;
    if (!pmp::corefine_and_compute_difference(rest, tool, difference,
                                              CGAL::parameters::visitor(KeepOrigins{}))) {
      return Error{Error::Code::kInternal, "cutting an opening leaves no 2-manifold"};
    }
    difference.collect_garbage();
    if (!IsSolid(difference))
      return Error{Error::Code::kInternal, "cutting an opening leaves no closed solid"};
    rest = std::move(difference);
  }
  return ToMesh(rest);
}

}  // namespace soffit
