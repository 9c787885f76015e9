#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// The triangles of one part, in the map, and what they belong to.
struct WorldBody {
  std::string owner;  ///< Id of the structure; "bush" for bushes.
  Finish finish;
  double yaw_rad = 0.0;   ///< Patterns run along it.
  bool is_round = false;  ///< Bushes: the triangles stand for a rounded surface.
  Mesh mesh_in_map;
};

/// All bodies of a world: buildings, obstacles, scenery, bushes (in this order); not the ground. Absent
/// buildings are left out. Polygons are triangulated exactly (GEOS, constrained Delaunay).
std::vector<WorldBody> BuildBodies(const World& world);

/// The triangles of one structure, in the map, whether it is absent or not.
Mesh BuildMesh(const Structure& structure);

/// A solid vertical cylinder about its centre.
struct Cylinder {
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
  double height_m = 0.0;
};

/// Exact distance of the cylinder to a triangle; 0 when they touch or cross.
double Distance(const Cylinder& cylinder, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                const Eigen::Vector3d& c);

/// Where things are: answers distance queries in microseconds, from any thread.
class Space {
 public:
  explicit Space(const World& world);
  ~Space();
  Space(const Space&) = delete;
  Space& operator=(const Space&) = delete;

  struct Nearest {
    double distance_m =
        0.0;            ///< To the nearest surface or the ground, at most `limit_m`; 0 when touching it.
    std::string owner;  ///< Id of the structure, "bush", "ground", or "" when nothing is within `limit_m`.
  };

  /// Surfaces only: a cylinder that is wholly inside a solid wall is not seen to touch it. Sweep it in small
  /// steps.
  Nearest DistanceTo(const Cylinder& cylinder, double limit_m = 5.0) const;
  /// The same without the ground.
  Nearest DistanceToBodies(const Cylinder& cylinder, double limit_m = 5.0) const;

  /// Whether the cylinder moves in a straight line to `end_m` (its centre) without touching anything, ground
  /// included. What it would touch for less than 2 cm of the way may be missed.
  bool IsFreeAlong(Cylinder cylinder, const Eigen::Vector3d& end_m) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace soffit::sim
