#include "service/facade/align.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "service/facade/wall.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr int kRounds = 8;
constexpr double kSampleStep_px = 6.0;
constexpr double kMostReach_px = 60.0;
constexpr double kLeastReach_px = 6.0;
constexpr double kReachSigmas = 3.0;
constexpr int kSolid_px = 3;  // Run of one label that makes a side of an edge.
constexpr std::size_t kMinSamples = 60;
constexpr double kEdgeStd_px = 1.0;
constexpr double kCorrelated = 20.0;  // Neighbouring samples err alike: so many count as one.
constexpr double kLeastPositionStd_m = 0.002;
constexpr double kLeastOrientationStd_rad = 0.0003;
constexpr double kHeightPriorStd_m = 0.5;
constexpr double kMostHeightChange = 2.0;  // Times the height from above, or one over it.
constexpr double kMinFacing = 0.05;        // Cosine: walls seen more edge-on are left out.

using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

/// A point on an edge of the building, and where outside of it is.
struct EdgePoint {
  Eigen::Vector3d in_map_m;
  Eigen::Vector3d outward;  ///< Direction in the map that leads off the structure, along the wall's plane.
  bool is_roof = false;
};

/// Edges of the walls that face the camera.
std::vector<EdgePoint> SampleEdges(const Polygon& footprint, double height_m, const View& view) {
  std::vector<EdgePoint> points;
  const Eigen::Vector3d camera = view.map_from_camera.translation_m;
  const std::size_t n = footprint.outer.size();
  std::vector<bool> faces(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Wall wall = WallOf(footprint.outer, static_cast<int>(i));
    const Eigen::Vector2d to_camera = camera.head<2>() - wall.InPlan(0.5 * wall.width_m);
    faces[i] = wall.Front(camera.head<2>()) > kMinFacing * to_camera.norm();
  }
  const auto add_line = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& outward, bool is_roof) {
    const auto from = Project(view, a);
    const auto to = Project(view, b);
    if (!from || !to) return;
    const int count = static_cast<int>(std::clamp((*to - *from).norm() / kSampleStep_px, 2.0, 600.0));
    for (int k = 1; k < count; ++k) points.push_back({a + (b - a) * k / count, outward, is_roof});
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (!faces[i]) continue;
    const Wall wall = WallOf(footprint.outer, static_cast<int>(i));
    const Eigen::Vector3d along(wall.along.x(), wall.along.y(), 0.0);
    const double w = wall.width_m;
    add_line(wall.InMap({0.0, 0.0}), wall.InMap({w, 0.0}), -Eigen::Vector3d::UnitZ(), false);
    if (camera.z() < height_m)
      add_line(wall.InMap({0.0, height_m}), wall.InMap({w, height_m}), Eigen::Vector3d::UnitZ(), true);
    if (!faces[(i + n - 1) % n]) add_line(wall.InMap({0.0, 0.0}), wall.InMap({0.0, height_m}), -along, false);
    if (!faces[(i + 1) % n]) add_line(wall.InMap({w, 0.0}), wall.InMap({w, height_m}), along, false);
  }
  return points;
}

/// Signed distance, along `normal`, from `at` to where structure ends; none when it does not end once within
/// reach.
std::optional<double> FindEdge(const cv::Mat1b& own, const Eigen::Vector2d& at, const Eigen::Vector2d& normal,
                               int reach) {
  const auto is_own = [&](int step) -> int {
    const int x = static_cast<int>(std::lround(at.x() + step * normal.x()));
    const int y = static_cast<int>(std::lround(at.y() + step * normal.y()));
    if (x < 0 || y < 0 || x >= own.cols || y >= own.rows) return -1;
    return own(y, x) != 0 ? 1 : 0;
  };
  std::optional<double> nearest;
  for (int step = -reach; step <= reach; ++step) {  // The edge lies between `step` and `step` + 1.
    bool is_edge = true;
    for (int k = 0; k < kSolid_px && is_edge; ++k)
      is_edge = is_own(step - k) == 1 && is_own(step + 1 + k) == 0;
    if (is_edge && (!nearest || std::abs(step + 0.5) < std::abs(*nearest))) nearest = step + 0.5;
  }
  return nearest;
}

/// The camera's own motion first: rotation (3, map axes), translation (3), then the roof's rise.
std::optional<Eigen::Vector2d> ProjectMoved(const View& view, const EdgePoint& point, const Vector7& change) {
  View moved = view;
  const Eigen::Vector3d turn = change.head<3>();
  const double angle = turn.norm();
  if (angle > 0.0) {
    moved.map_from_camera.rotation =
        (Eigen::AngleAxisd(angle, turn / angle) * view.map_from_camera.rotation).normalized();
  }
  moved.map_from_camera.translation_m += change.segment<3>(3);
  Eigen::Vector3d p = point.in_map_m;
  if (point.is_roof) p.z() += change(6);
  return Project(moved, p);
}

