#include "service/scene/evidence.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace soffit {
namespace {

constexpr int kEdge_px = 2;           // How far a predicted edge and a seen one may lie apart.
constexpr int kHorizon_px = 6;        // Ground fades into sky.
constexpr int kMisfit_px = 6;         // Contradictions that stay so close to a predicted edge are no obstacles.
constexpr int kMinUnpredicted_px = 20;
constexpr double kFlatHeight = 0.06;  // Of the camera's height: what is lower and no wider than below is a speck of the
constexpr double kFlatWidth = 0.30;   // ground. What is low and wide may be a cable before the ground.
constexpr double kStandOff = 0.97;    // A thing reaches towards the camera from its foot: share of the depth that is free.
constexpr double kPixelStd = 1.0;

cv::Mat Square(int reach) { return cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * reach + 1, 2 * reach + 1)); }

cv::Mat1b Only(const cv::Mat1b& labels, Seen wanted) {
  cv::Mat1b mask;
  cv::compare(labels, static_cast<double>(wanted), mask, cv::CMP_EQ);
  return mask;
}

cv::Mat1b Both(const cv::Mat1b& a, const cv::Mat1b& b) {
  cv::Mat1b both;
  cv::bitwise_and(a, b, both);
  return both;
}

cv::Mat1b Either(const cv::Mat1b& a, const cv::Mat1b& b) {
  cv::Mat1b either;
  cv::bitwise_or(a, b, either);
  return either;
}

cv::Mat1b Grow(const cv::Mat1b& mask, int reach) {
  cv::Mat1b grown;
  cv::dilate(mask, grown, Square(reach));
  return grown;
}

/// What lies no farther than `reach` from the mask's boundary, on either side.
cv::Mat1b Border(const cv::Mat1b& mask, int reach) {
  cv::Mat1b grown, shrunk, border;
  cv::dilate(mask, grown, Square(reach));
  cv::erode(mask, shrunk, Square(reach));
  cv::subtract(grown, shrunk, border);
  return border;
}

}  // namespace

FreeRays::FreeRays(const Sight& sight, const Prediction& prediction)
    : capture_id_(sight.capture_id), view_(sight.view), camera_from_map_(sight.view.map_from_camera.Inverse()) {
  SOFFIT_EXPECT(sight.seen.size() == prediction.label.size());
  Compare(sight, prediction);
  PlaceUnpredicted(sight, prediction);
  cv::Mat1f least;
  cv::erode(reach_m_, least, Square(kEdge_px));
  reach_m_ = least;
  cv::integral(fails_, fail_sum_, CV_32S);
}

void FreeRays::Compare(const Sight& sight, const Prediction& prediction) {
  const cv::Mat1b structure = Only(prediction.label, Seen::kStructure);
  const cv::Mat1b ground = Only(prediction.label, Seen::kGround);
  const cv::Mat1b sky = Only(prediction.label, Seen::kSky);
  const cv::Mat1b edge = Either(Border(structure, kEdge_px), Both(Grow(ground, kEdge_px), Grow(sky, kEdge_px)));
  const cv::Mat1b horizon = Both(Grow(ground, kHorizon_px), Grow(sky, kHorizon_px));
  const cv::Mat1b seen_ground = Only(sight.seen, Seen::kGround);
  const cv::Mat1b seen_sky = Only(sight.seen, Seen::kSky);
  cv::Mat1b agrees = Both(Only(sight.seen, Seen::kStructure), Grow(structure, kEdge_px));
  agrees = Either(agrees, Both(seen_ground, Either(Grow(ground, kEdge_px), horizon)));
  agrees = Either(agrees, Both(seen_sky, Either(Grow(sky, kEdge_px), horizon)));
  agrees = Either(agrees, Both(Only(sight.seen, Seen::kUnexplained), edge));  // Mixed pixels.
  near_edge_ = Border(structure, kMisfit_px);
  cv::threshold(agrees, fails_, 0.0, 1.0, cv::THRESH_BINARY_INV);
  reach_m_ = prediction.depth_m.clone();
}

