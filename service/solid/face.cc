#include "service/solid/face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace soffit {
namespace {

constexpr double kLevelNormal = 0.5;  // What is steeper than 60 degrees is a wall.
constexpr double kStraight = 1e-6;    // Sine of a turn.

using Edge = std::pair<int, int>;

double ExtentOf(const Ring3& ring) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : ring) box.extend(p);
  return box.diagonal().norm();
}

FaceKind KindOf(const Origin& origin, const Eigen::Vector3d& normal, bool is_inside) {
  if (is_inside && origin.side < 0) return FaceKind::kBack;
  if (normal.z() > kLevelNormal) return is_inside ? FaceKind::kFloor : FaceKind::kRoof;
  if (normal.z() < -kLevelNormal) return is_inside ? FaceKind::kCeiling : FaceKind::kGround;
  return FaceKind::kWall;
}

/// Without the vertices at which it goes straight on.
Ring3 CornersOf(const Ring3& ring) {
  Ring3 corners;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector3d back = (ring[i] - ring[(i + ring.size() - 1) % ring.size()]).normalized();
    const Eigen::Vector3d ahead = (ring[(i + 1) % ring.size()] - ring[i]).normalized();
    if (back.cross(ahead).norm() > kStraight) corners.push_back(ring[i]);
  }
  return corners;
}

std::map<Edge, std::size_t> TrianglesByEdge(const Mesh& mesh) {
  std::map<Edge, std::size_t> triangles;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& [a, b, c] = mesh.triangles[i];
    for (const Edge& edge : {Edge(a, b), Edge(b, c), Edge(c, a)}) triangles[edge] = i;
  }
  return triangles;
}

}  // namespace

std::vector<Face> GatherFaces(const Difference& mesh, const std::vector<Inside>& cuts) {
  const std::map<Edge, std::size_t> by_edge = TrianglesByEdge(mesh);
  std::vector<bool> is_taken(mesh.triangles.size(), false);
  std::vector<Face> faces;
  for (std::size_t first = 0; first < mesh.triangles.size(); ++first) {
    if (is_taken[first]) continue;
    const Origin& origin = mesh.origins[first];
    const Inside inside = origin.tube == 0 ? Inside{origin.side, -1} : cuts[origin.tube - 1];
    Face face{
        KindOf(origin, NormalOf(mesh, first), inside.opening >= 0), inside.wall, inside.opening, {first}, {}};
    is_taken[first] = true;
    for (std::size_t i = 0; i < face.triangles.size(); ++i) {
      const auto& [a, b, c] = mesh.triangles[face.triangles[i]];
      for (const Edge& back : {Edge(b, a), Edge(c, b), Edge(a, c)}) {
        const auto next = by_edge.find(back);
        if (next == by_edge.end() || is_taken[next->second] || mesh.origins[next->second] != origin) continue;
        is_taken[next->second] = true;
        face.triangles.push_back(next->second);
      }
    }
    faces.push_back(std::move(face));
  }
  return faces;
}

Eigen::Vector3d NormalOf(const Mesh& mesh, std::size_t triangle) {
  const auto corner = [&](std::size_t i) -> const Eigen::Vector3d& {
    return mesh.vertices_in_map_m[static_cast<std::size_t>(mesh.triangles[triangle][i])];
  };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
}

std::vector<Ring3> OutlineOf(const Mesh& mesh, const Face& face) {
  std::set<Edge> edges;
  for (const std::size_t triangle : face.triangles) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    edges.insert({{a, b}, {b, c}, {c, a}});
  }
  std::multimap<int, int> rim;  // What only one triangle of the face has.
  for (const Edge& edge : edges) {
    if (edges.count({edge.second, edge.first}) == 0) rim.insert(edge);
  }
  std::vector<Ring3> rings;
  while (!rim.empty()) {
    rings.emplace_back();
    for (auto at = rim.begin(); at != rim.end();) {
      rings.back().push_back(mesh.vertices_in_map_m[static_cast<std::size_t>(at->first)]);
      const int next = at->second;
      rim.erase(at);
      at = rim.find(next);
    }
    rings.back() = CornersOf(rings.back());
  }
  const auto outer = std::ranges::max_element(rings, {}, ExtentOf);
  if (outer != rings.end()) std::iter_swap(rings.begin(), outer);
  return rings;
}

}  // namespace soffit
