#include "test/sim/render/texture.h"

#include <algorithm>
#include <cmath>

#include "test/sim/world/noise.h"

namespace soffit::sim {
namespace {

/// How many octaves of a pattern of size `grain_m` a pixel can show.
float Octaves(float grain_m, float footprint_m, float most) {
  return std::clamp(std::log2(grain_m / std::max(footprint_m, 1e-6F)), 0.0F, most);
}

/// Share of a pixel that a line covers which repeats every `period_m` and is `width_m` wide.
float LineCover(float at_m, float period_m, float width_m, float footprint_m) {
  const float away_m = std::abs(at_m - period_m * std::round(at_m / period_m));
  const float half = 0.5F * footprint_m;
  const float cover_m = std::min(away_m + half, 0.5F * width_m) - std::max(away_m - half, -0.5F * width_m);
  return std::clamp(cover_m / std::max(footprint_m, 1e-6F), 0.0F, 1.0F);
}

/// Coordinates on the surface: along the seams and across (up, on a wall).
Eigen::Vector2f OnSurface(const Paint& paint, const Eigen::Vector3f& p, const Eigen::Vector3f& normal) {
  const Eigen::Vector2f turned(paint.along_x * p.x() + paint.along_y * p.y(),
                               paint.along_x * p.y() - paint.along_y * p.x());
  if (std::abs(normal.z()) > 0.7F) return turned;
  const Eigen::Vector2f right = Eigen::Vector2f(-normal.y(), normal.x()).normalized();
  return {right.dot(p.head<2>()), p.z()};
}

float Mottle(const Paint& paint, const Eigen::Vector3f& p, float footprint_m) {
  return FractalNoise(p / paint.grain_m, Octaves(paint.grain_m, footprint_m, 5.0F));
}

float Bricks(const Paint& paint, const Eigen::Vector2f& at, float footprint_m) {
  const float length_m = paint.grain_m, height_m = paint.grain_m / 3.0F;
  const float course = std::floor(at.y() / height_m);
  const float shifted_m = at.x() + (static_cast<int>(course) % 2 == 0 ? 0.0F : 0.5F * length_m);
  const float mortar = std::max(LineCover(at.y(), height_m, 0.12F * height_m, footprint_m),
                                LineCover(shifted_m, length_m, 0.04F * length_m, footprint_m));
  const float brick = Noise({std::floor(shifted_m / length_m) + 0.5F, course + 0.5F, 0.5F});
  const float visible = std::clamp(0.5F * height_m / std::max(footprint_m, 1e-6F), 0.0F, 1.0F);
  return visible * brick - 1.2F * mortar;
}

float Joints(const Paint& paint, float at_m, float period_m, float footprint_m) {
  return LineCover(at_m, period_m, 0.008F + 0.002F * paint.grain_m, footprint_m);
}

}  // namespace

Paint Mix(const Finish& finish, double yaw_rad) {
  return {ToLinear(finish.color_srgb),           finish.pattern,
          static_cast<float>(finish.grain_m),    static_cast<float>(finish.contrast),
          static_cast<float>(std::cos(yaw_rad)), static_cast<float>(std::sin(yaw_rad))};
}

Light PaintAt(const Paint& paint, const Eigen::Vector3f& p, const Eigen::Vector3f& normal,
              float footprint_m) {
  constexpr float kDarkest = 0.15F;
  float shade = 1.0F;
  switch (paint.pattern) {
    case Pattern::kPlain:
      break;
    case Pattern::kMottled:
      shade += paint.contrast * Mottle(paint, p, footprint_m);
      break;
    case Pattern::kPanels:
      shade +=
          0.3F * paint.contrast * Mottle(paint, p, footprint_m) -
          3.0F * paint.contrast * Joints(paint, OnSurface(paint, p, normal).x(), paint.grain_m, footprint_m);
      break;
    case Pattern::kBricks:
      shade += paint.contrast * Bricks(paint, OnSurface(paint, p, normal), footprint_m);
      break;
    case Pattern::kSlabs: {
      const Eigen::Vector2f at = OnSurface(paint, p, normal);
      shade += paint.contrast * (Mottle(paint, p, footprint_m) +
                                 0.4F * FractalNoise(20.0F / paint.grain_m * p,
                                                     Octaves(0.05F * paint.grain_m, footprint_m, 3.0F))) -
               0.5F * std::max(Joints(paint, at.x(), paint.grain_m, footprint_m),
                               Joints(paint, at.y(), 3.0F * paint.grain_m, footprint_m));
      break;
    }
    case Pattern::kGrass: {
      const float large = Mottle(paint, p, footprint_m);
      const float fine =
          FractalNoise(12.0F / paint.grain_m * p, Octaves(paint.grain_m / 12.0F, footprint_m, 3.0F));
      shade += paint.contrast * (large + 1.3F * fine);
      const float dry = 0.5F * paint.contrast * large;  // Dry patches are more yellow.
      return std::max(shade, kDarkest) *
             paint.color.cwiseProduct(Light(1.0F + dry, 1.0F + 0.4F * dry, 1.0F - dry));
    }
  }
  return std::min(std::max(shade, kDarkest) * paint.color.maxCoeff(), 0.95F) /
         std::max(paint.color.maxCoeff(), 1e-6F) * paint.color;
}

}  // namespace soffit::sim
