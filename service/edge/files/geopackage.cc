#include "service/edge/files/geopackage.h"

#include <cpl_conv.h>

#include <stdexcept>

#include "service/edge/files/file.h"
#include "service/edge/files/gis_dataset.h"

namespace soffit {

std::vector<GisLayer> DescribeLayers(const Understanding& understanding,
                                     const std::vector<TakenPicture>& pictures,
                                     const std::vector<Eigen::Vector3d>& track_in_map_m) {
  return {DescribeFootprints(understanding.scene),
          DescribeOpenings(understanding.scene),
          DescribeCorridors(understanding.decisions),
          DescribeDecisions(understanding.decisions),
          DescribeViewpoints(pictures),
          DescribeTrack(track_in_map_m)};
}

std::vector<TakenPicture> PicturesOf(const std::vector<Observation>& observations) {
  std::vector<TakenPicture> pictures;
  for (const Observation& seen : observations) {
    const Image& image = seen.image;
    pictures.push_back({image.capture_id, image.name, image.purpose, image.view.map_from_camera,
                        image.view.position_std_m, image.has_trusted_pose});
  }
  return pictures;
}

Status WriteGeoPackage(const std::filesystem::path& file, const std::vector<GisLayer>& layers,
                       const std::optional<GeodeticOrigin>& origin) try {
  // The format stores when it was written; without a fixed date the same scene would not give the same bytes.
  CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", "2000-01-01T00:00:00.000Z");
  const std::filesystem::path part = PartOf(file);
  std::filesystem::remove(part);
  {
    GisDataset dataset = GisDataset::CreateFile(part);
    const GisFrame frame = GisFrame::InMetres(origin);
    dataset.Begin();
    for (const GisLayer& layer : layers) dataset.Add(layer, frame);
    dataset.Commit();
  }
  CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr);
  return CommitFile(file);
} catch (const std::exception& failure) {
  CPLSetThreadLocalConfigOption("OGR_CURRENT_DATE", nullptr);
  return Error{Error::Code::kUnavailable, file.string() + ": " + failure.what()};
}

}  // namespace soffit
