#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "service/facade/facade.h"
#include "service/scene/prediction.h"
#include "service/scene/scene.h"

namespace soffit {

/// How far one picture proves the ray of each of its pixels to be free.
class FreeRays {
 public:
  FreeRays(const Sight& sight, const Prediction& prediction);

  /// Whether every ray through the ball goes on free beyond it.
  bool SeesThrough(const Eigen::Vector3d& center_in_map_m, double radius_m) const;

  /// What the picture shows standing on the ground where the model has nothing.
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }
  const cv::Mat1b& fails() const { return fails_; }
  std::uint32_t capture_id() const { return capture_id_; }

 private:
  void Compare(const Sight& sight, const Prediction& prediction);
  void PlaceUnpredicted(const Sight& sight, const Prediction& prediction);

  std::uint32_t capture_id_ = 0;
  View view_;
  Pose<Camera, Map> camera_from_map_;
  cv::Mat1b fails_;       ///< 1: the pixel proves nothing.
  cv::Mat1b near_edge_;   ///< Where a predicted edge is so close that a misfit of the model explains a contradiction.
  cv::Mat1f reach_m_;     ///< Free depth, the least within the edge tolerance.
  cv::Mat1i fail_sum_;    ///< Integral picture of `fails_`.
  std::vector<Obstacle> obstacles_;
};

}  // namespace soffit
