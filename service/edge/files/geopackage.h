#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "service/edge/files/gis_layers.h"
#include "shared/flight/flight.h"
#include "shared/result/result.h"

namespace soffit {

/// The layers footprints, openings, corridors, decisions, viewpoints and tracks, all with heights.
std::vector<GisLayer> DescribeLayers(const Understanding& understanding,
                                     const std::vector<TakenPicture>& pictures,
                                     const std::vector<Eigen::Vector3d>& track_in_map_m);
std::vector<TakenPicture> PicturesOf(const std::vector<Observation>& observations);

/// Writes the layers as a GeoPackage in metres, as a whole, with styles for QGIS. With a geodetic origin it
/// lies where it belongs (transverse Mercator about the origin), else in a local frame. Same layers, same
/// bytes.
Status WriteGeoPackage(const std::filesystem::path& file, const std::vector<GisLayer>& layers,
                       const std::optional<GeodeticOrigin>& origin);

}  // namespace soffit
