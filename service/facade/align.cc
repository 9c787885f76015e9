#include "service/facade/align.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "service/facade/wall.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr int kRounds = 8;
constexpr double kSampleStep_px = 6.0;
constexpr double kMostReach_px = 160.0;
constexpr double kLeastReach_px = 6.0;
constexpr double kReachSigmas = 3.0;
constexpr int kSolid_px = 3;  // Run of one label that makes a side of an edge.
constexpr std::size_t kMinSamples = 60;
constexpr double kMaskStd_px = 1.0;
constexpr double kOutlineStd_px = 0.5;
constexpr double kMinAlike = 0.7;     // Cosine between an edge and the side of an outline.
constexpr double kCorrelated = 20.0;  // Neighbouring samples err alike: so many count as one.
constexpr double kLeastPositionStd_m = 0.002;
constexpr double kLeastOrientationStd_rad = 0.0003;
constexpr double kHeightPriorStd_m = 0.5;
constexpr double kHeightPriorShare = 0.2;
constexpr double kFreeCornerStd_m = 1.0;
constexpr double kWellKnown = 0.15;  // Standard deviation of a height, over it.
constexpr double kLowest_m = 0.4;
constexpr double kNextHeight = 1.6;        // Times the last.
constexpr double kHighest = 0.8;           // Times the height of the lowest camera.
constexpr double kMostHeightChange = 3.0;  // Times the height from above, or one over it.
constexpr double kMinFacing = 0.05;        // Cosine: walls seen more edge-on are left out.

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// A point on an edge of the building, and where outside of it is.
struct EdgePoint {
  Eigen::Vector3d in_map_m;
  Eigen::Vector3d outward;  ///< Direction in the map that leads off the structure.
  std::size_t side = 0;
  double share = 0.0;  ///< Of the way along the side, from its first corner to its second.
  bool is_roof = false;
};

/// The edges between the building and what is behind or before it, as a camera sees them.
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
  const auto add_line = [&](EdgePoint from, EdgePoint to) {
    const auto from_px = Project(view, from.in_map_m);
    const auto to_px = Project(view, to.in_map_m);
    if (!from_px || !to_px) return;
    const int count = static_cast<int>(std::clamp((*to_px - *from_px).norm() / kSampleStep_px, 2.0, 600.0));
    for (int k = 1; k < count; ++k) {
      const double share = static_cast<double>(k) / count;
      EdgePoint point = from;
      point.in_map_m += share * (to.in_map_m - from.in_map_m);
      point.share += share * (to.share - from.share);
      points.push_back(point);
    }
  };
  const bool is_above = camera.z() >= height_m;
  for (std::size_t i = 0; i < n; ++i) {
    const Wall wall = WallOf(footprint.outer, static_cast<int>(i));
    const Eigen::Vector3d along(wall.along.x(), wall.along.y(), 0.0);
    const Eigen::Vector3d ahead(wall.outward.x(), wall.outward.y(), 0.0);
    const double w = wall.width_m;
    const auto add_level = [&](double z, const Eigen::Vector3d& outward, bool is_roof) {
      add_line({wall.InMap({0.0, z}), outward, i, 0.0, is_roof},
               {wall.InMap({w, z}), outward, i, 1.0, is_roof});
    };
    const auto add_upright = [&](double u, const Eigen::Vector3d& outward) {
      const double share = u / w;
      add_line({wall.InMap({u, 0.0}), outward, i, share}, {wall.InMap({u, height_m}), outward, i, share});
    };
    if (faces[i]) add_level(0.0, is_above ? ahead : -Eigen::Vector3d::UnitZ(), false);
    if (faces[i] && !is_above) add_level(height_m, Eigen::Vector3d::UnitZ(), true);
    if (!faces[i] && is_above) add_level(height_m, ahead, true);
    if (faces[i] && !faces[(i + n - 1) % n]) add_upright(0.0, -along);
    if (faces[i] && !faces[(i + 1) % n]) add_upright(w, along);
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

/// Signed distance, along `normal`, from `at` to the nearest side of an outline that faces that way.
std::optional<double> FindEdge(const Outline& outline, const Eigen::Vector2d& at,
                               const Eigen::Vector2d& normal, int reach) {
  std::optional<double> nearest;
  const auto cross = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
    return p.x() * q.y() - p.y() * q.x();
  };
  const auto try_ring = [&](const Ring& ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
      const double facing = cross(normal, side);  // The outward normal is (y, -x) of the side.
      if (facing < kMinAlike * side.norm()) continue;
      const double along = cross(ring[i] - at, normal) / facing;
      const double distance = cross(ring[i] - at, side) / facing;
      if (along < 0.0 || along > 1.0 || std::abs(distance) > reach) continue;
      if (!nearest || std::abs(distance) < std::abs(*nearest)) nearest = distance;
    }
  };
  try_ring(outline.polygon_px.outer);
  for (const Ring& hole : outline.polygon_px.holes) try_ring(hole);
  return nearest;
}