struct Normal {
  Matrix7 matrix = Matrix7::Zero();
  Vector7 right = Vector7::Zero();
  std::size_t samples = 0;
};

/// One picture's share of the normal equations.
Normal Gather(const View& view, const cv::Mat1b& own, const std::vector<EdgePoint>& points, int reach) {
  Normal normal;
  for (const EdgePoint& point : points) {
    const auto at = Project(view, point.in_map_m);
    const auto beside = Project(view, point.in_map_m + 0.01 * point.outward);
    if (!at || !beside || (*beside - *at).norm() < 1e-6) continue;
    const Eigen::Vector2d across = (*beside - *at).normalized();
    const auto distance = FindEdge(own, *at, across, reach);
    if (!distance) continue;
    Vector7 row;
    bool is_valid = true;
    for (int k = 0; k < 7; ++k) {
      const double step = k < 3 ? 1e-5 : 1e-4;
      Vector7 change = Vector7::Zero();
      change(k) = step;
      const auto moved = ProjectMoved(view, point, change);
      is_valid = is_valid && moved.has_value();
      if (moved) row(k) = across.dot(*moved - *at) / step;
    }
    if (!is_valid) continue;
    const double scale = 0.3 * reach;
    const double weight =
        1.0 / (1.0 + *distance * *distance / (scale * scale));  // Cauchy: doors and clutter are outliers.
    normal.matrix += weight * row * row.transpose();
    normal.right += weight * *distance * row;
    ++normal.samples;
  }
  const double information = 1.0 / (kEdgeStd_px * kEdgeStd_px * kCorrelated);
  normal.matrix *= information;
  normal.right *= information;
  return normal;
}

cv::Mat1b OwnStructure(const Sight& sight, const Mask& mask, const std::string& color) {
  const auto found = std::find(mask.classes.begin(), mask.classes.end(), color);
  const int own_class = found == mask.classes.end() ? 0 : static_cast<int>(found - mask.classes.begin()) + 1;
  cv::Mat1b own(sight.seen.size(), uchar{0});
  for (int y = 0; y < own.rows; ++y) {
    for (int x = 0; x < own.cols; ++x) {
      const bool is_structure = sight.seen(y, x) == static_cast<uchar>(Seen::kStructure);
      own(y, x) = is_structure && (mask.label(y, x) == 0 || mask.label(y, x) == own_class) ? 1 : 0;
    }
  }
  return own;
}

/// How far from where it is predicted an edge is looked for: at first as far as the pose may be wrong, then
/// closer.
int SearchReach(const View& view, const Footprint& object, double progress) {
  const Eigen::Vector2d camera = view.map_from_camera.translation_m.head<2>();
  const double distance = std::max(0.5, DistanceToRing(camera, object.polygon_in_map_m.outer));
  const double first = kLeastReach_px + kReachSigmas * view.intrinsics.fx_px *
                                            (view.orientation_std_rad + view.position_std_m / distance);
  return static_cast<int>(kLeastReach_px *
                          std::pow(std::min(first, kMostReach_px) / kLeastReach_px, 1.0 - progress));
}

struct Prior {
  Eigen::Matrix<double, 6, 1> std;
  explicit Prior(const View& view) {
    std.head<3>().setConstant(std::max(view.orientation_std_rad, kLeastOrientationStd_rad));
    std.tail<3>().setConstant(std::max(view.position_std_m, kLeastPositionStd_m));
  }
};

/// How far a view has moved from where it was reported: rotation vector and translation.
Eigen::Matrix<double, 6, 1> Moved(const View& now, const View& reported) {
  const Eigen::AngleAxisd turn(now.map_from_camera.rotation * reported.map_from_camera.rotation.conjugate());
  Eigen::Matrix<double, 6, 1> moved;
  moved << turn.angle() * turn.axis(),
      now.map_from_camera.translation_m - reported.map_from_camera.translation_m;
  return moved;
}

void Apply(const Vector7& change, View& view) {
  const Eigen::Vector3d turn = change.head<3>();
  if (turn.norm() > 0.0) {
    view.map_from_camera.rotation =
        (Eigen::AngleAxisd(turn.norm(), turn.normalized()) * view.map_from_camera.rotation).normalized();
  }
  view.map_from_camera.translation_m += change.segment<3>(3);
}

