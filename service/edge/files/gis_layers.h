#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "service/pipeline/pipeline.h"

namespace soffit {

// What geographic information systems are shown of a scene: tables of features, in the map's frame. A pure
// description; gis_dataset.h and geo_json.h write it.

enum class GisShape { kNone, kPoint, kLine, kPolygon };
enum class GisType { kInteger, kReal, kBoolean, kText, kBytes };
using GisValue =
    std::variant<std::monostate, std::int64_t, double, bool, std::string, std::vector<std::uint8_t>>;

struct GisColumn {
  std::string name;
  GisType type = GisType::kInteger;
};

struct GisFeature {
  std::vector<std::vector<Eigen::Vector3d>> parts_in_map_m;  ///< Rings, one line, one point; empty: nowhere.
  std::vector<GisValue> values;                              ///< In the order of the layer's columns.
};

struct GisLayer {
  std::string name;
  GisShape shape = GisShape::kNone;
  std::vector<GisColumn> columns;
  std::vector<GisFeature> features;
};

/// `footprints`: the vector map, on the ground.
GisLayer DescribeFootprints(const Scene& scene);
/// `openings` of the models, where they are in the walls.
GisLayer DescribeOpenings(const Scene& scene);
/// `corridors` with the decision about each of them.
GisLayer DescribeCorridors(const std::vector<ClearanceDecision>& decisions);
/// `decisions` with their evidence; they are nowhere.
GisLayer DescribeDecisions(const std::vector<ClearanceDecision>& decisions);

/// A picture, and from where it was taken.
struct TakenPicture {
  std::uint32_t capture_id = 0;
  std::string file;
  Purpose purpose = Purpose::kUnknown;
  Pose<Map, Camera> map_from_camera;
  double position_std_m = 0.0;
  bool has_trusted_pose = false;
};
/// `viewpoints`.
GisLayer DescribeViewpoints(const std::vector<TakenPicture>& pictures);

/// `tracks`: one line, when there are two points.
GisLayer DescribeTrack(const std::vector<Eigen::Vector3d>& points_in_map_m);

/// How QGIS draws a layer of that name, as it keeps styles (QML); empty: as it likes.
std::string StyleOf(const GisLayer& layer);

}  // namespace soffit
