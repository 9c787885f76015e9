#include "test/sim/render/light_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "test/sim/world/noise.h"

namespace soffit::sim {
namespace {

constexpr int kStrata = 8;        // Rays per point: its square.
constexpr float kCell_m = 0.25F;  // Of the lattice; larger on large triangles.
constexpr int kMaxSteps = 24;
constexpr int kMaxGroundCells = 120;  // Along a side.
constexpr float kLift_m = 2e-3F;
constexpr float kOfSecondBounce = 0.35F;

int IndexInLattice(int steps, int i, int j) { return j * (steps + 1) - j * (j - 1) / 2 + i; }

/// Directions about `normal`, as dense as the cosine to it, one in each of 8 x 8 strata.
Eigen::Vector3f SampleDirection(const Eigen::Vector3f& normal, int stratum, std::uint64_t seed) {
  const int column = stratum % kStrata;
  const int row = stratum / kStrata;
  const std::uint64_t draw = seed + 2 * static_cast<std::uint64_t>(stratum);
  const double first = (column + ToUnit(Mix(draw))) / kStrata;
  const double second = (row + ToUnit(Mix(draw + 1))) / kStrata;
  const auto radius = static_cast<float>(std::sqrt(first));
  const auto angle = static_cast<float>(2.0 * std::numbers::pi * second);
  const Eigen::Vector3f across =
      std::abs(normal.z()) < 0.9F ? Eigen::Vector3f::UnitZ() : Eigen::Vector3f::UnitX();
  const Eigen::Vector3f s = normal.cross(across).normalized(), t = normal.cross(s);
  const auto height = static_cast<float>(std::sqrt(1.0 - first));
  return (radius * std::cos(angle) * s + radius * std::sin(angle) * t + height * normal).normalized();
}

class Gatherer {
 public:
  Gatherer(const std::vector<Paint>& paints, const Paint& ground, const Tracer& tracer, const SkyDome& sky)
      : paints_(paints), ground_(ground), tracer_(tracer), sky_(sky) {}

  /// The mean radiance over the half sphere, weighted by the cosine; none when the point is inside of a body.
  std::optional<Light> Gather(const Eigen::Vector3f& point_m, const Eigen::Vector3f& normal,
                              std::uint64_t seed) const {
    constexpr int kRays = kStrata * kStrata;
    Light sum = Light::Zero();
    int inside = 0;
    for (int begin = 0; begin < kRays; begin += kPacket) {
      RayPacket rays;
      for (rays.count = 0; rays.count < kPacket; ++rays.count) {
        rays.origin_m[rays.count] = point_m;
        rays.direction[rays.count] = SampleDirection(normal, begin + rays.count, seed);
      }
      const auto hits = tracer_.Trace(rays);
      for (int i = 0; i < kPacket; ++i) inside += hits[i].is_inside ? 1 : 0;
      sum += Sum(rays, hits);
    }
    if (2 * inside > kRays) return std::nullopt;
    return sum / kRays;
  }

 private:
  Light Sum(const RayPacket& rays, const std::array<RayHit, kPacket>& hits) const {
    Light sum = Light::Zero();
    RayPacket to_sun;
    std::array<Light, kPacket> in_sun;
    for (int i = 0; i < kPacket; ++i) {
      const RayHit& hit = hits[i];
      if (hit.body == RayHit::kSky) {
        sum += sky_.Glow(rays.direction[i]);
        continue;
      }
      const Light& color = hit.body == RayHit::kGround ? ground_.color : paints_[hit.body].color;
      sum += kOfSecondBounce * color.cwiseProduct(sky_.skylight());
      const float cosine = hit.normal.dot(sky_.toward_sun());
      if (cosine <= 0.0F) continue;
      in_sun[to_sun.count] = cosine * color.cwiseProduct(sky_.sunlight());
      to_sun.origin_m[to_sun.count] =
          rays.origin_m[i] + hit.distance_m * rays.direction[i] + kLift_m * hit.normal;
      to_sun.direction[to_sun.count++] = sky_.toward_sun();
    }
    const auto blocked = tracer_.IsBlocked(to_sun);
    for (int i = 0; i < to_sun.count; ++i) {
      if (!blocked[i]) sum += in_sun[i];
    }
    return sum;
  }