/// Finds the foot of each connected thing that was not predicted, and lets its rays be free up to there.
void FreeRays::PlaceUnpredicted(const Sight& sight, const Prediction& prediction) {
  cv::Mat1i component;
  cv::Mat stats, centers;
  const int count = cv::connectedComponentsWithStats(fails_, component, stats, centers, 8, CV_32S);
  if (count <= 1) return;
  const cv::Mat1b beside_structure =
      Grow(Both(Only(sight.seen, Seen::kStructure), Only(prediction.label, Seen::kStructure)), kEdge_px + 1);
  struct Thing {
    int foot_y = -1;
    double foot_x_sum = 0.0;
    int foot_count = 0;
    float hidden_m = std::numeric_limits<float>::infinity();  ///< Nearest predicted depth that it hides.
    bool may_hang = false;
    bool is_misfit = true;  ///< All of it lies beside a predicted edge.
  };
  std::vector<Thing> things(static_cast<std::size_t>(count));
  for (int y = 0; y < component.rows; ++y) {
    for (int x = 0; x < component.cols; ++x) {
      if (component(y, x) == 0) continue;
      Thing& thing = things[static_cast<std::size_t>(component(y, x))];
      if (y > thing.foot_y) thing = {y, 0.0, 0, thing.hidden_m, thing.may_hang, thing.is_misfit};
      thing.foot_x_sum += x;
      ++thing.foot_count;
      const bool on_structure = prediction.label(y, x) == static_cast<uchar>(Seen::kStructure);
      if (on_structure) thing.hidden_m = std::min(thing.hidden_m, prediction.depth_m(y, x));
      if (near_edge_(y, x) == 0) thing.is_misfit = false;
      if (!on_structure && beside_structure(y, x) != 0) thing.may_hang = true;
      if (y == 0 || x == 0 || y + 1 == component.rows || x + 1 == component.cols) thing.may_hang = true;
    }
  }
  const Intrinsics& k = view_.intrinsics;
  std::vector<float> reach(things.size(), 0.0F);
  for (int i = 1; i < count; ++i) {
    Thing& thing = things[static_cast<std::size_t>(i)];
    if (thing.is_misfit) continue;
    const Eigen::Vector2d foot(thing.foot_x_sum / thing.foot_count, thing.foot_y);
    auto base = MeetHorizontalPlane(view_, foot, 0.0);
    if (!base) base = MeetHorizontalPlane(view_, foot + Eigen::Vector2d(0.0, kHorizon_px), 0.0);
    if (!base) continue;
    const Eigen::Vector3d in_camera = (camera_from_map_ * Point<Map>{{base->x(), base->y(), 0.0}}).xyz_m;
    const double camera_height = view_.map_from_camera.translation_m.z();
    const double width_m = stats.at<int>(i, cv::CC_STAT_WIDTH) * in_camera.z() / k.fx_px;
    const double height_m = stats.at<int>(i, cv::CC_STAT_HEIGHT) * in_camera.z() / k.fy_px;
    const bool stands_before_all = in_camera.z() <= 1.02 * thing.hidden_m;
    if (!stands_before_all) continue;
    if (height_m <= kFlatHeight * camera_height && width_m <= kFlatWidth * camera_height && !thing.may_hang) {
      reach[static_cast<std::size_t>(i)] = std::numeric_limits<float>::infinity();
      continue;
    }
    if (stats.at<int>(i, cv::CC_STAT_AREA) < kMinUnpredicted_px) continue;
    // A thing in front of a structure that reaches down to the ground before it stands there, whatever else it touches.
    const bool hides_structure = std::isfinite(thing.hidden_m);
    if (thing.may_hang && !hides_structure) continue;
    reach[static_cast<std::size_t>(i)] = static_cast<float>(kStandOff * in_camera.z());
    Obstacle obstacle;
    obstacle.base_in_map_m = {base->x(), base->y(), 0.0};
    obstacle.radius_m = 0.5 * width_m;
    obstacle.height_m = height_m;
    obstacle.std_m = std::hypot(view_.position_std_m, in_camera.z() * in_camera.z() / camera_height *
                                                          std::hypot(kPixelStd / k.fy_px, view_.orientation_std_rad));
    obstacle.captures = {capture_id_};
    obstacles_.push_back(std::move(obstacle));
  }
  for (int y = 0; y < component.rows; ++y) {
    for (int x = 0; x < component.cols; ++x) {
      const float free_m = reach[static_cast<std::size_t>(component(y, x))];
      if (component(y, x) == 0 || free_m == 0.0F) continue;
      fails_(y, x) = 0;
      reach_m_(y, x) = std::min(reach_m_(y, x), free_m);
    }
  }
}

bool FreeRays::SeesThrough(const Eigen::Vector3d& center_in_map_m, double radius_m) const {
  const Eigen::Vector3d p = (camera_from_map_ * Point<Map>{center_in_map_m}).xyz_m;
  if (p.z() <= 2.0 * radius_m) return false;
  const Intrinsics& k = view_.intrinsics;
  const double x = k.fx_px * p.x() / p.z() + k.cx_px;
  const double y = k.fy_px * p.y() / p.z() + k.cy_px;
  const double half_x = k.fx_px * radius_m / (p.z() - radius_m);
  const double half_y = k.fy_px * radius_m / (p.z() - radius_m);
  if (!(x - half_x >= 0.0 && y - half_y >= 0.0 && x + half_x <= fails_.cols - 1 && y + half_y <= fails_.rows - 1)) {
    return false;
  }
  const int x0 = static_cast<int>(std::floor(x - half_x)), x1 = static_cast<int>(std::ceil(x + half_x));
  const int y0 = static_cast<int>(std::floor(y - half_y)), y1 = static_cast<int>(std::ceil(y + half_y));
  const int failed =
      fail_sum_(y1 + 1, x1 + 1) - fail_sum_(y0, x1 + 1) - fail_sum_(y1 + 1, x0) + fail_sum_(y0, x0);
  if (failed > 0) return false;
  const float beyond = static_cast<float>(p.z() - 0.5 * radius_m);
  for (const int row : {y0, (y0 + y1) / 2, y1}) {
    for (const int column : {x0, (x0 + x1) / 2, x1}) {
      if (reach_m_(row, column) < beyond) return false;
    }
  }
  return true;
}

}  // namespace soffit
