#include "test/sim/render/renderer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <thread>

#include "test/sim/render/film.h"
#include "test/sim/render/lens.h"
#include "test/sim/render/light_map.h"
#include "test/sim/render/sky.h"
#include "test/sim/render/texture.h"
#include "test/sim/render/tracer.h"
#include "test/sim/world/noise.h"

namespace soffit::sim {
namespace {

using Eigen::Vector3f;

constexpr int kFewRays = 4;           // Of a pixel that shows one surface.
constexpr int kManyRays = kPacket;    // Of a pixel that shows an edge, of a thing or of a shadow.
constexpr float kSunRadius = 0.006F;  // Of its disc, in radians; a little haze around it included.
constexpr float kLift = 2e-4F;        // Off the surface, relative to the distance.

struct Pixel {
  int column = 0;
  int row = 0;
};

/// One ray through a pixel and what it found.
struct Sample {
  RayHit hit;
  Vector3f direction;
  Vector3f point_m;
  std::uint64_t id = 0;  ///< Unique in the picture.
  bool is_sunlit = false;
};

/// Samples of one pixel that see the same thing.
struct Patch {
  Sample first;
  Vector3f point_sum = Vector3f::Zero();
  Vector3f normal_sum = Vector3f::Zero();
  Light other_light = Light::Zero();  ///< That does not come straight from the sun.
  float sunlit = 0.0F;                ///< Sum of cosines.
  int count = 0;
};

bool IsSameThing(const Sample& a, const Sample& b, const std::vector<WorldBody>& bodies) {
  if (a.hit.body != b.hit.body) return false;
  if (a.hit.body < 0 || bodies[a.hit.body].is_round) return true;
  return a.hit.normal.dot(b.hit.normal) > 0.999F &&
         std::abs((a.point_m - b.point_m).dot(a.hit.normal)) < 1e-3F * a.hit.distance_m;
}

}  // namespace

struct Renderer::Stage {
  Stage(const World& world, int thread_count)
      : camera(world.camera),
        haze_m(static_cast<float>(world.sky.haze_m)),
        threads(std::max(1, thread_count)),
        bodies(BuildBodies(world)),
        ground(Mix(world.ground, world.home_yaw_rad)),
        lens(world.camera.intrinsics),
        sky(world.sky, world.sun),
        tracer(bodies),
        light_map(bodies, MixAll(bodies), ground, tracer, sky),
        paints(MixAll(bodies)) {}

  static std::vector<Paint> MixAll(const std::vector<WorldBody>& bodies) {
    std::vector<Paint> paints;
    for (const WorldBody& body : bodies) paints.push_back(Mix(body.finish, body.yaw_rad));
    return paints;
  }

  std::vector<Sample> Look(const Exposure& exposure, const std::vector<Pixel>& pixels, int rays_each) const;
  void FindSunlit(std::vector<Sample>& samples, std::uint64_t seed) const;
  Light Shade(const Patch& patch) const;
  Light Combine(const Sample* samples, int count) const;
  bool IsEven(const Sample* samples, int count) const;
  void RenderRow(const Exposure& exposure, int row, cv::Mat3f& light) const;