  const std::vector<Paint>& paints_;
  const Paint& ground_;
  const Tracer& tracer_;
  const SkyDome& sky_;
};

/// The lattice of one triangle. Points inside of another body get the mean of the others.
std::vector<Light> BakeTriangle(const std::array<Eigen::Vector3f, 3>& corners, int steps,
                                const Gatherer& gatherer, std::uint64_t seed) {
  const auto& [a, b, c] = corners;
  const Eigen::Vector3f normal = (b - a).cross(c - a).normalized(), center = (a + b + c) / 3.0F;
  std::vector<std::optional<Light>> gathered;
  Light sum = Light::Zero();
  int count = 0;
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i + j <= steps; ++i) {
      const Eigen::Vector3f exact = a + static_cast<float>(i) / static_cast<float>(steps) * (b - a) +
                                    static_cast<float>(j) / static_cast<float>(steps) * (c - a);
      const Eigen::Vector3f inwards = center - exact;
      const Eigen::Vector3f point =
          exact + 0.01F / std::max(inwards.norm(), 0.01F) * inwards + kLift_m * normal;
      gathered.push_back(gatherer.Gather(point, normal, Mix(seed + gathered.size())));
      if (!gathered.back()) continue;
      sum += *gathered.back();
      ++count;
    }
  }
  const Light mean = count > 0 ? Light(sum / static_cast<float>(count)) : Light(Light::Zero());
  std::vector<Light> values;
  for (const auto& light : gathered) values.push_back(light.value_or(mean));
  return values;
}

struct Extent {
  Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9F);
  Eigen::Vector2f high = Eigen::Vector2f::Constant(-1e9F);
};

/// Where bodies stand that darken the ground visibly: all but those far away from the origin.
Extent FindExtent(const std::vector<WorldBody>& bodies) {
  constexpr double kNear_m = 60.0;
  constexpr float kAround_m = 4.0F;
  Extent extent;
  for (const WorldBody& body : bodies) {
    for (const Eigen::Vector3d& vertex : body.mesh_in_map.vertices_m) {
      if (vertex.head<2>().norm() > kNear_m) continue;
      const Eigen::Vector2f at = vertex.head<2>().cast<float>();
      extent.low = extent.low.cwiseMin(at - Eigen::Vector2f::Constant(kAround_m));
      extent.high = extent.high.cwiseMax(at + Eigen::Vector2f::Constant(kAround_m));
    }
  }
  return extent;
}

}  // namespace

