#include "service/edge/export/export.h"

#include <functional>

#include "service/edge/export/flight_plan.h"
#include "service/edge/export/geo_json.h"
#include "service/edge/export/meshes.h"
#include "service/edge/files/city_json.h"
#include "service/edge/files/file.h"
#include "service/edge/files/geopackage.h"
#include "service/edge/files/map_file.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;

Status WriteText(const fs::path& file, const Result<std::string>& text) {
  if (!text.ok()) return text.error();
  return WriteFile(file, text.value());
}

Status WriteOctree(const fs::path& file, const Scene& scene, MapFormat format) {
  if (!scene.octree) return Error{Error::Code::kNotFound, "the scene has no map yet"};
  return WriteMap(file, *scene.octree, scene.revision, format);
}

struct Writer {
  ExportFormat format;
  std::function<Status(const fs::path&, const ExportedScene&)> write;
};

const std::vector<Writer>& Writers() {
  static const std::vector<Writer> writers = {
      {{"bt", "OctoMap: free and occupied, with a manifest"},
       [](const fs::path& file, const ExportedScene& s) {
         return WriteOctree(file, s.understanding.scene, MapFormat::kBinary);
       }},
      {{"ot", "OctoMap with the log-odds of each node, with a manifest"},
       [](const fs::path& file, const ExportedScene& s) {
         return WriteOctree(file, s.understanding.scene, MapFormat::kFull);
       }},
      {{"obj", "Wavefront: a group for each model"},
       [](const fs::path& file, const ExportedScene& s) {
         return WriteText(file, ToObj(s.understanding.scene.solids));
       }},
      {{"ply", "Stanford: all models as one mesh"},
       [](const fs::path& file, const ExportedScene& s) {
         return WriteText(file, ToPly(s.understanding.scene.solids));
       }},
      {{"glb", "glTF 2.0: a node for each model, in its colour"},
       [](const fs::path& file, const ExportedScene& s) {
         return WriteText(file, ToGlb(s.understanding.scene.solids));
       }},
      {{"cityjson", "CityJSON 2.0: closed LoD 3 solids with openings; in UTM when the origin is known"},
       [](const fs::path& file, const ExportedScene& s) {
         return WriteFile(file, ToCityJson(s.understanding.scene, s.pictures, s.origin));
       }},
      {{"gpkg", "GeoPackage: layers with styles for QGIS"},
       [](const fs::path& file, const ExportedScene& s) {
         return WriteGeoPackage(file, s.layers, s.origin);
       }},
      {{"geojson", "GeoJSON: the same layers in WGS 84; needs an origin"},
       [](const fs::path& file, const ExportedScene& s) {
         return WriteText(file, ToGeoJson(s.layers, s.origin));
       }},
      {{"plan", "QGroundControl: over, through and back by the widest CLEAR corridor; needs an origin"},
       [](const fs::path& file, const ExportedScene& s) {
         return WriteText(file, ToFlightPlan(s.understanding, s.origin));
       }},
  };
  return writers;
}

}  // namespace

const std::vector<ExportFormat>& ExportFormats() {
  static const std::vector<ExportFormat> formats = [] {
    std::vector<ExportFormat> all;
    for (const Writer& writer : Writers()) all.push_back(writer.format);
    return all;
  }();
  return formats;
}

Status WriteExport(const fs::path& file, const std::string& format, const ExportedScene& scene) {
  for (const Writer& writer : Writers()) {
    if (format == writer.format.name) return writer.write(file, scene);
  }
  std::string known;
  for (const ExportFormat& each : ExportFormats()) known += std::string(" ") + each.name;
  return InvalidInput("'" + format + "' is no format; there are" + known);
}

}  // namespace soffit
