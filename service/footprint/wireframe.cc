#include "service/footprint/wireframe.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace soffit {
namespace {

using Eigen::Index;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Where the middle one of three corners is when the sides before and after it stand back.
Vector2d CornerOf(const Ring& three, double of_before_m, double of_next_m) {
  return InsetRing(three, {of_before_m, of_next_m, 0.0})[1];
}

/// Adds the corners of the outer ring at one level, or on the ground (level -1).
void AddOuter(const Massing& massing, const Layout& layout, int level, Wireframe& frame) {
  constexpr double kStep_m = 1e-5;
  const Ring& outer = massing.rings.front();
  const std::size_t n = outer.size();
  const auto l = static_cast<std::size_t>(std::max(0, level));
  const bool is_ground = level < 0;
  const std::vector<double> inset_m = is_ground ? std::vector<double>(n, 0.0) : massing.levels[l].inset_m;
  for (std::size_t i = 0; i < n; ++i) {
    const std::array<std::size_t, 3> places = {(i + n - 1) % n, i, (i + 1) % n};
    const Ring three = {outer[places[0]], outer[i], outer[places[2]]};
    const double of_before_m = inset_m[places[0]], of_next_m = inset_m[i];
    const Vector2d here = CornerOf(three, of_before_m, of_next_m);
    Wireframe::Corner corner;
    corner.in_map_m = {here.x(), here.y(), is_ground ? 0.0 : massing.levels[l].height_m};
    const auto add = [&](Index parameter, const Vector2d& there) {
      const Vector2d by = (there - here) / kStep_m;
      corner.by.emplace_back(parameter, Vector3d(by.x(), by.y(), 0.0));
    };
    for (std::size_t k = 0; k < 3; ++k) {
      if (k != 1 && of_before_m == 0.0 && of_next_m == 0.0) continue;  // Plumb: neighbours do not matter.
      for (const int axis : {0, 1}) {
        Ring moved = three;
        moved[k][axis] += kStep_m;
        add(static_cast<Index>(2 * places[k]) + axis, CornerOf(moved, of_before_m, of_next_m));
      }
    }
    if (!is_ground) {
      corner.by.emplace_back(layout.height[l], Vector3d::UnitZ());
      const Index before = layout.inset[l][places[0]], next = layout.inset[l][i];
      if (before >= 0) add(before, CornerOf(three, of_before_m + kStep_m, of_next_m));
      if (next >= 0) add(next, CornerOf(three, of_before_m, of_next_m + kStep_m));
    }
    frame.corners.push_back(std::move(corner));
  }
}

void AddCourtyards(const Massing& massing, const Layout& layout, int level, Wireframe& frame) {
  Index parameter = static_cast<Index>(2 * massing.rings.front().size());
  for (auto ring = massing.rings.begin() + 1; ring != massing.rings.end(); ++ring) {
    for (const Vector2d& p : *ring) {
      Wireframe::Corner corner{{p.x(), p.y(), 0.0},
                               {{parameter, Vector3d::UnitX()}, {parameter + 1, Vector3d::UnitY()}}};
      parameter += 2;
      if (level >= 0) {
        const auto l = static_cast<std::size_t>(level);
        corner.in_map_m.z() = massing.levels[l].height_m;
        corner.by.emplace_back(layout.height[l], Vector3d::UnitZ());
      }
      frame.corners.push_back(std::move(corner));
    }
  }
}

}  // namespace

Wireframe FrameOf(const Massing& massing) {
  const Layout layout(massing);
  Wireframe frame;
  std::size_t all = 0;
  for (const Ring& ring : massing.rings) all += ring.size();
  for (int level = -1; level < static_cast<int>(massing.levels.size()); ++level) {
    const auto l = static_cast<std::size_t>(std::max(0, level));
    const bool is_ledge = level > 0 && layout.height[l] == layout.height[l - 1];
    AddOuter(massing, layout, level, frame);
    AddCourtyards(massing, layout, level, frame);
    std::size_t at = frame.corners.size() - all;
    std::vector<std::vector<std::size_t>> lid;
    for (const Ring& ring : massing.rings) {
      const std::size_t n = ring.size();
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t here = at + i, next = at + (i + 1) % n;
        frame.edges.push_back({here, next});
        if (level < 0) continue;
        frame.faces.push_back({{here - all, next - all, next, here}});
        if (!is_ledge) frame.edges.push_back({here - all, here});
      }
      std::vector<std::size_t>& outline = lid.emplace_back(n);
      std::iota(outline.begin(), outline.end(), at);
      at += n;
    }
    frame.faces.push_back(std::move(lid));
  }
  return frame;
}

Cover::Cover(const Wireframe& frame, const View& view) {
  std::vector<std::optional<Vector2d>> pixels;
  for (const Wireframe::Corner& corner : frame.corners) pixels.push_back(Project(view, corner.in_map_m));
  for (const auto& rings : frame.faces) {
    Face face{Vector2d::Constant(1e18), Vector2d::Constant(-1e18), {}};
    bool is_in_front = true;
    for (const auto& ring : rings) {
      Ring& ring_px = face.rings_px.emplace_back();
      for (const std::size_t corner : ring) {
        is_in_front = is_in_front && pixels[corner].has_value();
        if (!is_in_front) break;
        ring_px.push_back(*pixels[corner]);
        face.low = face.low.cwiseMin(ring_px.back());
        face.high = face.high.cwiseMax(ring_px.back());
      }
    }
    if (is_in_front) faces_.push_back(std::move(face));
  }
}

bool Cover::Contains(const Vector2d& pixel) const {
  return std::any_of(faces_.begin(), faces_.end(), [&](const Face& face) {
    if ((pixel.array() < face.low.array()).any() || (pixel.array() > face.high.array()).any()) return false;
    bool is_inside = false;
    for (const Ring& ring : face.rings_px) is_inside = is_inside != soffit::Contains(ring, pixel);
    return is_inside;
  });
}

}  // namespace soffit
