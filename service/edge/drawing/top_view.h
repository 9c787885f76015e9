#pragma once

#include "service/edge/drawing/canvas.h"
#include "service/pipeline/pipeline.h"

namespace soffit {

/// A map of the enriched scene, north up, with a scale bar: buildings with numbers and heights, the wanted
/// ones marked, openings, viewpoints of the pictures, corridors with their decisions, the flown track (may be
/// empty), and the OctoMap at the corridor's height (free, occupied, unknown). Same input, same picture.
Drawing DrawTopView(const Understanding& understanding, const std::vector<Observation>& observations,
                    const std::vector<Eigen::Vector3d>& track_in_map_m);

}  // namespace soffit
