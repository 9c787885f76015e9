#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "service/footprint/massing.h"
#include "shared/capture/capture.h"

namespace soffit {

/// The corners, edges and faces of a massing.
struct Wireframe {
  struct Corner {
    Eigen::Vector3d in_map_m = Eigen::Vector3d::Zero();
    std::vector<std::pair<Eigen::Index, Eigen::Vector3d>> by;  ///< How it moves with the parameters.
  };
  std::vector<Corner> corners;
  std::vector<std::array<std::size_t, 2>> edges;
  std::vector<std::vector<std::vector<std::size_t>>> faces;  ///< Rings of corners; more than one: with holes.
};
Wireframe FrameOf(const Massing& massing);

/// What of a picture a massing covers.
class Cover {
 public:
  Cover(const Wireframe& frame, const View& view);
  bool Contains(const Eigen::Vector2d& pixel) const;

 private:
  struct Face {
    Eigen::Vector2d low, high;
    std::vector<Ring> rings_px;
  };
  std::vector<Face> faces_;
};

}  // namespace soffit
