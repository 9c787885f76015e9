#include "test/sim/render/lens.h"

#include <algorithm>
#include <cmath>

namespace soffit::sim {
namespace {

Eigen::Vector2d Distort(const std::array<double, 5>& d, const Eigen::Vector2d& p) {
  const double r2 = p.squaredNorm();
  const double radial = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  return {p.x() * radial + 2.0 * d[2] * p.x() * p.y() + d[3] * (r2 + 2.0 * p.x() * p.x()),
          p.y() * radial + d[2] * (r2 + 2.0 * p.y() * p.y()) + 2.0 * d[3] * p.x() * p.y()};
}

/// Fixed-point iteration from `start`: for lenses whose distortion grows slower than the radius.
Eigen::Vector2d Undistort(const std::array<double, 5>& d, const Eigen::Vector2d& distorted,
                          const Eigen::Vector2d& start) {
  constexpr int kMaxSteps = 50;
  Eigen::Vector2d p = start;
  for (int i = 0; i < kMaxSteps; ++i) {
    const Eigen::Vector2d step = distorted - Distort(d, p);
    p += step;
    if (step.squaredNorm() < 1e-20) break;
  }
  return p;
}

}  // namespace

Lens::Lens(const Intrinsics& intrinsics)
    : columns_(intrinsics.width_px + 2), rows_(intrinsics.height_px + 2) {
  table_.reserve(static_cast<std::size_t>(columns_) * rows_);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d distorted((column - 1 - intrinsics.cx_px) / intrinsics.fx_px,
                                      (row - 1 - intrinsics.cy_px) / intrinsics.fy_px);
      table_.push_back(Undistort(intrinsics.distortion, distorted, distorted).cast<float>());
    }
  }
}

Eigen::Vector2f Lens::LookAt(float u_px, float v_px) const {
  const int column = std::clamp(static_cast<int>(u_px + 1.0F), 0, columns_ - 2);
  const int row = std::clamp(static_cast<int>(v_px + 1.0F), 0, rows_ - 2);
  const float right = u_px + 1.0F - static_cast<float>(column), down = v_px + 1.0F - static_cast<float>(row);
  const Eigen::Vector2f* at = &table_[static_cast<std::size_t>(row) * columns_ + column];
  return (1.0F - down) * ((1.0F - right) * at[0] + right * at[1]) +
         down * ((1.0F - right) * at[columns_] + right * at[columns_ + 1]);
}

}  // namespace soffit::sim
