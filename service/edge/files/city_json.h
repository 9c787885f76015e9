#pragma once

#include <optional>
#include <string>

#include "service/pipeline/pipeline.h"

namespace soffit {

/// The enriched scene as CityJSON 2.0; in the metres of the map, or of its UTM zone when the origin is known. A
/// modelled building is a closed LoD 3 Solid with semantic surfaces (the underside of an arch is an
/// OuterCeilingSurface); the inside of a recess is a Window of its wall. Openings that have no face of their
/// own are a MultiSurface beside it: ClosureSurface where the way leads through, else Window. A building
/// without a model is its LoD 0 footprint.
std::string ToCityJson(const Scene& scene, const std::optional<GeodeticOrigin>& origin);

}  // namespace soffit