/// How one picture shows the building: as a mask, or as the outline that was traced from above.
struct Shot {
  View reported;
  View view;  ///< As adjusted so far.
  cv::Mat1b own;
  const Outline* outline = nullptr;
  bool is_used = false;

  std::optional<double> Find(const Eigen::Vector2d& at, const Eigen::Vector2d& normal, int reach) const {
    return outline != nullptr ? FindEdge(*outline, at, normal, reach) : FindEdge(own, at, normal, reach);
  }
  bool Shows(const Eigen::Vector2d& at) const {
    const Intrinsics& k = view.intrinsics;
    return at.x() >= 0.0 && at.y() >= 0.0 && at.x() < k.width_px && at.y() < k.height_px;
  }
  double EdgeStd_px() const { return outline != nullptr ? kOutlineStd_px : kMaskStd_px; }
};

/// Rotation vector (map axes) first, then translation.
void Apply(const Vector6& change, View& view) {
  const Eigen::Vector3d turn = change.head<3>();
  if (turn.norm() > 0.0) {
    view.map_from_camera.rotation =
        (Eigen::AngleAxisd(turn.norm(), turn.normalized()) * view.map_from_camera.rotation).normalized();
  }
  view.map_from_camera.translation_m += change.tail<3>();
}

/// By how much a point's place in the picture moves along `across` with each part of the pose.
std::optional<Vector6> Sensitivity(const View& view, const Eigen::Vector3d& point, const Eigen::Vector2d& at,
                                   const Eigen::Vector2d& across) {
  Vector6 row;
  for (int k = 0; k < 6; ++k) {
    const double step = k < 3 ? 1e-5 : 1e-4;
    View moved = view;
    Apply(step * Vector6::Unit(k), moved);
    const auto there = Project(moved, point);
    if (!there) return std::nullopt;
    row(k) = across.dot(*there - at) / step;
  }
  return row;
}

/// One picture's share of the normal equations: of its pose, and of what all pictures share, which is the
/// corners of the footprint (x, y of each) and then the height.
struct Normal {
  explicit Normal(Eigen::Index shared_size)
      : coupling(Eigen::MatrixXd::Zero(6, shared_size)),
        shared(Eigen::MatrixXd::Zero(shared_size, shared_size)),
        shared_right(Eigen::VectorXd::Zero(shared_size)) {}

  Matrix6 pose = Matrix6::Zero();
  Vector6 pose_right = Vector6::Zero();
  Eigen::MatrixXd coupling;
  Eigen::MatrixXd shared;
  Eigen::VectorXd shared_right;
  std::size_t samples = 0;  ///< Of edges that were found,
  std::size_t looked = 0;   ///< of those in the picture.
};

Normal Gather(const Shot& shot, const std::vector<EdgePoint>& points, std::size_t corners, int reach) {
  const Eigen::Index height_at = static_cast<Eigen::Index>(2 * corners);
  Normal normal(height_at + 1);
  const double information = 1.0 / (shot.EdgeStd_px() * shot.EdgeStd_px() * kCorrelated);
  const double scale = 0.3 * reach;
  for (const EdgePoint& point : points) {
    const auto at = Project(shot.view, point.in_map_m);
    const auto beside = Project(shot.view, point.in_map_m + 0.01 * point.outward);
    if (!at || !beside || (*beside - *at).norm() < 1e-6) continue;
    const Eigen::Vector2d across = (*beside - *at).normalized();
    normal.looked += shot.Shows(*at) ? 1U : 0U;
    const auto distance = shot.Find(*at, across, reach);
    if (!distance) continue;
    const auto row = Sensitivity(shot.view, point.in_map_m, *at, across);
    if (!row) continue;
    Eigen::VectorXd of_shared = Eigen::VectorXd::Zero(height_at + 1);  // A point moves against the camera.
    const auto first = static_cast<Eigen::Index>(2 * point.side);
    const auto second = static_cast<Eigen::Index>(2 * ((point.side + 1) % corners));
    of_shared.segment<2>(first) -= (1.0 - point.share) * row->segment<2>(3);
    of_shared.segment<2>(second) -= point.share * row->segment<2>(3);
    if (point.is_roof) of_shared(height_at) = -(*row)(5);
    const double weight =
        information / (1.0 + *distance * *distance / (scale * scale));  // Cauchy: clutter is an outlier.
    normal.pose += weight * *row * row->transpose();
    normal.pose_right += weight * *distance * *row;
    normal.coupling += weight * *row * of_shared.transpose();
    normal.shared += weight * of_shared * of_shared.transpose();
    normal.shared_right += weight * *distance * of_shared;
    ++normal.samples;
  }
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
  const Eigen::Vector3d& camera = view.map_from_camera.translation_m;
  const double aside = DistanceToRing(camera.head<2>(), object.polygon_in_map_m.outer);
  const double above = std::max(0.0, camera.z() - object.height_m);
  const double distance = std::max(0.5, std::hypot(aside, above));
  const double first = kLeastReach_px + kReachSigmas * view.intrinsics.fx_px *
                                            (view.orientation_std_rad + view.position_std_m / distance);
  return static_cast<int>(kLeastReach_px *
                          std::pow(std::min(first, kMostReach_px) / kLeastReach_px, 1.0 - progress));
}