  CameraModel camera;
  float haze_m;
  int threads;
  std::vector<WorldBody> bodies;
  Paint ground;
  Lens lens;
  SkyDome sky;
  Tracer tracer;
  LightMap light_map;
  std::vector<Paint> paints;
};

/// `rays_each` divides kPacket: rays of a packet belong to neighbouring pixels, at as many moments of the
/// exposure.
std::vector<Sample> Renderer::Stage::Look(const Exposure& exposure, const std::vector<Pixel>& pixels,
                                          int rays_each) const {
  std::vector<Sample> samples(pixels.size() * rays_each);
  for (std::size_t begin = 0; begin < samples.size(); begin += kPacket) {
    RayPacket rays;
    for (std::size_t i = begin; i < std::min(samples.size(), begin + kPacket); ++i) {
      const Pixel& pixel = pixels[i / rays_each];
      const int k = static_cast<int>(i % rays_each);
      samples[i].id = (static_cast<std::uint64_t>(pixel.row) * 65536 + pixel.column) * kPacket + k;
      const auto chance = static_cast<float>(ToUnit(Mix(samples[i].id)));
      const float across = (static_cast<float>(k) + 0.5F) / static_cast<float>(rays_each);
      // Hammersley's points, k / n and the mirrored bits of k.
      const int bits = (k & 1) * 8 + (k & 2) * 2 + (k & 4) / 2 + (k & 8) / 8;
      const float down = (static_cast<float>(bits) + (rays_each == kPacket ? 0.5F : 2.0F)) / kPacket;
      const float moment =
          (static_cast<float>((k * 7 + 3) % rays_each) + chance) / static_cast<float>(rays_each);
      const auto& pose =
          exposure
              .path[std::min(exposure.path.size() - 1,
                             static_cast<std::size_t>(moment * static_cast<float>(exposure.path.size())))];
      const Eigen::Vector2f at = lens.LookAt(static_cast<float>(pixel.column) + across - 0.5F,
                                             static_cast<float>(pixel.row) + down - 0.5F);
      rays.origin_m[rays.count] = pose.translation_m.cast<float>();
      rays.direction[rays.count] =
          (pose.rotation * Eigen::Vector3d(at.x(), at.y(), 1.0)).normalized().cast<float>();
      ++rays.count;
    }
    const auto hits = tracer.Trace(rays);
    for (int i = 0; i < rays.count; ++i) {
      samples[begin + i].hit = hits[i];
      samples[begin + i].direction = rays.direction[i];
      samples[begin + i].point_m = rays.origin_m[i] + hits[i].distance_m * rays.direction[i];
    }
  }
  FindSunlit(samples, exposure.seed);
  return samples;
}

void Renderer::Stage::FindSunlit(std::vector<Sample>& samples, std::uint64_t seed) const {
  const Vector3f side = sky.toward_sun().cross(Vector3f::UnitX() + Vector3f::UnitY()).normalized();
  const Vector3f up = sky.toward_sun().cross(side);
  for (std::size_t begin = 0; begin < samples.size(); begin += kPacket) {
    RayPacket rays;
    std::array<std::size_t, kPacket> which{};
    for (std::size_t i = begin; i < std::min(samples.size(), begin + kPacket); ++i) {
      const Sample& sample = samples[i];
      if (sample.hit.body == RayHit::kSky || sample.hit.normal.dot(sky.toward_sun()) <= 0.0F) continue;
      const std::uint64_t bits = Mix(seed ^ Mix(sample.id));
      const auto radius = kSunRadius * static_cast<float>(std::sqrt(ToUnit(bits)));
      const auto angle = static_cast<float>(6.283185307 * ToUnit(Mix(bits)));
      const float lift_m = kLift * std::max(1.0F, sample.hit.distance_m);
      rays.origin_m[rays.count] = sample.point_m + lift_m * sample.hit.normal;
      rays.direction[rays.count] =
          (sky.toward_sun() + radius * (std::cos(angle) * side + std::sin(angle) * up)).normalized();
      which[rays.count++] = i;
    }
    if (rays.count == 0) continue;
    const auto blocked = tracer.IsBlocked(rays);
    for (int i = 0; i < rays.count; ++i) samples[which[i]].is_sunlit = !blocked[i];
  }
}

Light Renderer::Stage::Shade(const Patch& patch) const {
  const Sample& sample = patch.first;
  const auto share = 1.0F / static_cast<float>(patch.count);
  if (sample.hit.body == RayHit::kSky) return sky.LookInto(sample.direction);
  const Vector3f point_m = share * patch.point_sum, normal = patch.normal_sum.normalized();
  const float slant = std::max(0.08F, -normal.dot(sample.direction));
  const float footprint_m =
      sample.hit.distance_m / static_cast<float>(camera.intrinsics.fx_px) / std::sqrt(slant);
  const Paint& paint = sample.hit.body == RayHit::kGround ? ground : paints[sample.hit.body];
  const Light albedo = PaintAt(paint, point_m, normal, footprint_m);
  const Light lit = albedo.cwiseProduct(share * patch.sunlit * sky.sunlight() + share * patch.other_light);
  const float seen = std::exp(-sample.hit.distance_m / haze_m);
  return seen * lit + (1.0F - seen) * sky.haze();
}

Light Renderer::Stage::Combine(const Sample* samples, int count) const {
  std::array<Patch, kManyRays> patches;
  int patch_count = 0;
  for (int i = 0; i < count; ++i) {
    const Sample& sample = samples[i];
    int p = 0;
    while (p < patch_count && !IsSameThing(patches[p].first, sample, bodies)) ++p;
    if (p == patch_count) patches[patch_count++].first = sample;
    Patch& patch = patches[p];
    patch.point_sum += sample.point_m;
    patch.normal_sum += sample.hit.normal;
    if (sample.is_sunlit) patch.sunlit += sample.hit.normal.dot(sky.toward_sun());
    if (sample.hit.body != RayHit::kSky) patch.other_light += light_map.At(sample.hit, sample.point_m);
    ++patch.count;
  }
  Light sum = Light::Zero();
  for (int p = 0; p < patch_count; ++p) sum += static_cast<float>(patches[p].count) * Shade(patches[p]);
  return sum / static_cast<float>(count);
}

bool Renderer::Stage::IsEven(const Sample* samples, int count) const {
  return std::all_of(samples + 1, samples + count, [&](const Sample& sample) {
    return sample.is_sunlit == samples->is_sunlit && IsSameThing(*samples, sample, bodies);
  });
}

void Renderer::Stage::RenderRow(const Exposure& exposure, int row, cv::Mat3f& light) const {
  std::vector<Pixel> pixels(static_cast<std::size_t>(light.cols));
  for (int column = 0; column < light.cols; ++column) pixels[column] = {column, row};
  std::vector<Pixel> uneven;
  const auto put = [&](const Pixel& pixel, const Light& rgb) {
    light(pixel.row, pixel.column) = {rgb.z(), rgb.y(), rgb.x()};
  };
  const auto few = Look(exposure, pixels, kFewRays);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Sample* samples = &few[i * kFewRays];
    if (IsEven(samples, kFewRays))
      put(pixels[i], Combine(samples, kFewRays));
    else
      uneven.push_back(pixels[i]);
  }
  const auto many = Look(exposure, uneven, kManyRays);
  for (std::size_t i = 0; i < uneven.size(); ++i) put(uneven[i], Combine(&many[i * kManyRays], kManyRays));
}

Renderer::Renderer(const World& world, int threads) : stage_(std::make_unique<Stage>(world, threads)) {}
Renderer::~Renderer() = default;

cv::Mat3b Renderer::Render(const Exposure& exposure) const {
  SOFFIT_EXPECT(!exposure.path.empty());
  cv::Mat3f light(stage_->camera.intrinsics.height_px, stage_->camera.intrinsics.width_px);
  std::atomic<int> next_row = 0;
  const auto work = [&] {
    for (int row = next_row++; row < light.rows; row = next_row++) stage_->RenderRow(exposure, row, light);
  };
  std::vector<std::jthread> helpers;
  for (int i = 1; i < stage_->threads; ++i) helpers.emplace_back(work);
  work();
  helpers.clear();
  const Light white = 0.85F * (stage_->sky.sunlight() * std::max(0.3F, stage_->sky.toward_sun().z()) +
                               stage_->sky.skylight());
  return Develop(light, stage_->camera, 0.9 / white.maxCoeff(), exposure.seed);
}

}  // namespace soffit::sim
