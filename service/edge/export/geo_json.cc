#include "service/edge/export/geo_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "service/edge/files/geodetic.h"

namespace soffit {
namespace {

using Json = nlohmann::ordered_json;
using Points = std::vector<Eigen::Vector3d>;

double Round(double value, double unit) { return std::round(value / unit) * unit; }

Json Position(const GeodeticFrame& frame, const Eigen::Vector3d& in_map_m) {
  const GeodeticPoint p = frame.Place(in_map_m);
  return {Round(p.longitude_deg, 1e-9), Round(p.latitude_deg, 1e-9), Round(p.altitude_amsl_m, 1e-4)};
}

Json Positions(const GeodeticFrame& frame, const Points& points, bool is_ring) {
  Json json = Json::array();
  for (const Eigen::Vector3d& point : points) json.push_back(Position(frame, point));
  if (is_ring && !points.empty()) json.push_back(json.front());
  return json;
}

Json Geometry(const GeodeticFrame& frame, GisShape shape, const std::vector<Points>& parts) {
  if (shape == GisShape::kPoint)
    return {{"type", "Point"}, {"coordinates", Position(frame, parts.front().front())}};
  if (shape == GisShape::kLine)
    return {{"type", "LineString"}, {"coordinates", Positions(frame, parts.front(), false)}};
  Json rings = Json::array();
  for (const Points& part : parts) rings.push_back(Positions(frame, part, true));
  return {{"type", "Polygon"}, {"coordinates", rings}};
}

Json Property(const GisValue& value) {
  return std::visit(
      [](const auto& v) -> Json {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::monostate> || std::is_same_v<T, std::vector<std::uint8_t>>) {
          return nullptr;
        } else {
          return v;
        }
      },
      value);
}

}  // namespace

Result<std::string> ToGeoJson(const std::vector<GisLayer>& layers,
                              const std::optional<GeodeticOrigin>& origin) {
  if (!origin)
    return Error{Error::Code::kNotFound, "GeoJSON is in WGS 84, and where the map lies is not known"};
  const GeodeticFrame frame(*origin);
  Json features = Json::array();
  for (const GisLayer& layer : layers) {
    if (layer.shape == GisShape::kNone) continue;
    for (const GisFeature& feature : layer.features) {
      if (feature.parts_in_map_m.empty() || feature.parts_in_map_m.front().empty()) continue;
      Json properties = {{"layer", layer.name}};
      for (std::size_t i = 0; i < layer.columns.size(); ++i)
        properties[layer.columns[i].name] = Property(feature.values.at(i));
      features.push_back({{"type", "Feature"},
                          {"properties", properties},
                          {"geometry", Geometry(frame, layer.shape, feature.parts_in_map_m)}});
    }
  }
  return Json{{"type", "FeatureCollection"}, {"features", features}}.dump(1) + "\n";
}

}  // namespace soffit
