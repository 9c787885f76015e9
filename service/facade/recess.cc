#include "service/facade/recess.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "service/facade/median.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr int kDepths = 400;             // That are tried.
constexpr int kSamples = 48;             // Along an edge.
constexpr double kEnds = 0.12;           // Of an edge's length: its ends are other edges.
constexpr double kBeside_px = 2.5;       // From an edge to where its sides are looked at.
constexpr double kLeastShift_px = 14.0;  // Of the back wall's edges from the mouth's, which are edges too.
constexpr double kEdgeRatio = 3.0;       // Of an edge's contrast, to that of most depths.
constexpr double kLeastEdges = 2.0;      // That are just clear, or one that is much clearer.

/// From one corner of the mouth to the next: an edge of the back wall, when moved inward.
using Edge = std::array<Eigen::Vector2d, 2>;

/// The sides of an outline that stand upright or lie level; a round head has no such edge.
std::vector<Edge> EdgesOf(const Ring& mouth) {
  std::vector<Edge> edges;
  double longest = 0.0;
  for (std::size_t i = 0; i < mouth.size(); ++i)
    longest = std::max(longest, (mouth[(i + 1) % mouth.size()] - mouth[i]).norm());
  for (std::size_t i = 0; i < mouth.size(); ++i) {
    const Edge edge = {mouth[i], mouth[(i + 1) % mouth.size()]};
    const Eigen::Vector2d way = (edge[1] - edge[0]).cwiseAbs();
    if (way.norm() > 0.25 * longest && way.minCoeff() < 0.05 * way.maxCoeff()) edges.push_back(edge);
  }
  return edges;
}

/// Bilinear; none at the picture's margin.
std::optional<double> Brightness(const cv::Mat3b& bgr, const Eigen::Vector2d& at) {
  const int x = static_cast<int>(std::floor(at.x())), y = static_cast<int>(std::floor(at.y()));
  if (x < 0 || y < 0 || x + 1 >= bgr.cols || y + 1 >= bgr.rows) return std::nullopt;
  const auto grey = [&](int row, int column) {
    const cv::Vec3b& p = bgr(row, column);
    return (p[0] + p[1] + p[2]) / 3.0;
  };
  const double fx = at.x() - x, fy = at.y() - y;
  return (1 - fy) * ((1 - fx) * grey(y, x) + fx * grey(y, x + 1)) +
         fy * ((1 - fx) * grey(y + 1, x) + fx * grey(y + 1, x + 1));
}

Eigen::Vector3d Behind(const Wall& wall, const Eigen::Vector2d& uv_m, double depth_m) {
  Eigen::Vector3d point = wall.InMap(uv_m);
  point.head<2>() -= depth_m * wall.outward;
  return point;
}

/// Mean difference of brightness across the edge at this depth; 0 where the picture does not show it.
double Contrast(const Sight& sight, const Wall& wall, const Edge& edge, double depth_m) {
  const auto from = Project(sight.view, Behind(wall, edge[0], depth_m));
  const auto to = Project(sight.view, Behind(wall, edge[1], depth_m));
  if (!from || !to || (*to - *from).norm() < 4.0 * kBeside_px) return 0.0;
  const Eigen::Vector2d way = *to - *from;
  const Eigen::Vector2d across = kBeside_px * Eigen::Vector2d(-way.y(), way.x()).normalized();
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double share = kEnds + (1.0 - 2.0 * kEnds) * (i + 0.5) / kSamples;
    const auto one = Brightness(sight.bgr, *from + share * way + across);
    const auto other = Brightness(sight.bgr, *from + share * way - across);
    if (!one || !other) continue;
    sum += *one - *other;
    ++count;
  }
  return count < kSamples / 2 ? 0.0 : std::abs(sum / count);
}

/// By how much the mouth's outline moves in the picture when it is swept from one depth to another: the
/// farthest of its corners counts.
double Shift_px(const Sight& sight, const Wall& wall, const Ring& mouth, double from_m, double to_m) {
  double farthest = 0.0;
  for (const Eigen::Vector2d& corner : mouth) {
    const auto before = Project(sight.view, Behind(wall, corner, from_m));
    const auto after = Project(sight.view, Behind(wall, corner, to_m));
    if (before && after) farthest = std::max(farthest, (*after - *before).norm());
  }
  return farthest;
}

}  // namespace

std::optional<Recess> FindRecess(const Sight& sight, const Wall& wall, const Ring& mouth, double deepest_m) {
  SOFFIT_EXPECT(deepest_m > 0.0 && mouth.size() >= 3);
  const std::vector<Edge> edges = EdgesOf(mouth);
  const double front_m = wall.Front(sight.view.map_from_camera.translation_m.head<2>());
  if (!(front_m > 0.0)) return std::nullopt;
  std::vector<double> depths;  // Evenly spaced in the picture.
  for (int i = 1; i <= kDepths; ++i) {
    const double shrink = 1.0 - (1.0 - front_m / (front_m + deepest_m)) * i / kDepths;
    const double depth_m = front_m / shrink - front_m;
    if (Shift_px(sight, wall, mouth, 0.0, depth_m) >= kLeastShift_px) depths.push_back(depth_m);
  }
  if (depths.empty()) return std::nullopt;

  std::vector<double> score(depths.size(), 0.0);
  for (const Edge& edge : edges) {
    std::vector<double> contrast;
    for (const double depth_m : depths) contrast.push_back(Contrast(sight, wall, edge, depth_m));
    const double usual = Median(contrast) + 1.0;
    for (std::size_t i = 0; i < depths.size(); ++i) {
      const double ratio = contrast[i] / usual;
      if (ratio >= kEdgeRatio) score[i] += std::log1p(ratio);
    }
  }
  const auto best = std::max_element(score.begin(), score.end()) - score.begin();
  const auto i = static_cast<std::size_t>(best);
  if (score[i] < kLeastEdges * std::log1p(kEdgeRatio)) return std::nullopt;
  const double step_m = 0.01 * depths[i];
  const double pixel_m = step_m / std::max(1e-6, Shift_px(sight, wall, mouth, depths[i], depths[i] + step_m));
  return Recess{mouth, depths[i], pixel_m};
}

}  // namespace soffit