/// Inverse variances of a pose as it was reported.
Vector6 PriorOf(const View& view) {
  Vector6 std;
  std.head<3>().setConstant(std::max(view.orientation_std_rad, kLeastOrientationStd_rad));
  std.tail<3>().setConstant(std::max(view.position_std_m, kLeastPositionStd_m));
  return std.array().square().inverse();
}

/// How far a view has moved from where it was reported: rotation vector and translation.
Vector6 Moved(const View& now, const View& reported) {
  const Eigen::AngleAxisd turn(now.map_from_camera.rotation * reported.map_from_camera.rotation.conjugate());
  Vector6 moved;
  moved << turn.angle() * turn.axis(),
      now.map_from_camera.translation_m - reported.map_from_camera.translation_m;
  return moved;
}

/// What the pictures share: corner after corner, then the height.
Eigen::VectorXd Pack(const Footprint& object) {
  const Ring& outer = object.polygon_in_map_m.outer;
  Eigen::VectorXd shared(static_cast<Eigen::Index>(2 * outer.size() + 1));
  for (std::size_t i = 0; i < outer.size(); ++i)
    shared.segment<2>(static_cast<Eigen::Index>(2 * i)) = outer[i];
  shared(shared.size() - 1) = object.height_m;
  return shared;
}

/// Courtyards move with the outer ring.
void Unpack(const Eigen::VectorXd& shared, Footprint& object) {
  Eigen::Vector2d moved = Eigen::Vector2d::Zero();
  Ring& outer = object.polygon_in_map_m.outer;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    const Eigen::Vector2d corner = shared.segment<2>(static_cast<Eigen::Index>(2 * i));
    moved += (corner - outer[i]) / static_cast<double>(outer.size());
    outer[i] = corner;
  }
  for (Ring& hole : object.polygon_in_map_m.holes) {
    for (Eigen::Vector2d& p : hole) p += moved;
  }
  object.height_m = shared(shared.size() - 1);
}

/// Inverse variances of what is known of the building beforehand. Its corners were drawn from the outlines
/// from above, which are measured again here; without those the footprint is what is known.
Eigen::VectorXd PriorOf(const Footprint& object) {
  const double height_std =
      std::max({object.height_std_m, 0.02, std::min(kHeightPriorStd_m, kHeightPriorShare * object.height_m)});
  double corner_std = kFreeCornerStd_m;
  if (object.silhouettes.empty()) {
    corner_std = kLeastPositionStd_m;
    for (const double std : object.corner_std_m) corner_std = std::max(corner_std, std);
  }
  Eigen::VectorXd prior =
      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(2 * object.polygon_in_map_m.outer.size() + 1),
                                1.0 / (corner_std * corner_std));
  prior(prior.size() - 1) = 1.0 / (height_std * height_std);
  return prior;
}

/// Least squares over the building and all poses at once, a step at a time.
class Adjustment {
 public:
  Adjustment(const Footprint& object, std::vector<Shot>& shots)
      : object_(object), known_(Pack(object)), prior_(PriorOf(object)), shots_(shots) {}

  /// @param progress  From 0, for the first step, to 1.
  void Step(double progress) {
    const std::size_t corners = object_.polygon_in_map_m.outer.size();
    Eigen::MatrixXd reduced = prior_.asDiagonal();
    Eigen::VectorXd right = prior_.cwiseProduct(known_ - Pack(object_));
    std::vector<Normal> normals;
    found_ = looked_ = 0;
    for (Shot& shot : shots_) {
      const std::vector<EdgePoint> points =
          SampleEdges(object_.polygon_in_map_m, object_.height_m, shot.view);
      Normal normal = Gather(shot, points, corners, SearchReach(shot.reported, object_, progress));
      shot.is_used = normal.samples >= kMinSamples;
      found_ += normal.samples;
      looked_ += normal.looked;
      const Vector6 prior = PriorOf(shot.reported);
      normal.pose.diagonal() += prior;
      normal.pose_right -= prior.cwiseProduct(Moved(shot.view, shot.reported));
      if (shot.is_used) {  // Its pose is eliminated from the equations of what is shared.
        const Eigen::MatrixXd solved = normal.pose.ldlt().solve(normal.coupling);
        reduced += normal.shared - normal.coupling.transpose() * solved;
        right += normal.shared_right - solved.transpose() * normal.pose_right;
      }
      normals.push_back(std::move(normal));
    }
    const Eigen::VectorXd change = reduced.ldlt().solve(right);
    for (std::size_t i = 0; i < shots_.size(); ++i) {
      if (shots_[i].is_used) Move(normals[i], change, shots_[i].view);
    }
    Unpack(Pack(object_) + change, object_);
    covariance_ = reduced.inverse();
  }

