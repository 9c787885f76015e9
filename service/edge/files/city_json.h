#pragma once

#include <string>

#include "service/pipeline/pipeline.h"

namespace soffit {

/// The enriched scene as CityJSON 2.0, coordinates in the map frame. A modelled building is a closed LoD 3
/// Solid with semantic surfaces (the underside of an arch is an OuterCeilingSurface); its openings are a
/// MultiSurface beside it: ClosureSurface where the way leads through, else Window. A building without a
/// model is its LoD 0 footprint.
std::string ToCityJson(const Scene& scene);

}  // namespace soffit
