#include "service/edge/files/gis_layers.h"

#include <cmath>
#include <numbers>
#include <sstream>

namespace soffit {
namespace {

using Points = std::vector<Eigen::Vector3d>;

std::int64_t Id(std::uint32_t id) { return id; }
double Degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

Points OnGround(const Ring& ring) {
  Points points;
  for (const Eigen::Vector2d& p : ring) points.emplace_back(p.x(), p.y(), 0.0);
  return points;
}

std::string List(const std::vector<std::uint32_t>& ids) {
  std::string text;
  for (const std::uint32_t id : ids) text += (text.empty() ? "" : " ") + std::to_string(id);
  return text;
}

// ---- Styles ----

/// What is drawn in one colour: where the style's category has this value.
struct Ink {
  const char* value;
  const char* color;  ///< "R,G,B,A"
};
struct Style {
  const char* layer;
  const char* category;  ///< Expression that decides the colour; empty: all alike.
  std::vector<Ink> inks;
};

const std::vector<Style>& Styles() {
  static const std::vector<Style> styles = {
      {"footprints",
       "if(matched,'wanted','other')",
       {{"wanted", "230,120,20,150"}, {"other", "120,140,160,110"}}},
      {"openings", "if(through,'way','recess')", {{"way", "40,160,80,200"}, {"recess", "60,110,200,200"}}},
      {"corridors",
       "verdict",
       {{"CLEAR", "20,160,60,255"}, {"BLOCKED", "210,40,40,255"}, {"INSUFFICIENT_DATA", "220,170,20,255"}}},
      {"viewpoints", "", {{"", "40,90,200,255"}}},
      {"tracks", "", {{"", "130,60,170,200"}}},
  };
  return styles;
}

std::string Symbol(GisShape shape, std::size_t name, const char* color) {
  const char* type = shape == GisShape::kPolygon ? "fill" : shape == GisShape::kLine ? "line" : "marker";
  const char* kind = shape == GisShape::kPolygon ? "SimpleFill"
                     : shape == GisShape::kLine  ? "SimpleLine"
                                                 : "SimpleMarker";
  const std::string color_key = shape == GisShape::kLine ? "line_color" : "color";
  std::ostringstream text;
  text << "<symbol type=\"" << type << "\" name=\"" << name << "\" alpha=\"1\"><layer class=\"" << kind
       << "\" enabled=\"1\"><Option type=\"Map\"><Option name=\"" << color_key
       << "\" type=\"QString\" value=\"" << color << "\"/>";
  if (shape == GisShape::kLine) text << "<Option name=\"line_width\" type=\"QString\" value=\"0.8\"/>";
  text << "</Option></layer></symbol>";
  return text.str();
}

}  // namespace

GisLayer DescribeFootprints(const Scene& scene) {
  GisLayer layer{"footprints",
                 GisShape::kPolygon,
                 {{"object_id", GisType::kInteger},
                  {"color", GisType::kText},
                  {"height_m", GisType::kReal},
                  {"height_std_m", GisType::kReal},
                  {"is_cut", GisType::kBoolean},
                  {"matched", GisType::kBoolean},
                  {"score", GisType::kReal},
                  {"captures", GisType::kText}},
                 {}};
  for (const SceneObject& object : scene.objects) {
    const Footprint& footprint = object.footprint;
    std::vector<Points> rings = {OnGround(footprint.polygon_in_map_m.outer)};
    for (const Ring& hole : footprint.polygon_in_map_m.holes) rings.push_back(OnGround(hole));
    layer.features.push_back({rings,
                              {Id(footprint.object_id), footprint.color, footprint.height_m,
                               footprint.height_std_m, footprint.is_cut, object.is_matched,
                               object.is_matched ? object.match.score : 0.0, List(footprint.captures)}});
  }
  return layer;
}

GisLayer DescribeOpenings(const Scene& scene) {
  GisLayer layer{"openings",
                 GisShape::kPolygon,
                 {{"object_id", GisType::kInteger},
                  {"wall", GisType::kInteger},
                  {"through", GisType::kBoolean},
                  {"depth_m", GisType::kReal},
                  {"std_m", GisType::kReal}},
                 {}};
  for (const Solid& solid : scene.solids) {
    for (const SolidOpening& opening : solid.openings) {
      layer.features.push_back({{opening.polygon_in_map_m},
                                {Id(solid.footprint.object_id), std::int64_t{opening.wall},
                                 opening.is_through, opening.depth_m, opening.std_m}});
    }
  }
  return layer;
}

GisLayer DescribeCorridors(const std::vector<ClearanceDecision>& decisions) {
  GisLayer layer{"corridors",
                 GisShape::kLine,
                 {{"object_id", GisType::kInteger},
                  {"side", GisType::kInteger},
                  {"verdict", GisType::kText},
                  {"reason", GisType::kText},
                  {"free_width_m", GisType::kReal},
                  {"free_height_m", GisType::kReal},
                  {"floor_m", GisType::kReal},
                  {"std_m", GisType::kReal}},
                 {}};
  for (const ClearanceDecision& decision : decisions) {
    if (!decision.corridor) continue;
    const Corridor& corridor = *decision.corridor;
    layer.features.push_back(
        {{corridor.Path()},
         {Id(decision.object_id), std::int64_t{decision.side}, ToString(decision.verdict), decision.reason,
          corridor.free_width_m, corridor.free_height_m, corridor.floor_m, corridor.std_m}});
  }
  return layer;
}

GisLayer DescribeDecisions(const std::vector<ClearanceDecision>& decisions) {
  GisLayer layer{"decisions",
                 GisShape::kNone,
                 {{"object_id", GisType::kInteger},
                  {"side", GisType::kInteger},
                  {"verdict", GisType::kText},
                  {"reason", GisType::kText},
                  {"seen_ratio", GisType::kReal},
                  {"margin_left_m", GisType::kReal},
                  {"margin_right_m", GisType::kReal},
                  {"margin_up_m", GisType::kReal},
                  {"margin_down_m", GisType::kReal},
                  {"binding", GisType::kText},
                  {"to_occupied_m", GisType::kReal},
                  {"to_unknown_m", GisType::kReal},
                  {"to_surface_m", GisType::kReal},
                  {"evidence", GisType::kText}},
                 {}};
  for (const ClearanceDecision& decision : decisions) {
    layer.features.push_back(
        {{},
         {Id(decision.object_id), std::int64_t{decision.side}, ToString(decision.verdict), decision.reason,
          decision.seen_ratio, decision.margin_left_m, decision.margin_right_m, decision.margin_up_m,
          decision.margin_down_m, ToString(decision.binding), decision.distances.to_occupied_m,
          decision.distances.to_unknown_m, decision.distances.to_surface_m, List(decision.evidence)}});
  }
  return layer;
}

GisLayer DescribeViewpoints(const std::vector<TakenPicture>& pictures) {
  GisLayer layer{"viewpoints",
                 GisShape::kPoint,
                 {{"capture_id", GisType::kInteger},
                  {"file", GisType::kText},
                  {"purpose", GisType::kText},
                  {"heading_deg", GisType::kReal},
                  {"pitch_deg", GisType::kReal},
                  {"position_std_m", GisType::kReal},
                  {"is_trusted", GisType::kBoolean}},
                 {}};
  for (const TakenPicture& picture : pictures) {
    const Eigen::Vector3d forward = picture.map_from_camera.rotation * Eigen::Vector3d::UnitZ();
    const double heading_deg = Degrees(std::atan2(forward.x(), forward.y()));  // Clockwise from north.
    layer.features.push_back({{{picture.map_from_camera.translation_m}},
                              {Id(picture.capture_id), picture.file, ToString(picture.purpose), heading_deg,
                               Degrees(std::asin(std::clamp(forward.z(), -1.0, 1.0))), picture.position_std_m,
                               picture.has_trusted_pose}});
  }
  return layer;
}

GisLayer DescribeTrack(const std::vector<Eigen::Vector3d>& points_in_map_m) {
  GisLayer layer{"tracks", GisShape::kLine, {{"points", GisType::kInteger}}, {}};
  if (points_in_map_m.size() >= 2)
    layer.features.push_back({{points_in_map_m}, {static_cast<std::int64_t>(points_in_map_m.size())}});
  return layer;
}

std::string StyleOf(const GisLayer& layer) {
  for (const Style& style : Styles()) {
    if (!layer.name.starts_with(style.layer)) continue;
    const bool is_single = *style.category == '\0';
    std::ostringstream text;
    text << "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'><qgis version=\"3.22\">"
         << "<renderer-v2 type=\"" << (is_single ? "singleSymbol" : "categorizedSymbol") << '"';
    if (!is_single) text << " attr=\"" << style.category << '"';
    text << "><symbols>";
    for (std::size_t i = 0; i < style.inks.size(); ++i) text << Symbol(layer.shape, i, style.inks[i].color);
    text << "</symbols>";
    if (!is_single) {
      text << "<categories>";
      for (std::size_t i = 0; i < style.inks.size(); ++i) {
        text << "<category render=\"true\" symbol=\"" << i << "\" value=\"" << style.inks[i].value
             << "\" label=\"" << style.inks[i].value << "\"/>";
      }
      text << "</categories>";
    }
    text << "</renderer-v2></qgis>";
    return text.str();
  }
  return "";
}

}  // namespace soffit
