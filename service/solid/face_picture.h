#pragma once

#include <vector>

#include "service/solid/solid.h"

namespace soffit {

/// The same solids, each face with the picture that it came from. A wall, and what is inside of its openings,
/// comes from the picture that its facade was read from; a passage from those of its two ends; a roof, and a
/// wall that no facade shows, from those that the footprint's outline was drawn from. Of several it is the
/// one that shows most of the face, and shows it large. None: the face is turned away from all of them,
/// outside of them, or hidden behind this or another solid. Pure; exact at about a hundred points of each
/// face.
///
/// @param facades  Of any of the solids.
/// @param sights  With the poses that the solids were adjusted to.
std::vector<Solid> FindFacePictures(std::vector<Solid> solids, const std::vector<Facade>& facades,
                                    const std::vector<Sight>& sights);

}  // namespace soffit
