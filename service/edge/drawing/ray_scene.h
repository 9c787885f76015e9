#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "service/solid/solid.h"

namespace soffit {

/// Coloured things that rays can be cast at (Embree). Colours are BGR, 0 to 1.
class RayScene {
 public:
  RayScene();
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  void AddMesh(const Mesh& mesh, const cv::Vec3f& color);
  void AddBox(const Eigen::Vector3d& center, double edge_m, const cv::Vec3f& color);
  void AddTube(const std::vector<Eigen::Vector3d>& line, double radius_m, const cv::Vec3f& color);
  void Commit();  ///< Before the first ray, after the last thing.

  struct Hit {
    double distance_m = 0.0;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< Unit, towards where the ray came from.
    cv::Vec3f color;
  };
  std::optional<Hit> Cast(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const;
  bool IsBlocked(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double distance_m) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
  std::vector<cv::Vec3f> colors_;  ///< By Embree's geometry id.
};

}  // namespace soffit
