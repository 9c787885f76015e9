#include "service/edge/files/city_json.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "service/edge/files/geodetic.h"

namespace soffit {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUnit_m = 1e-4;      // Of the integer coordinates.
constexpr double kLevelNormal = 0.5;  // Surfaces steeper than 60 degrees are walls.

/// The one list of vertices that all objects share, none of them twice.
class Vertices {
 public:
  explicit Vertices(const std::optional<GeodeticOrigin>& origin) {
    if (!origin) return;
    frame_.emplace(*origin);
    offset_m_ = frame_->PlaceInUtm(Eigen::Vector3d::Zero()).array().floor();
  }

  int Add(const Eigen::Vector3d& point) {
    const Eigen::Vector3d placed = frame_ ? frame_->PlaceInUtm(point) - offset_m_ : point;
    const Eigen::Vector3d units = placed / kUnit_m;
    const std::array<std::int64_t, 3> key = {std::llround(units.x()), std::llround(units.y()),
                                             std::llround(units.z())};
    const auto [at, is_new] = indices_.try_emplace(key, static_cast<int>(list_.size()));
    if (is_new) list_.push_back(key);
    return at->second;
  }
  template <class Points>
  Json AddRing(const Points& points) {
    Json ring = Json::array();
    for (const Eigen::Vector3d& point : points) ring.push_back(Add(point));
    return ring;
  }
  const Json& list() const { return list_; }

  Json Transform() const {
    return {{"scale", {kUnit_m, kUnit_m, kUnit_m}},
            {"translate", {offset_m_.x(), offset_m_.y(), offset_m_.z()}}};
  }
  Json Metadata() const {
    const std::string code = std::to_string(frame_->UtmCode());
    return {{"referenceSystem", "https://www.opengis.net/def/crs/EPSG/0/" + code}};
  }
  bool IsPlaced() const { return frame_.has_value(); }

 private:
  std::optional<GeodeticFrame> frame_;
  Eigen::Vector3d offset_m_ = Eigen::Vector3d::Zero();
  std::map<std::array<std::int64_t, 3>, int> indices_;
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
                 const Footprint& footprint) {
  const double height_m = footprint.height_m;
  const double eaves_m = footprint.levels.empty() ? height_m : footprint.levels.front().height_m;
  const double up = (b - a).cross(c - a).normalized().z();
  const double z = (a.z() + b.z() + c.z()) / 3.0;
  if (up > kLevelNormal) return z > 0.98 * eaves_m ? kRoof : kFloor;
  if (up < -kLevelNormal) return z < 0.02 * height_m ? kGround : kCeiling;
  return kWall;
}

Json DescribeOpening(const SolidOpening& opening) {
  return {{"type", opening.is_through ? "ClosureSurface" : "Window"},
          {"through", opening.is_through},
          {"wall", opening.wall},
          {"depth_m", opening.depth_m}};
}

/// Whether a triangle is the back of a recess: as the opening lies, as deep as it is, and within it.
bool IsBackOf(const SolidOpening& opening, const std::array<Eigen::Vector3d, 3>& triangle) {
  const auto& ring = opening.polygon_in_map_m;
  if (opening.is_through || ring.size() < 3) return false;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // M. Newell's, of the whole ring.
  for (std::size_t i = 0; i < ring.size(); ++i) normal += ring[i].cross(ring[(i + 1) % ring.size()]);
  normal.normalize();
  const Eigen::Vector3d facing = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized();
  if (!(facing.dot(normal) > 0.99)) return false;
  const Eigen::Vector3d across = normal.unitOrthogonal();
  const Eigen::Vector3d along = normal.cross(across);
  const auto in_plane = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector2d(p.dot(across), p.dot(along));
  };
  Ring outline;
  for (const Eigen::Vector3d& p : ring) outline.push_back(in_plane(p));
  const Eigen::Vector3d center = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
  constexpr double kSame_m = 0.01;
  for (const Eigen::Vector3d& corner : triangle) {
    const Eigen::Vector3d within = center + 0.98 * (corner - center);
    if (!Contains(outline, in_plane(within))) return false;
    if (std::abs((ring.front() - corner).dot(normal) - opening.depth_m) > kSame_m) return false;
  }
  return true;
}