void Shift(const Eigen::Vector2d& by, Polygon& polygon) {
  for (Eigen::Vector2d& p : polygon.outer) p += by;
  for (Ring& hole : polygon.holes) {
    for (Eigen::Vector2d& p : hole) p += by;
  }
}

Footprint DrawAgain(const Footprint& object, double height_m, double height_std_m) {
  if (!object.silhouettes.empty()) return WithHeight(object, height_m, height_std_m);
  Footprint same = object;
  same.height_m = height_m;
  same.height_std_m = height_std_m;
  return same;
}

}  // namespace

Alignment AlignSights(const Footprint& object, const std::vector<Mask>& masks,
                      const std::vector<Sight>& sights, const FacadeOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  SOFFIT_EXPECT(masks.size() == sights.size());
  Alignment aligned{object, sights};
  if (!(object.height_m > 0.0)) return aligned;
  const double prior_height = object.height_m;
  const double height_std =
      std::max({object.height_std_m, 0.02, std::min(kHeightPriorStd_m, 0.2 * prior_height)});
  std::vector<cv::Mat1b> own;
  for (std::size_t i = 0; i < sights.size(); ++i)
    own.push_back(OwnStructure(sights[i], masks[i], object.color));

  double height = prior_height;
  std::vector<bool> is_used(sights.size(), false);
  for (int round = 0; round < kRounds; ++round) {
    const double share = static_cast<double>(round) / (kRounds - 1);
    // The roof's height is common to all pictures: their poses are eliminated from the equation for it.
    double height_information = 1.0 / (height_std * height_std);
    double height_pull = (prior_height - height) * height_information;
    std::vector<Normal> normals(sights.size());
    for (std::size_t i = 0; i < sights.size(); ++i) {
      View& view = aligned.sights[i].view;
      normals[i] = Gather(view, own[i], SampleEdges(aligned.footprint.polygon_in_map_m, height, view),
                          SearchReach(sights[i].view, object, share));
      is_used[i] = normals[i].samples >= kMinSamples;
      if (!is_used[i]) continue;
      const Eigen::Matrix<double, 6, 1> weight = Prior(sights[i].view).std.array().square().inverse();
      normals[i].matrix.topLeftCorner<6, 6>() += weight.asDiagonal();
      normals[i].right.head<6>() -= weight.cwiseProduct(Moved(view, sights[i].view));
      const auto pose = normals[i].matrix.topLeftCorner<6, 6>().ldlt();
      const Eigen::Matrix<double, 6, 1> coupling = normals[i].matrix.block<6, 1>(0, 6);
      height_information += normals[i].matrix(6, 6) - coupling.dot(pose.solve(coupling));
      height_pull += normals[i].right(6) - coupling.dot(pose.solve(normals[i].right.head<6>()));
    }
    const double rise = height_pull / height_information;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      if (!is_used[i]) continue;
      Vector7 change = Vector7::Zero();
      const auto pose = normals[i].matrix.topLeftCorner<6, 6>().ldlt();
      change.head<6>() = pose.solve(normals[i].right.head<6>() - rise * normals[i].matrix.block<6, 1>(0, 6));
      Apply(change, aligned.sights[i].view);
      const Eigen::Matrix<double, 6, 6> covariance = pose.solve(Eigen::Matrix<double, 6, 6>::Identity());
      View& view = aligned.sights[i].view;
      view.orientation_std_rad = std::sqrt(covariance.diagonal().head<3>().mean());
      view.position_std_m = std::sqrt(covariance.diagonal().tail<3>().mean());
    }
    height += rise;
    if (!(height > prior_height / kMostHeightChange && height < kMostHeightChange * prior_height))
      return {object, sights};
    aligned.footprint = DrawAgain(object, height, 1.0 / std::sqrt(height_information));
  }

  Eigen::Vector2d common = Eigen::Vector2d::Zero();
  double used = 0.0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (!is_used[i]) continue;
    common += Moved(aligned.sights[i].view, sights[i].view).segment<2>(3);
    used += 1.0;
  }
  const double from_above = std::max<double>(1.0, static_cast<double>(object.captures.size()));
  const Eigen::Vector2d back = -common / (used + from_above);
  Shift(back, aligned.footprint.polygon_in_map_m);
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (is_used[i]) aligned.sights[i].view.map_from_camera.translation_m.head<2>() += back;
  }
  const double better = std::sqrt(from_above / (used + from_above));
  for (double& std : aligned.footprint.corner_std_m) std *= better;
  return aligned;
}

}  // namespace soffit
