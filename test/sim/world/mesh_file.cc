#include "test/sim/world/mesh_file.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>

#include "test/sim/world/city_gml.h"
#include "test/sim/world/clip.h"
#include "test/sim/world/geos.h"
#include "test/sim/world/obj.h"
#include "test/sim/world/prism.h"

namespace soffit::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Face = std::vector<Vector3d>;

bool HasName(const CitySurface& surface, const std::string& name) {
  return surface.kind == name || std::count(surface.ids.begin(), surface.ids.end(), name) > 0;
}

bool HasNameOf(const CitySurface& surface, const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& name) { return HasName(surface, name); });
}

Status CheckNames(const std::vector<CitySurface>& surfaces, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    const bool is_known = std::any_of(surfaces.begin(), surfaces.end(),
                                      [&](const CitySurface& surface) { return HasName(surface, name); });
    if (is_known) continue;
    std::set<std::string> kinds;
    for (const CitySurface& surface : surfaces) kinds.insert(surface.kind);
    std::string known;
    for (const std::string& kind : kinds) known += (known.empty() ? "" : ", ") + kind;
    return InvalidInput("has no surface of the kind or id '" + name + "'; its kinds are " + known);
  }
  return OkStatus();
}

/// The middle of everything, where it is lowest.
Vector3d FindOrigin(const std::vector<CitySurface>& surfaces) {
  Eigen::AlignedBox3d box;
  for (const CitySurface& surface : surfaces) {
    for (const auto& ring : surface.rings) {
      for (const Vector3d& corner : ring) box.extend(corner);
    }
  }
  return {box.center().x(), box.center().y(), box.min().z()};
}

/// Normal of a ring that need not be flat, as long as twice its area (M. Newell).
Vector3d NormalOf(const std::vector<Vector3d>& ring) {
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i)
    normal += (ring[i] - ring[0]).cross(ring[(i + 1) % ring.size()] - ring[0]);
  return normal;
}

/// Nothing to see, nothing to touch.
bool IsNeedle(const Face& face) {
  constexpr double kFlat_m2 = 1e-9;
  return !(NormalOf(face).norm() > kFlat_m2);
}

void AddFace(const Face& face, Mesh& mesh) {
  const int first = static_cast<int>(mesh.vertices_m.size());
  mesh.vertices_m.insert(mesh.vertices_m.end(), face.begin(), face.end());
  for (std::size_t i = 2; i < face.size(); ++i) {
    const int last = first + static_cast<int>(i);
    if (!IsNeedle({face[0], face[i - 1], face[i]})) mesh.triangles.push_back({first, last - 1, last});
  }
}

/// The triangles of one polygon, seen from the same side, between its own corners, and where its sides cross.
void AddPolygon(const std::vector<Face>& rings, Mesh& mesh) {
  const Vector3d normal = NormalOf(rings.at(0));
  if (IsNeedle(rings[0])) return;
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(normal, Vector3d::UnitZ());
  const double height_m = (turn * rings[0][0]).z();
  std::map<std::pair<double, double>, Vector3d> corners;
  std::vector<Ring> flat;
  for (const auto& ring : rings) {
    Ring& flat_ring = flat.emplace_back();
    for (const Vector3d& corner : ring) {
      const Vector2d& at = flat_ring.emplace_back((turn * corner).head<2>());
      corners[{at.x(), at.y()}] = corner;
    }
  }
  const auto raise = [&](const Vector2d& at) -> Vector3d {
    const auto corner = corners.find({at.x(), at.y()});
    if (corner != corners.end()) return corner->second;
    return turn.inverse() * Vector3d(at.x(), at.y(), height_m);
  };
  for (const Polygon& polygon : MakeValid({flat[0], {flat.begin() + 1, flat.end()}})) {
    for (const auto& [a, b, c] : Triangulate(polygon)) AddFace({raise(a), raise(b), raise(c)}, mesh);
  }
}

