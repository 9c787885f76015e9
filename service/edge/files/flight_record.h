#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "shared/flight/flight.h"
#include "shared/result/result.h"

namespace soffit {

/// What is known of a flight besides its pictures; all of it may be missing.
struct FlightRecord {
  std::vector<Eigen::Vector3d> track_in_map_m;             ///< As flown.
  std::optional<GeodeticOrigin> origin;                    ///< Of the map.
  Eigen::Vector3d map_origin_m = Eigen::Vector3d::Zero();  ///< Where the map's origin lies in the coordinates
                                                           ///< that files are written in.
  nlohmann::json mission;  ///< Outcome and steps, as the service tells them; null: none.
  nlohmann::json truth;    ///< As the simulator tells it; null: none.
};

/// A JSON object from a file.
Result<nlohmann::json> ReadJsonFile(const std::filesystem::path& file);

/// The columns x_m, y_m and z_m of a CSV file with a header line.
Result<std::vector<Eigen::Vector3d>> ReadTrackFile(const std::filesystem::path& file);

}  // namespace soffit
