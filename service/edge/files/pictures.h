#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "service/edge/files/flight_record.h"
#include "service/pipeline/pipeline.h"
#include "shared/result/result.h"

namespace soffit {

/// Name of the overlay of a picture, relative to the result's folder: "overlay/wall_0.jpg".
std::string OverlayFile(const Image& image);

/// Writes overlay/*.jpg, top_view.png, scene.png (three dimensions) and summary.png (a picture with its
/// overlay, the map and the scene, side by side).
Status WritePictures(const std::filesystem::path& folder, const Understanding& understanding,
                     const std::vector<Observation>& observations, const FlightRecord& flight);

}  // namespace soffit
