#include "service/edge/files/outputs.h"

#include "service/edge/files/city_json.h"
#include "service/edge/files/file.h"
#include "service/edge/files/geopackage.h"
#include "service/edge/files/pictures.h"
#include "service/edge/files/result.h"

namespace soffit {

Status WriteOutputs(const std::filesystem::path& folder, const Analysis& analysis,
                    const FlightRecord& flight) {
  const auto& [observations, understanding] = analysis;
  Status status = WriteFile(folder / "scene.city.json", ToCityJson(understanding.scene, flight.origin));
  if (status.ok()) {
    status =
        WriteGeoPackage(folder / "scene.gpkg",
                        DescribeLayers(understanding, PicturesOf(observations), flight.track_in_map_m), flight.origin);
  }
  if (status.ok() && !observations.empty())
    status = WritePictures(folder, understanding, observations, flight);
  if (status.ok()) status = WriteResult(folder, understanding, observations, flight);
  return status;
}

}  // namespace soffit