  bool IsSane() const {
    const Ring& outer = object_.polygon_in_map_m.outer;
    const double known_height = known_(known_.size() - 1);
    return covariance_.allFinite() && object_.height_m > known_height / kMostHeightChange &&
           object_.height_m < kMostHeightChange * known_height && IsSimple(outer) && SignedArea(outer) > 0.0;
  }

  /// Share of the building's edges that the pictures show where they are expected, as of the last step.
  double FoundShare() const {
    return looked_ == 0 ? 0.0 : static_cast<double>(found_) / static_cast<double>(looked_);
  }

  Footprint Result() const {
    Footprint result = object_;
    const std::size_t corners = object_.polygon_in_map_m.outer.size();
    const Eigen::VectorXd variance = covariance_.diagonal();
    result.corner_std_m.resize(corners);
    for (std::size_t i = 0; i < corners; ++i)
      result.corner_std_m[i] = std::sqrt(0.5 * variance.segment<2>(static_cast<Eigen::Index>(2 * i)).sum());
    result.height_std_m = std::sqrt(variance(variance.size() - 1));
    return result;
  }

 private:
  static void Move(const Normal& normal, const Eigen::VectorXd& change, View& view) {
    const auto pose = normal.pose.ldlt();
    Apply(pose.solve(normal.pose_right - normal.coupling * change), view);
    const Matrix6 covariance = pose.solve(Matrix6::Identity());
    view.orientation_std_rad = std::sqrt(covariance.diagonal().head<3>().mean());
    view.position_std_m = std::sqrt(covariance.diagonal().tail<3>().mean());
  }

  Footprint object_;
  Eigen::VectorXd known_;
  Eigen::VectorXd prior_;
  std::vector<Shot>& shots_;
  Eigen::MatrixXd covariance_;
  std::size_t found_ = 0;
  std::size_t looked_ = 0;
};

/// Heights to begin with: the one that is known, and where it is not known well, all that there may be.
std::vector<Footprint> Begin(const Footprint& object) {
  std::vector<Footprint> starts;
  if (object.height_m > 0.0) starts.push_back(object);
  const bool is_known = object.height_m > 0.0 && object.height_std_m < kWellKnown * object.height_m;
  if (is_known || object.silhouettes.empty()) return starts;
  double highest = std::numeric_limits<double>::infinity();
  for (const Silhouette& silhouette : object.silhouettes)
    highest = std::min(highest, kHighest * silhouette.view.map_from_camera.translation_m.z());
  for (double height = kLowest_m; height < highest; height *= kNextHeight)
    starts.push_back(WithHeight(object, height, (kNextHeight - 1.0) * height));
  return starts;
}

/// Of the sights first, then of the silhouettes that are whole.
void TakeViews(const std::vector<Shot>& shots, Alignment& alignment) {
  std::size_t next = 0;
  for (Sight& sight : alignment.sights) sight.view = shots[next++].view;
  for (Silhouette& silhouette : alignment.footprint.silhouettes) {
    if (IsWhole(silhouette)) silhouette.view = shots[next++].view;
  }
}

}  // namespace

Alignment AlignSights(const Footprint& object, const std::vector<Mask>& masks,
                      const std::vector<Sight>& sights, const FacadeOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  SOFFIT_EXPECT(masks.size() == sights.size());
  std::vector<Shot> reported;
  for (std::size_t i = 0; i < sights.size(); ++i)
    reported.push_back({sights[i].view, sights[i].view, OwnStructure(sights[i], masks[i], object.color)});
  for (const Silhouette& silhouette : object.silhouettes) {
    if (IsWhole(silhouette))
      reported.push_back({silhouette.view, silhouette.view, {}, &silhouette.outline});
  }

  Alignment best{object, sights};
  double best_share = 0.0;
  for (const Footprint& start : Begin(object)) {
    std::vector<Shot> shots = reported;
    Adjustment adjustment(start, shots);
    for (int round = 0; round < kRounds && adjustment.IsSane(); ++round)
      adjustment.Step(static_cast<double>(round) / (kRounds - 1));
    if (!adjustment.IsSane() || adjustment.FoundShare() <= best_share) continue;
    best_share = adjustment.FoundShare();
    best = {adjustment.Result(), sights};
    TakeViews(shots, best);
  }
  return best;
}

}  // namespace soffit
