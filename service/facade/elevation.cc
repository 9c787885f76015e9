#include "service/facade/elevation.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace soffit {
namespace {

constexpr double kMinFront_m = 0.05;
constexpr double kMinCosine = 0.34;  // 70 degrees off the wall's normal: foreshortened to a third.
constexpr double kCellPerPixel = 0.5;
constexpr int kMaxCells = 4000;  // Of one side of the raster.
constexpr double kOffWall_m = 1e-3;
constexpr double kRoofSearch = 1.6;  // Times the height that is expected.
constexpr double kFallbackHeight_m = 12.0;
constexpr double kEndSigmas = 3.0;  // Of the pose: so far from where a wall ends it is not looked at.

/// The columns that the wall has in each row. A prism is as wide above its roof.
std::vector<cv::Range> SpansOf(const Footprint& building, int side, const Elevation& view) {
  std::vector<cv::Range> spans(static_cast<std::size_t>(view.seen.rows), cv::Range(0, view.seen.cols));
  if (building.levels.empty()) return spans;
  const double margin_m = 2.0 * view.cell_m + kEndSigmas * view.pose_std_m;
  for (int row = 0; row < view.seen.rows; ++row) {
    const double v = view.Center(0, row).y();
    const auto span = SpanAt(building, side, v);
    const bool is_end = !span || !SpanAt(building, side, v + margin_m);
    const auto column = [&](double u) { return std::clamp(view.Column(u), 0, view.seen.cols); };
    const double low = span ? span->x() : 0.0, high = span ? span->y() : 0.0, width = view.wall.width_m;
    spans[static_cast<std::size_t>(row)] =
        is_end ? cv::Range(0, 0)
               : cv::Range(low > 0.0 ? column(low + margin_m) : 0,
                           high < width - margin_m ? column(high - margin_m) : view.seen.cols);
  }
  return spans;
}

}  // namespace

std::optional<Elevation> Rectify(const Footprint& building, int side, int own_class, const Image& image,
                                 const Mask& mask, const Sight& sight, double resolution_m) {
  const Ring& outer = building.polygon_in_map_m.outer;
  const double height_m = building.height_m;
  Elevation view;
  view.wall = WallOf(building, side);
  view.capture_id = sight.capture_id;
  const Eigen::Vector3d camera = sight.view.map_from_camera.translation_m;
  const Eigen::Vector2d camera_plan = camera.head<2>();
  view.camera_front_m = view.wall.Front(camera_plan);
  view.camera_uv_m = {view.wall.U(camera_plan), camera.z()};
  if (!(view.camera_front_m > kMinFront_m)) return std::nullopt;
  const Eigen::Vector2d middle = view.wall.InPlan(0.5 * view.wall.width_m);
  const double distance = (camera_plan - middle).norm();
  const double cosine = view.camera_front_m / distance;
  if (!(cosine >= kMinCosine)) return std::nullopt;

  const double up_to_m = kRoofSearch * (height_m > 0.0 ? height_m : kFallbackHeight_m);
  const Intrinsics& k = sight.view.intrinsics;
  view.pixel_m = view.camera_front_m / k.fx_px;
  view.cell_m = std::max(
      {resolution_m, kCellPerPixel * view.pixel_m, view.wall.width_m / kMaxCells, up_to_m / kMaxCells});
  view.pose_std_m = std::hypot(sight.view.position_std_m, distance * sight.view.orientation_std_rad);
  const int columns = static_cast<int>(view.wall.width_m / view.cell_m);
  const int rows = static_cast<int>(up_to_m / view.cell_m);
  if (columns < 4 || rows < 4) return std::nullopt;

  view.seen = cv::Mat1b(rows, columns, static_cast<uchar>(Seen::kUnexplained));
  view.bgr = cv::Mat3b(rows, columns, cv::Vec3b(0, 0, 0));
  view.is_visible = cv::Mat1b(rows, columns, uchar{0});
  const std::vector<cv::Range> spans = SpansOf(building, side, view);
  int visible_columns = 0;
  for (int column = 0; column < columns; ++column) {
    const Eigen::Vector2d plan =
        view.wall.InPlan(view.Center(column, 0).x()) + kOffWall_m * view.wall.outward;
    if (Crosses(outer, camera_plan, plan)) continue;
    bool is_whole = true;  // From the foot to where the wall ends.
    for (int row = 0; row < rows; ++row) {
      if (column < spans[static_cast<std::size_t>(row)].start ||
          column >= spans[static_cast<std::size_t>(row)].end)
        continue;
      const auto pixel = Project(sight.view, view.wall.InMap(view.Center(column, row)));
      const cv::Point at = pixel ? cv::Point(static_cast<int>(std::lround(pixel->x())),
                                             static_cast<int>(std::lround(pixel->y())))
                                 : cv::Point(-1, -1);
      if (!image.seen.contains(at) || at.x >= sight.seen.cols || at.y >= sight.seen.rows) {
        is_whole = is_whole && view.Row(height_m) < row;
        continue;
      }
      const int label = mask.label(at);
      uchar seen = sight.seen(at);
      if (seen == static_cast<uchar>(Seen::kStructure) && label != 0 && label != own_class) {
        seen = static_cast<uchar>(Seen::kUnexplained);
      }
      view.seen(row, column) = seen;
      view.bgr(row, column) = sight.bgr(at);
      view.is_visible(row, column) = 1;
    }
    if (is_whole) ++visible_columns;
  }
  view.visible_ratio = static_cast<double>(visible_columns) / columns;
  view.quality = view.visible_ratio * cosine / (1.0 + distance / std::max(view.wall.width_m, up_to_m));
  if (visible_columns == 0) return std::nullopt;
  return view;
}

}  // namespace soffit
