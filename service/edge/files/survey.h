#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "service/match/match.h"
#include "shared/capture/capture.h"
#include "shared/flight/flight.h"
#include "shared/result/result.h"

namespace soffit {

/// All that a flight brought home, as a folder keeps it: `survey.json` and the pictures that it names.
struct Survey {
  std::vector<Capture> captures;  ///< In the order of the file; ids from 1. Each names another file.
  Eigen::Vector3d map_origin_m = Eigen::Vector3d::Zero();  ///< Of the map that the captures are placed in, in
                                                           ///< the file's coordinates: see ReadSurvey.
  VehicleEnvelope vehicle;
  std::string reference_file;            ///< The small map of what is wanted, relative to the folder.
  std::vector<std::string> colors;       ///< Of buildings; empty: as the options say.
  std::optional<GeodeticOrigin> origin;  ///< Of the map, where it is known.
};

/// Reads `folder/survey.json` (format soffit-survey/1). The pictures have to be there, but are not read: the
/// captures have no bytes. Errors name the file, the place in it and what is allowed there; files outside of
/// the folder are refused.
///
/// Positions in projected coordinates (EPSG:32632 and the like) are millions of metres, at which products of
/// coordinates lose their millimetres and OctoMap has no keys. Where the first picture is farther than half a
/// kilometre from the file's origin, the map's origin is on the ground beneath it, to the whole metre.
Result<Survey> ReadSurvey(const std::filesystem::path& folder);

/// Writes what `ReadSurvey` reads, and the pictures from the captures' bytes (those without bytes, or that
/// are there already, are left as they are).
Status WriteSurvey(const std::filesystem::path& folder, const Survey& survey);

/// Reads a small black-on-white map from a PNG or JPEG.
Result<Reference> ReadReferenceFile(const std::filesystem::path& file);

}  // namespace soffit
