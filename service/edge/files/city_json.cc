#include "service/edge/files/city_json.h"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "service/edge/files/geodetic.h"

namespace soffit {
namespace {

using Json = nlohmann::ordered_json;

using PictureNames = std::map<std::uint32_t, std::string>;

constexpr double kUnit_m = 1e-4;  // Of the integer coordinates.

/// Hundredths are enough of pixels.
double Round(double value) { return std::round(100.0 * value) / 100.0; }

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

Json DescribeOpening(const SolidOpening& opening) {
  return {{"type", opening.is_through ? "ClosureSurface" : "Window"},
          {"through", opening.is_through},
          {"wall", opening.wall},
          {"depth_m", opening.depth_m}};
}

/// As rings of pixels, the outer one first.
Json DescribePixels(const Polygon& outline_px) {
  const auto corners = [](const Ring& ring) {
    Json list = Json::array();
    for (const Eigen::Vector2d& p : ring) list.push_back({Round(p.x()), Round(p.y())});
    return list;
  };
  Json rings = Json::array({corners(outline_px.outer)});
  for (const Ring& hole : outline_px.holes) rings.push_back(corners(hole));
  return rings;
}

Json DescribeFace(const Face& face, const Solid& solid, const PictureNames& pictures) {
  Json surface = {{"type", ToString(face.kind)}};
  if (face.kind == FaceKind::kBack)
    surface.update(DescribeOpening(solid.openings.at(static_cast<std::size_t>(face.opening))));
  else if (face.wall >= 0)
    surface["wall"] = face.wall;
  if (!face.picture) return surface;
  const auto name = pictures.find(face.picture->capture_id);
  if (name != pictures.end()) surface["picture"] = name->second;
  surface["capture"] = face.picture->capture_id;
  surface["picture_outline_px"] = DescribePixels(face.picture->outline_px);
  surface["picture_shown_ratio"] = Round(face.picture->shown_ratio);
  return surface;
}

Json SolidGeometry(const Solid& solid, const PictureNames& pictures, Vertices& vertices) {
  std::vector<int> index;
  for (const Eigen::Vector3d& point : solid.mesh.vertices_in_map_m) index.push_back(vertices.Add(point));
  Json shell = Json::array();
  for (const auto& triangle : solid.mesh.triangles) {
    Json ring = Json::array();
    for (const int corner : triangle) ring.push_back(index.at(static_cast<std::size_t>(corner)));
    shell.push_back(Json::array({ring}));
  }
  Json surfaces = Json::array();
  std::vector<std::size_t> values(solid.mesh.triangles.size());
  std::map<int, std::size_t> walls;  // The surface of the wall that a recess is in.
  for (std::size_t i = 0; i < solid.faces.size(); ++i) {
    const Face& face = solid.faces[i];
    for (const std::size_t triangle : face.triangles) values.at(triangle) = i;
    if (face.kind == FaceKind::kWall && face.opening < 0) walls.try_emplace(face.wall, i);
    surfaces.push_back(DescribeFace(face, solid, pictures));
  }
  for (std::size_t i = 0; i < solid.faces.size(); ++i) {
    const auto wall = walls.find(solid.faces[i].wall);
    if (solid.faces[i].kind != FaceKind::kBack || wall == walls.end()) continue;
    surfaces[i]["parent"] = wall->second;
    surfaces[wall->second]["children"].push_back(i);
  }
  return {{"type", "Solid"},
          {"lod", "3"},
          {"boundaries", Json::array({shell})},
          {"semantics", {{"surfaces", surfaces}, {"values", Json::array({values})}}}};
}

/// Of the openings that are no faces of the solid; null when there are none.
Json OpeningGeometry(const Solid& solid, Vertices& vertices) {
  std::vector<bool> has_face(solid.openings.size(), false);
  for (const Face& face : solid.faces) {
    if (face.kind == FaceKind::kBack) has_face.at(static_cast<std::size_t>(face.opening)) = true;
  }
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

std::string ToCityJson(const Scene& scene, const std::vector<TakenPicture>& pictures,
                       const std::optional<GeodeticOrigin>& origin) {
  PictureNames names;
  for (const TakenPicture& picture : pictures) names[picture.capture_id] = picture.file;
  Vertices vertices(origin);
  Json objects = Json::object();
  for (const SceneObject& object : scene.objects) {
    const Footprint& footprint = object.footprint;
    Json geometry = Json::array({FootprintGeometry(footprint, vertices)});
    for (const Solid& solid : scene.solids) {
      if (solid.footprint.object_id != footprint.object_id) continue;
      geometry.push_back(SolidGeometry(solid, names, vertices));
      if (Json rest = OpeningGeometry(solid, vertices); !rest.is_null()) geometry.push_back(rest);
    }
    Json attributes = {
        {"color", footprint.color}, {"height_m", footprint.height_m}, {"matched", object.is_matched}};
    for (const Level& level : footprint.levels)
      attributes["levels"].push_back({{"height_m", level.height_m}, {"inset_m", level.inset_m}});
    objects[std::to_string(footprint.object_id)] = {
        {"type", "Building"}, {"attributes", attributes}, {"geometry", geometry}};
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
