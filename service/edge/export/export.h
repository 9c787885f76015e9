#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "service/edge/files/gis_layers.h"
#include "service/pipeline/pipeline.h"
#include "shared/flight/flight.h"
#include "shared/result/result.h"

namespace soffit {

/// What of one revision of a scene other programs are given.
struct ExportedScene {
  const Understanding& understanding;
  const std::vector<TakenPicture>& pictures;
  const std::vector<GisLayer>& layers;
  const std::optional<GeodeticOrigin>& origin;  ///< Of the map.
};

struct ExportFormat {
  const char* name;  ///< As the command line takes it, and the end of the file's name.
  const char* help;
};
/// All of them, in the order of their help.
const std::vector<ExportFormat>& ExportFormats();

/// Writes the scene to `file`, as a whole. Same scene, same bytes. With an origin it lies where it belongs on
/// Earth in the formats that can tell; the others are in the map's metres (x east, y north, z up; glTF: y
/// up). An error when `format` is none, or when it needs an origin, a map or a CLEAR corridor and there is
/// none.
Status WriteExport(const std::filesystem::path& file, const std::string& format, const ExportedScene& scene);

}  // namespace soffit
