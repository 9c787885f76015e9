#pragma once

#include <optional>
#include <vector>

#include "shared/geometry/polygon.h"
#include "test/sim/truth/truth.h"
#include "test/sim/world/space.h"

namespace soffit::sim {

using Triangle = std::array<Eigen::Vector3d, 3>;

/// All that a search for passages of one building looks at.
struct Site {
  std::vector<Triangle> building;  ///< Of the building itself.
  std::vector<Triangle> all;       ///< Of everything, the building included.
  std::vector<Polygon> footprint;
  VehicleEnvelope vehicle;
  const Space* space = nullptr;
};

/// Straight passages under or through the building, best first: see FindTruth.
std::vector<Passage> FindPassages(const Site& site);

}  // namespace soffit::sim
