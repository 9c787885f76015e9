#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "service/facade/facade.h"
#include "service/facade/wall.h"

namespace soffit {

/// One wall as one picture shows it, rectified: column i, row j is the cell at u = (i + 0.5) cell, v = (j +
/// 0.5) cell. Rows reach above the roof.
struct Elevation {
  Wall wall;
  std::uint32_t capture_id = 0;
  double cell_m = 0.0;
  double pixel_m = 0.0;  ///< Of the picture, on the wall where it is nearest.
  Eigen::Vector2d camera_uv_m = Eigen::Vector2d::Zero();  ///< Foot of the camera on the wall's plane.
  double camera_front_m = 0.0;                            ///< Distance of the camera from that plane, > 0.
  double pose_std_m = 0.0;     ///< What the pose's uncertainty amounts to on the wall.
  cv::Mat1b seen;              ///< `Seen`; structure of another colour class is kUnexplained.
  cv::Mat3b bgr;               ///< Black where it is not visible.
  cv::Mat1b is_visible;        ///< 0 where the cell lies outside the picture or behind the building itself.
  double visible_ratio = 0.0;  ///< Share of the columns that are visible from the wall's foot to its height.
  double quality = 0.0;        ///< For the choice between pictures: visible, square on and close is best.

  int Column(double u_m) const { return static_cast<int>(u_m / cell_m); }
  int Row(double v_m) const { return static_cast<int>(v_m / cell_m); }
  Eigen::Vector2d Center(int column, int row) const {
    return {(column + 0.5) * cell_m, (row + 0.5) * cell_m};
  }
};

/// None when the picture does not show the wall's outer face. Where the wall ends as the building's levels
/// have it, nothing is visible.
std::optional<Elevation> Rectify(const Footprint& building, int side, int own_class, const Image& image,
                                 const Mask& mask, const Sight& sight, double resolution_m);

}  // namespace soffit
