#include "service/edge/files/city_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace soffit {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUnit_m = 1e-4;      // Of the integer coordinates.
constexpr double kLevelNormal = 0.5;  // Surfaces steeper than 60 degrees are walls.

/// The one list of vertices that all objects share.
class Vertices {
 public:
  int Add(const Eigen::Vector3d& point) {
    const Eigen::Vector3d units = point / kUnit_m;
    list_.push_back({std::llround(units.x()), std::llround(units.y()), std::llround(units.z())});
    return static_cast<int>(list_.size()) - 1;
  }
  template <class Points>
  Json AddRing(const Points& points) {
    Json ring = Json::array();
    for (const Eigen::Vector3d& point : points) ring.push_back(Add(point));
    return ring;
  }
  const Json& list() const { return list_; }

 private:
  Json list_ = Json::array();
};

enum Surface { kRoof, kGround, kWall, kCeiling, kFloor };

Json SurfaceTypes() {
  return Json::array({{{"type", "RoofSurface"}},
                      {{"type", "GroundSurface"}},
                      {{"type", "WallSurface"}},
                      {{"type", "OuterCeilingSurface"}},
                      {{"type", "OuterFloorSurface"}}});
}

Surface Classify(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                 double height_m) {
  const double up = (b - a).cross(c - a).normalized().z();
  const double z = (a.z() + b.z() + c.z()) / 3.0;
  if (up > kLevelNormal) return z > 0.98 * height_m ? kRoof : kFloor;
  if (up < -kLevelNormal) return z < 0.02 * height_m ? kGround : kCeiling;
  return kWall;
}

Json SolidGeometry(const Solid& solid, Vertices& vertices) {
  const auto& points = solid.mesh.vertices_in_map_m;
  std::vector<int> index;
  for (const Eigen::Vector3d& point : points) index.push_back(vertices.Add(point));
  Json shell = Json::array();
  Json values = Json::array();
  for (const auto& triangle : solid.mesh.triangles) {
    Json ring = Json::array();
    for (const int corner : triangle) ring.push_back(index.at(static_cast<std::size_t>(corner)));
    shell.push_back(Json::array({ring}));
    const auto at = [&](std::size_t i) -> const Eigen::Vector3d& {
      return points[static_cast<std::size_t>(triangle[i])];
    };
    values.push_back(Classify(at(0), at(1), at(2), solid.footprint.height_m));
  }
  return {{"type", "Solid"},
          {"lod", "3"},
          {"boundaries", Json::array({shell})},
          {"semantics", {{"surfaces", SurfaceTypes()}, {"values", Json::array({values})}}}};
}

Json OpeningGeometry(const Solid& solid, Vertices& vertices) {
  Json boundaries = Json::array();
  Json surfaces = Json::array();
  Json values = Json::array();
  for (const SolidOpening& opening : solid.openings) {
    boundaries.push_back(Json::array({vertices.AddRing(opening.polygon_in_map_m)}));
    values.push_back(surfaces.size());
    surfaces.push_back({{"type", opening.is_through ? "ClosureSurface" : "Window"},
                        {"through", opening.is_through},
                        {"wall", opening.wall},
                        {"depth_m", opening.depth_m}});
  }
  return {{"type", "MultiSurface"},
          {"lod", "3"},
          {"boundaries", boundaries},
          {"semantics", {{"surfaces", surfaces}, {"values", values}}}};
}

Json FootprintGeometry(const Footprint& footprint, Vertices& vertices) {
  Json rings = Json::array();
  const auto add = [&](const Ring& ring) {
    std::vector<Eigen::Vector3d> lifted;
    for (const Eigen::Vector2d& corner : ring) lifted.emplace_back(corner.x(), corner.y(), 0.0);
    rings.push_back(vertices.AddRing(lifted));
  };
  add(footprint.polygon_in_map_m.outer);
  for (const Ring& hole : footprint.polygon_in_map_m.holes) add(hole);
  return {{"type", "MultiSurface"}, {"lod", "0"}, {"boundaries", Json::array({rings})}};
}

}  // namespace

std::string ToCityJson(const Scene& scene) {
  Vertices vertices;
  Json objects = Json::object();
  for (const SceneObject& object : scene.objects) {
    const Footprint& footprint = object.footprint;
    Json geometry = Json::array({FootprintGeometry(footprint, vertices)});
    for (const Solid& solid : scene.solids) {
      if (solid.footprint.object_id != footprint.object_id) continue;
      geometry.push_back(SolidGeometry(solid, vertices));
      if (!solid.openings.empty()) geometry.push_back(OpeningGeometry(solid, vertices));
    }
    objects[std::to_string(footprint.object_id)] = {
        {"type", "Building"},
        {"attributes",
         {{"color", footprint.color}, {"height_m", footprint.height_m}, {"matched", object.is_matched}}},
        {"geometry", geometry}};
  }
  const Json city = {{"type", "CityJSON"},
                     {"version", "2.0"},
                     {"transform", {{"scale", {kUnit_m, kUnit_m, kUnit_m}}, {"translate", {0.0, 0.0, 0.0}}}},
                     {"CityObjects", objects},
                     {"vertices", vertices.list()}};
  return city.dump() + "\n";
}

}  // namespace soffit
