#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "shared/result/result.h"

namespace soffit::sim {

/// One polygon of a building in space.
struct CitySurface {
  std::string kind;              ///< Of the object that it belongs to: WallSurface, Window, Door...
  std::vector<std::string> ids;  ///< gml:id of that object and of the polygon, where they have one.
  std::vector<std::vector<Eigen::Vector3d>>
      rings;  ///< In the file's coordinates; the outer one first, the last corner is not the first.
};

/// All surfaces of a CityGML 2 or 3 file in the finest level of detail from 1 to 3 that it has, in the file's
/// order. Polygons that are given by reference only (xlink) are those that stand elsewhere in the file;
/// library objects (implicit geometry) are not read. Errors name the file, and the polygon that is not
/// understood.
Result<std::vector<CitySurface>> ReadCityGml(const std::filesystem::path& file);

}  // namespace soffit::sim