/// @param has_face  Is told which openings are faces of the solid.
Json SolidGeometry(const Solid& solid, Vertices& vertices, std::vector<bool>& has_face) {
  const auto& points = solid.mesh.vertices_in_map_m;
  std::vector<int> index;
  for (const Eigen::Vector3d& point : points) index.push_back(vertices.Add(point));
  Json shell = Json::array();
  Json values = Json::array();
  Json surfaces = SurfaceTypes();
  std::map<std::size_t, Json> windows;  // Of an opening: the number of its surface.
  for (const auto& triangle : solid.mesh.triangles) {
    Json ring = Json::array();
    for (const int corner : triangle) ring.push_back(index.at(static_cast<std::size_t>(corner)));
    shell.push_back(Json::array({ring}));
    const auto at = [&](std::size_t i) -> const Eigen::Vector3d& {
      return points[static_cast<std::size_t>(triangle[i])];
    };
    Json value = Classify(at(0), at(1), at(2), solid.footprint);
    for (std::size_t i = 0; i < solid.openings.size() && value == kWall; ++i) {
      if (!IsBackOf(solid.openings[i], {at(0), at(1), at(2)})) continue;
      if (!has_face[i]) {
        has_face[i] = true;
        windows[i] = surfaces.size();
        surfaces[kWall]["children"].push_back(surfaces.size());
        surfaces.push_back(DescribeOpening(solid.openings[i]));
        surfaces.back()["parent"] = static_cast<int>(kWall);
      }
      value = windows[i];
    }
    values.push_back(value);
  }
  return {{"type", "Solid"},
          {"lod", "3"},
          {"boundaries", Json::array({shell})},
          {"semantics", {{"surfaces", surfaces}, {"values", Json::array({values})}}}};
}

/// Of the openings that are no faces of the solid; null when there are none.
Json OpeningGeometry(const Solid& solid, Vertices& vertices, const std::vector<bool>& has_face) {
  Json boundaries = Json::array();
  Json surfaces = Json::array();
  Json values = Json::array();
  for (std::size_t i = 0; i < solid.openings.size(); ++i) {
    if (has_face[i]) continue;
    boundaries.push_back(Json::array({vertices.AddRing(solid.openings[i].polygon_in_map_m)}));
    values.push_back(surfaces.size());
    surfaces.push_back(DescribeOpening(solid.openings[i]));
  }
  if (boundaries.empty()) return nullptr;
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

std::string ToCityJson(const Scene& scene, const std::optional<GeodeticOrigin>& origin) {
  Vertices vertices(origin);
  Json objects = Json::object();
  for (const SceneObject& object : scene.objects) {
    const Footprint& footprint = object.footprint;
    Json geometry = Json::array({FootprintGeometry(footprint, vertices)});
    for (const Solid& solid : scene.solids) {
      if (solid.footprint.object_id != footprint.object_id) continue;
      std::vector<bool> has_face(solid.openings.size(), false);
      geometry.push_back(SolidGeometry(solid, vertices, has_face));
      if (Json rest = OpeningGeometry(solid, vertices, has_face); !rest.is_null()) geometry.push_back(rest);
    }
    objects[std::to_string(footprint.object_id)] = {
        {"type", "Building"},
        {"attributes",
         {{"color", footprint.color}, {"height_m", footprint.height_m}, {"matched", object.is_matched}}},
        {"geometry", geometry}};
  }
  Json city = {{"type", "CityJSON"},
               {"version", "2.0"},
               {"transform", vertices.Transform()},
               {"CityObjects", objects},
               {"vertices", vertices.list()}};
  if (vertices.IsPlaced()) city["metadata"] = vertices.Metadata();
  return city.dump() + "\n";
}

}  // namespace soffit
