#include "service/edge/files/outputs.h"

#include "service/edge/files/city_json.h"
#include "service/edge/files/file.h"
#include "service/edge/files/geopackage.h"
#include "service/edge/files/move_map.h"
#include "service/edge/files/pictures.h"
#include "service/edge/files/result.h"

namespace soffit {

Status WriteOutputs(const std::filesystem::path& folder, const Analysis& analysis,
                    const FlightRecord& flight) {
  Status status = OkStatus();
  if (!analysis.observations.empty())
    status = WritePictures(folder, analysis.understanding, analysis.observations, flight);
  if (!status.ok()) return status;
  const auto& [observations, understanding] = MoveMap(analysis, flight.map_origin_m);
  std::vector<Eigen::Vector3d> track = flight.track_in_map_m;
  for (Eigen::Vector3d& point : track) point += flight.map_origin_m;
  status = WriteFile(folder / "scene.city.json",
                     ToCityJson(understanding.scene, PicturesOf(observations), flight.origin));
  if (!status.ok()) return status;
  status = WriteGeoPackage(folder / "scene.gpkg",
                           DescribeLayers(understanding, PicturesOf(observations), track), flight.origin);
  if (!status.ok()) return status;
  return WriteResult(folder, understanding, observations, flight);
}

}  // namespace soffit