Result<Mesh> BuildSurfaces(std::vector<CitySurface> surfaces, const MeshFile& wanted) {
  for (const auto* names : {&wanted.only, &wanted.without}) {
    if (const Status known = CheckNames(surfaces, *names); !known.ok()) return known.error();
  }
  const Vector3d origin = wanted.origin.value_or(FindOrigin(surfaces));
  Mesh mesh;
  for (CitySurface& surface : surfaces) {
    const bool is_wanted = wanted.only.empty() || HasNameOf(surface, wanted.only);
    if (!is_wanted || HasNameOf(surface, wanted.without) || surface.kind == "ClosureSurface") continue;
    for (auto& ring : surface.rings) {
      for (Vector3d& corner : ring) corner -= origin;
    }
    AddPolygon(surface.rings, mesh);
  }
  return mesh;
}

/// What of a face lies outside of a convex body, given by planes (inwards normal, least distance).
std::vector<Face> Subtract(const Face& whole, const std::vector<std::pair<Vector3d, double>>& body) {
  std::vector<Face> outside;
  Face face = whole;
  for (const auto& [inward, least] : body) {
    Face beyond = Clip(face, Vector3d(-inward), -least);
    if (beyond.size() >= 3) outside.push_back(std::move(beyond));
    face = Clip(face, inward, least);
    if (face.size() < 3) return {whole};
  }
  return outside;
}

/// The planes of each piece of a prism, in the frame of its section.
std::vector<std::vector<std::pair<Vector3d, double>>> PlanesOf(const Prism& prism) {
  std::vector<std::vector<std::pair<Vector3d, double>>> pieces;
  for (const auto& tile : Triangulate(prism.section)) {
    auto& planes = pieces.emplace_back();
    for (std::size_t i = 0; i < tile.size(); ++i) {
      const Vector2d side = tile[(i + 1) % tile.size()] - tile[i];
      const Vector3d inward(-side.y(), side.x(), 0.0);
      planes.emplace_back(inward, inward.head<2>().dot(tile[i]));
    }
    planes.emplace_back(Vector3d::UnitZ(), prism.low_m);
    planes.emplace_back(-Vector3d::UnitZ(), -prism.high_m);
  }
  return pieces;
}

Mesh CutAway(const Prism& cut, const Mesh& mesh) {
  const auto pieces = PlanesOf(cut);
  Mesh rest;
  for (const auto& triangle : mesh.triangles) {
    std::vector<Face> faces(1);
    for (const int corner : triangle) faces[0].push_back(Unplace(cut, mesh.vertices_m[corner]));
    for (const auto& piece : pieces) {
      std::vector<Face> left;
      for (const Face& face : faces) {
        for (Face& part : Subtract(face, piece)) left.push_back(std::move(part));
      }
      faces = std::move(left);
    }
    for (Face& face : faces) {
      for (Vector3d& corner : face) corner = Place(cut, corner.head<2>(), corner.z());
      AddFace(face, rest);
    }
  }
  return rest;
}

Result<Mesh> ReadSurfaces(const std::filesystem::path& file, const MeshFile& wanted) {
  if (file.extension() != ".obj") {
    Result<std::vector<CitySurface>> surfaces = ReadCityGml(file);
    if (!surfaces.ok()) return surfaces.error();
    Result<Mesh> mesh = BuildSurfaces(std::move(surfaces).value(), wanted);
    return mesh.ok() ? mesh : InvalidInput(file.string() + ": " + mesh.error().message);
  }
  if (!wanted.only.empty() || !wanted.without.empty())
    return InvalidInput(file.string() + ": an OBJ file has no kinds and ids of surfaces to choose from");
  Result<Mesh> mesh = ReadObj(file);
  if (mesh.ok() && wanted.origin) {
    for (Vector3d& vertex : mesh.value().vertices_m) vertex -= *wanted.origin;
  }
  return mesh;
}

}  // namespace

Result<Mesh> ReadMesh(const MeshFile& wanted, const std::filesystem::path& folder) {
  Result<Mesh> mesh = ReadSurfaces(folder / wanted.file, wanted);
  if (!mesh.ok()) return mesh;
  for (const Prism& cut : wanted.cuts) mesh = CutAway(cut, mesh.value());
  if (mesh.value().triangles.empty())
    return InvalidInput((folder / wanted.file).string() + ": nothing is left of it");
  return mesh;
}

}  // namespace soffit::sim
