#include "service/scene/clutter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

constexpr double kDownward = -0.9;  // Of the optical axis' rise.

}  // namespace

std::vector<Obstacle> FindClutter(const Sight& sight, const Prediction& prediction) {
  const Pose<Map, Camera>& pose = sight.view.map_from_camera;
  if (!((pose.rotation * Eigen::Vector3d::UnitZ()).z() < kDownward)) return {};
  cv::Mat1b is_strange(sight.seen.size(), uchar{0});
  for (int y = sight.shown.y; y < sight.shown.br().y; ++y) {
    for (int x = sight.shown.x; x < sight.shown.br().x; ++x) {
      const bool is_strange_here = sight.seen(y, x) == static_cast<uchar>(Seen::kUnexplained) &&
                                   prediction.label(y, x) == static_cast<uchar>(Seen::kGround);
      is_strange(y, x) = is_strange_here ? 255 : 0;
    }
  }
  const double metre_px = sight.view.intrinsics.fx_px / std::max(0.1, pose.translation_m.z());
  const int thinnest_px = std::max(2, static_cast<int>(std::lround(kThinnest_m * metre_px)));
  cv::morphologyEx(is_strange, is_strange, cv::MORPH_OPEN,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(thinnest_px, thinnest_px)));
  cv::Mat1i component;
  cv::Mat stats, centers;
  const int count = cv::connectedComponentsWithStats(is_strange, component, stats, centers, 8, CV_32S);
  std::vector<Obstacle> clutter;
  for (int i = 1; i < count; ++i) {
    const Eigen::Vector2d low(stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP));
    const Eigen::Vector2d size(stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT));
    const auto place = MeetHorizontalPlane(sight.view, low + 0.5 * size, 0.0);
    const auto corner = MeetHorizontalPlane(sight.view, low, 0.0);
    if (!place || !corner) continue;
    Obstacle thing;
    thing.base_in_map_m = {place->x(), place->y(), 0.0};
    thing.radius_m = (*corner - *place).norm();
    thing.std_m = sight.view.position_std_m + pose.translation_m.z() * sight.view.orientation_std_rad;
    thing.captures = {sight.capture_id};
    clutter.push_back(std::move(thing));
  }
  return clutter;
}

}  // namespace soffit
