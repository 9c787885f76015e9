#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/edge/files/gis_layers.h"
#include "shared/flight/flight.h"

namespace soffit {

/// The enriched scene as CityJSON 2.0; in the metres of the map, or of its UTM zone when the origin is known.
/// A modelled building is a closed LoD 3 Solid with semantic surfaces (the underside of an arch is an
/// OuterCeilingSurface); the inside of a recess is a Window of its wall. A surface that came from a picture
/// has `capture`, `picture` (its file, when `pictures` has it), `picture_outline_px` (rings in pixels of that
/// file, pixel centres at integer coordinates) and `picture_shown_ratio` (what the picture shows of it).
/// Openings that have no face of their own are a MultiSurface beside it: ClosureSurface where the way leads
/// through, else Window. A building without a model is its LoD 0 footprint; `levels` are those of Footprint.
std::string ToCityJson(const Scene& scene, const std::vector<TakenPicture>& pictures,
                       const std::optional<GeodeticOrigin>& origin);

}  // namespace soffit
