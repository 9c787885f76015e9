#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "test/sim/world/embree.h"
#include "test/sim/world/space.h"

namespace soffit::sim {

constexpr int kPacket = 16;

/// Up to sixteen rays at once.
struct RayPacket {
  std::array<Eigen::Vector3f, kPacket> origin_m;
  std::array<Eigen::Vector3f, kPacket> direction;  ///< Unit length.
  int count = 0;
};

/// What a ray met first.
struct RayHit {
  static constexpr int kSky = -1;
  static constexpr int kGround = -2;
  int body = kSky;  ///< Index of the body, or kGround, or kSky.
  int triangle = 0;
  float u = 0.0F;  ///< Barycentric: point = (1 - u - v) a + u b + v c.
  float v = 0.0F;
  float distance_m = 0.0F;
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< Unit, towards where the ray came from.
  bool is_inside = false;  ///< The surface was met from behind: the ray began inside of a body.
};

/// The bodies and the ground (the plane z = 0) as Embree sees them.
class Tracer {
 public:
  explicit Tracer(const std::vector<WorldBody>& bodies);

  std::array<RayHit, kPacket> Trace(const RayPacket& rays) const;
  std::array<bool, kPacket> IsBlocked(const RayPacket& rays) const;  ///< By a body, at any distance.

 private:
  EmbreeScene scene_;
};

}  // namespace soffit::sim
