#pragma once

#include "service/edge/drawing/canvas.h"
#include "service/pipeline/pipeline.h"

namespace soffit {

/// The picture with what was found in it drawn over it, for people: outlines of the colour extraction,
/// buildings of the vector map with the wanted ones marked, walls, openings (through or recess), corridor
/// with its decision, and the reason of a refusal; with a legend below. Same input, same picture.
Drawing DrawOverlay(const Observation& seen, const Understanding& understanding);

}  // namespace soffit