LightMap::LightMap(const std::vector<WorldBody>& bodies, const std::vector<Paint>& paints,
                   const Paint& ground, const Tracer& tracer, const SkyDome& sky)
    : skylight_(sky.skylight()) {
  const Gatherer gatherer(paints, ground, tracer, sky);
  from_below_ =
      ground.color.cwiseProduct(sky.skylight() + std::max(0.0F, sky.toward_sun().z()) * sky.sunlight());
  std::uint64_t seed = 1;
  for (const WorldBody& body : bodies) {
    auto& lattices = lattices_.emplace_back(body.mesh_in_map.triangles.size());
    if (body.is_round) continue;
    for (std::size_t t = 0; t < lattices.size(); ++t) {
      std::array<Eigen::Vector3f, 3> corners;
      for (int i = 0; i < 3; ++i)
        corners[i] = body.mesh_in_map.vertices_m[body.mesh_in_map.triangles[t][i]].cast<float>();
      const float longest_m = std::max({(corners[1] - corners[0]).norm(), (corners[2] - corners[1]).norm(),
                                        (corners[0] - corners[2]).norm()});
      lattices[t] = {std::clamp(static_cast<int>(std::ceil(longest_m / kCell_m)), 1, kMaxSteps),
                     values_.size()};
      const auto values = BakeTriangle(corners, lattices[t].steps, gatherer, Mix(seed++));
      values_.insert(values_.end(), values.begin(), values.end());
    }
  }
  const Extent extent = FindExtent(bodies);
  if (extent.low.x() > extent.high.x()) return;
  const Eigen::Vector2f size = extent.high - extent.low;
  ground_low_m_ = extent.low;
  ground_cell_m_ = std::max(kCell_m, size.maxCoeff() / kMaxGroundCells);
  ground_columns_ = static_cast<int>(std::ceil(size.x() / ground_cell_m_)) + 1;
  ground_rows_ = static_cast<int>(std::ceil(size.y() / ground_cell_m_)) + 1;
  for (int row = 0; row < ground_rows_; ++row) {
    for (int column = 0; column < ground_columns_; ++column) {
      const Eigen::Vector2f at = ground_low_m_ + ground_cell_m_ * Eigen::Vector2f(static_cast<float>(column),
                                                                                  static_cast<float>(row));
      ground_.push_back(gatherer.Gather({at.x(), at.y(), kLift_m}, Eigen::Vector3f::UnitZ(), Mix(seed++))
                            .value_or(Light(0.3F * skylight_)));
    }
  }
}

Light LightMap::AtGround(const Eigen::Vector3f& point_m) const {
  const Eigen::Vector2f at = (point_m.head<2>() - ground_low_m_) / ground_cell_m_;
  if (!(at.x() >= 0.0F && at.y() >= 0.0F && at.x() < static_cast<float>(ground_columns_ - 1) &&
        at.y() < static_cast<float>(ground_rows_ - 1))) {
    return skylight_;
  }
  const int column = static_cast<int>(at.x()), row = static_cast<int>(at.y());
  const float right = at.x() - static_cast<float>(column), up = at.y() - static_cast<float>(row);
  const Light* light = &ground_[static_cast<std::size_t>(row) * ground_columns_ + column];
  return (1.0F - up) * ((1.0F - right) * light[0] + right * light[1]) +
         up * ((1.0F - right) * light[ground_columns_] + right * light[ground_columns_ + 1]);
}

Light LightMap::At(const RayHit& hit, const Eigen::Vector3f& point_m) const {
  if (hit.body == RayHit::kGround) return AtGround(point_m);
  const Lattice& lattice = lattices_[hit.body][hit.triangle];
  const float upwards = 0.5F + 0.5F * hit.normal.z();
  if (lattice.steps == 0) return 0.8F * (upwards * skylight_ + (1.0F - upwards) * from_below_);
  const auto steps = static_cast<float>(lattice.steps);
  const float a = std::clamp(hit.u, 0.0F, 1.0F) * steps, b = std::clamp(hit.v, 0.0F, 1.0F) * steps;
  const int i = std::min(static_cast<int>(a), lattice.steps - 1);
  const int j = std::clamp(static_cast<int>(b), 0, lattice.steps - 1 - i);
  const float x = std::clamp(a - static_cast<float>(i), 0.0F, 1.0F),
              y = std::clamp(b - static_cast<float>(j), 0.0F, 1.0F);
  const auto value = [&](int di, int dj) -> const Light& {
    return values_[lattice.first + IndexInLattice(lattice.steps, i + di, j + dj)];
  };
  if (x + y <= 1.0F || i + j + 2 > lattice.steps) {
    const float rest = std::max(0.0F, 1.0F - x - y);
    return (rest * value(0, 0) + x * value(1, 0) + y * value(0, 1)) / (rest + x + y);
  }
  return (x + y - 1.0F) * value(1, 1) + (1.0F - y) * value(1, 0) + (1.0F - x) * value(0, 1);
}

}  // namespace soffit::sim
