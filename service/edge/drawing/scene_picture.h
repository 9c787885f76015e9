#pragma once

#include "service/edge/drawing/canvas.h"
#include "service/pipeline/pipeline.h"

namespace soffit {

/// The enriched scene in three dimensions, seen obliquely from before the corridor's entry: solids with their
/// openings, what the OctoMap holds as occupied beside them, corridors with their decisions, the cameras of
/// the pictures and the flown track (may be empty); what a solid hides of corridor and track is dashed. Same
/// input, same picture, on any number of threads.
Drawing DrawScenePicture(const Understanding& understanding, const std::vector<Observation>& observations,
                         const std::vector<Eigen::Vector3d>& track_in_map_m, const cv::Size& size_px);

}  // namespace soffit
