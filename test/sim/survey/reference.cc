#include "test/sim/survey/reference.h"

#include <algorithm>
#include <cmath>

#include "test/sim/truth/truth.h"

namespace soffit::sim {
namespace {

/// The wanted footprints in pixels, y down, lowest corner at the origin.
std::vector<Polygon> PlaceInPicture(const World& world) {
  const Eigen::Rotation2Dd turn(world.mission.reference_rotation_cw_rad);  // Back, counter-clockwise.
  std::vector<Polygon> shapes;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9);
  const auto place = [&](Ring& ring) {
    for (Eigen::Vector2d& corner : ring) {
      const Eigen::Vector2d turned = turn * corner / world.mission.reference_m_per_px;
      corner = {turned.x(), -turned.y()};
      low = low.cwiseMin(corner);
    }
  };
  for (const Structure& building : world.buildings) {
    const auto& wanted = world.mission.wanted;
    if (std::find(wanted.begin(), wanted.end(), building.id) == wanted.end()) continue;
    for (Polygon& polygon : FindFootprint(building)) {
      place(polygon.outer);
      for (Ring& hole : polygon.holes) place(hole);
      shapes.push_back(polygon);
    }
  }
  for (Polygon& polygon : shapes) {
    for (Eigen::Vector2d& corner : polygon.outer) corner -= low;
    for (Ring& hole : polygon.holes) {
      for (Eigen::Vector2d& corner : hole) corner -= low;
    }
  }
  return shapes;
}

}  // namespace

cv::Mat1b DrawReference(const World& world) {
  constexpr int kBorder_px = 20;
  const std::vector<Polygon> shapes = PlaceInPicture(world);
  Eigen::Vector2d high = Eigen::Vector2d::Zero();
  for (const Polygon& polygon : shapes) {
    for (const Eigen::Vector2d& corner : polygon.outer) high = high.cwiseMax(corner);
  }
  cv::Mat1b picture(static_cast<int>(std::ceil(high.y())) + 2 * kBorder_px,
                    static_cast<int>(std::ceil(high.x())) + 2 * kBorder_px, std::uint8_t{255});
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.cols; ++column) {
      const Eigen::Vector2d at(column - kBorder_px, row - kBorder_px);
      const bool is_inside = std::any_of(shapes.begin(), shapes.end(),
                                         [&](const Polygon& shape) { return Contains(shape, at); });
      if (is_inside) picture(row, column) = 0;
    }
  }
  return picture;
}

}  // namespace soffit::sim
