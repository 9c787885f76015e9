#include "service/scene/clutter.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

constexpr double kDownward = -0.9;  // Of the optical axis' rise.
constexpr double kBeside_m = 0.15;  // From a building, seen or modelled: its edges are known no better.
constexpr double kPoseSigmas = 3.0;

}  // namespace

std::vector<Obstacle> FindClutter(const Sight& sight, const Prediction& prediction) {
  const Pose<Map, Camera>& pose = sight.view.map_from_camera;
  if (!((pose.rotation * Eigen::Vector3d::UnitZ()).z() < kDownward)) return {};
  cv::Mat1b is_strange(sight.seen.size(), uchar{0});
  cv::Mat1b is_building(sight.seen.size(), uchar{0});
  for (int y = sight.shown.y; y < sight.shown.br().y; ++y) {
    for (int x = sight.shown.x; x < sight.shown.br().x; ++x) {
      const bool is_predicted = prediction.label(y, x) == static_cast<uchar>(Seen::kStructure);
      is_building(y, x) = is_predicted || sight.seen(y, x) == static_cast<uchar>(Seen::kStructure) ? 255 : 0;
      is_strange(y, x) =
          sight.seen(y, x) == static_cast<uchar>(Seen::kUnexplained) && !is_predicted ? 255 : 0;
    }
  }
  const double metre_px = sight.view.intrinsics.fx_px / std::max(0.1, pose.translation_m.z());
  const double std_m = sight.view.position_std_m + pose.translation_m.z() * sight.view.orientation_std_rad;
  const auto disc = [&](double radius_m) {
    const int most_px = std::max(sight.seen.cols, sight.seen.rows);
    const int radius_px = static_cast<int>(std::clamp(std::round(radius_m * metre_px), 1.0, 1.0 * most_px));
    return cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * radius_px + 1, 2 * radius_px + 1));
  };
  cv::dilate(is_building, is_building, disc(kBeside_m + kPoseSigmas * std_m));
  is_strange.setTo(0, is_building);
  cv::morphologyEx(is_strange, is_strange, cv::MORPH_OPEN, disc(0.5 * kThinnest_m + kPoseSigmas * std_m));
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
    thing.std_m = std_m;
    thing.captures = {sight.capture_id};
    clutter.push_back(std::move(thing));
  }
  return clutter;
}

}  // namespace soffit
