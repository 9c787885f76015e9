#pragma once

#include <optional>
#include <vector>

#include "service/corridor/corridor.h"
#include "service/scene/scene.h"
#include "service/viewpoint/viewpoint.h"

namespace soffit {

/// From where a level picture would show most of the places of a corridor that no picture has proved to be
/// free: before either end of the corridor, on its axis or beside it, at any height that the passage has and
/// above. A place counts when the model does not hide it and no earlier picture saw it from nearly the same
/// direction: what hid it there, or was seen behind it, is somewhere else in the new picture. The model
/// itself is the best background, then the ground, then the sky.
///
/// @param unknown_m  Such places.
/// @return None when no place for the vehicle would show any of them anew.
std::optional<Viewpoint> PlanLook(const Scene& scene, const Corridor& corridor,
                                  const std::vector<Eigen::Vector3d>& unknown_m,
                                  const std::vector<Sight>& sights, const VehicleEnvelope& vehicle);

}  // namespace soffit
