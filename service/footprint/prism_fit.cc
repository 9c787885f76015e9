#include "service/footprint/prism_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "service/footprint/carve.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kStep_px = 6.0;        ///< Between the points of outlines that are compared.
constexpr double kRoughStep_px = 18.0;  ///< To compare starts.
constexpr double kOutlineStd_px = 0.6;  ///< Of a traced side.
constexpr double kSpacing_px = 200.0;   ///< Of points that err by themselves.
constexpr double kFarthest = 6.0;       ///< In standard deviations: farther points are of something else.
constexpr double kCornerPrice = 2.0;  ///< For each picture, as sides that bend a little do so in all of them.
constexpr double kFlatCornerPrice = 8.0;  ///< Of corners that hardly bend a wall: buildings seldom have them,
constexpr double kFlatSine = 0.25;        ///< but openings make walls look so.
constexpr double kHighestRatio = 0.9;  ///< Of the lowest camera's height: no building reaches nearer to it.
constexpr double kExactStd = 1e-6;     ///< For what is said to be known exactly.
constexpr double kMinCos = 0.5;        ///< An outline is drawn to edges that run within 60 degrees of it.

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double Robust(double distance_px, double scale) {
  const double squared = distance_px * distance_px / (kOutlineStd_px * kOutlineStd_px);
  return squared / (1.0 + squared / (scale * scale));
}

/// A point of an outline in a picture. The building is on the left when x is to the right and y is up.
struct Mark {
  Vector2d pixel = Vector2d::Zero();
  Vector2d along = Vector2d::Zero();  ///< Unit.
  std::size_t edge = 0;               ///< Predicted outlines: which edge of the prism it is on.
};

std::vector<Mark> SampleOutline(const Silhouette& s, double step_px) {
  constexpr double kRim_px = 4.0;  // There a cut outline is only the end of the picture.
  const Intrinsics& lens = s.view.intrinsics;
  std::vector<Ring> rings = s.outline.polygon_px.holes;
  rings.push_back(s.outline.polygon_px.outer);
  std::vector<Mark> marks;
  for (const Ring& ring : rings) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
      const int count = std::max(1, static_cast<int>(std::lround(side.norm() / step_px)));
      for (int k = 0; k < count; ++k) {
        const Vector2d pixel = ring[i] + side * ((k + 0.5) / count);
        const bool is_inside = pixel.x() > kRim_px && pixel.y() > kRim_px &&
                               pixel.x() < lens.width_px - 1 - kRim_px &&
                               pixel.y() < lens.height_px - 1 - kRim_px;
        if (is_inside || !s.outline.is_cut) marks.push_back({pixel, side.normalized(), 0});
      }
    }
  }
  return marks;
}

struct Nearest {
  std::size_t index = 0;
  double distance_px = std::numeric_limits<double>::infinity();  ///< Across the direction of the mark.
};

/// The mark that is nearest to one and runs the same way.
Nearest FindNearest(const Mark& mark, const std::vector<Mark>& others, double step_px) {
  Nearest nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < others.size(); ++i) {
    const double squared = (others[i].pixel - mark.pixel).squaredNorm();
    if (squared < least && others[i].along.dot(mark.along) > kMinCos) {
      least = squared;
      nearest.index = i;
    }
  }
  if (!std::isfinite(least)) return nearest;
  const double across =
      std::abs(Cross(others[nearest.index].along, mark.pixel - others[nearest.index].pixel));
  nearest.distance_px = std::sqrt(std::max(across * across, least - step_px * step_px));
  return nearest;
}

/// Of a point of the prism: where its picture is, and how that moves with the point.
struct Projected {
  Vector2d pixel = Vector2d::Zero();
  Eigen::Matrix<double, 2, 3> by_point = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Matrix<double, 2, 3> by_turn = Eigen::Matrix<double, 2, 3>::Zero();
};

Projected ProjectPoint(const View& view, const Vector3d& point) {
  const Matrix3d turn = view.map_from_camera.rotation.toRotationMatrix();
  const Vector3d ray = point - view.map_from_camera.translation_m;
  const Vector3d p = turn.transpose() * ray;
  const Intrinsics& lens = view.intrinsics;
  Eigen::Matrix<double, 2, 3> by_camera;
  by_camera << lens.fx_px / p.z(), 0.0, -lens.fx_px * p.x() / (p.z() * p.z()),  //
      0.0, lens.fy_px / p.z(), -lens.fy_px * p.y() / (p.z() * p.z());
  Matrix3d cross;
  cross << 0.0, -ray.z(), ray.y(), ray.z(), 0.0, -ray.x(), -ray.y(), ray.x(), 0.0;
  Projected projected;
  projected.pixel = {lens.fx_px * p.x() / p.z() + lens.cx_px, lens.fy_px * p.y() / p.z() + lens.cy_px};
  projected.by_point = by_camera * turn.transpose();
  projected.by_turn = projected.by_point * cross;
  return projected;
}

/// Footprint, height and cameras: all that is adjusted.
struct Prism {
  std::vector<Ring> rings;  ///< The first is the outer one; holes are clockwise.
  double height_m = 0.0;
  std::vector<View> views;
};

bool MeetsSegment(const std::vector<Ring>& rings, const Vector2d& a, const Vector2d& b) {
  bool is_inside = false;
  for (const Ring& ring : rings) {
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const Vector2d& p = ring[j];
      const Vector2d& q = ring[i];
      if ((p.y() > a.y()) != (q.y() > a.y()) &&
          a.x() < p.x() + (q.x() - p.x()) * (a.y() - p.y()) / (q.y() - p.y())) {
        is_inside = !is_inside;
      }
      const double of_a = Cross(q - p, a - p), of_b = Cross(q - p, b - p);
      const double of_p = Cross(b - a, p - a), of_q = Cross(b - a, q - a);
      if ((of_a > 0.0) != (of_b > 0.0) && (of_p > 0.0) != (of_q > 0.0)) return true;
    }
  }
  return is_inside;
}

/// Whether the ray through a pixel meets the prism.
bool Shows(const Prism& prism, const View& view, const Vector2d& pixel) {
  const auto foot = MeetHorizontalPlane(view, pixel, 0.0);
  const auto roof = MeetHorizontalPlane(view, pixel, prism.height_m);
  return foot && roof && MeetsSegment(prism.rings, *foot, *roof);
}

class Fitter {
 public:
  Fitter(const std::vector<Silhouette>& silhouettes, const Polygon& start, const HeightPrior& prior,
         double step_px)
      : silhouettes_(silhouettes),
        prior_(prior),
        step_px_(step_px),
        weight_(std::min(1.0, step_px / kSpacing_px)) {
    prism_.rings.push_back(start.outer);
    prism_.rings.insert(prism_.rings.end(), start.holes.begin(), start.holes.end());
    prism_.height_m = prior.value_m;
    for (const Silhouette& s : silhouettes) {
      prism_.views.push_back(s.view);
      seen_.push_back(SampleOutline(s, step_px));
      highest_m_ = std::min(highest_m_, kHighestRatio * s.view.map_from_camera.translation_m.z());
    }
    highest_m_ = std::max(highest_m_, prior.value_m);
  }

  /// From the prism as it is.
  void Fit(double first_scale, int steps) {
    is_valid_ = true;
    for (int i = 0; i < steps && is_valid_; ++i) {
      const double share = steps > 1 ? static_cast<double>(i) / (steps - 1) : 1.0;
      Step(kFarthest * std::pow(first_scale / kFarthest, 1.0 - share));
    }
    is_valid_ = is_valid_ && IsSound();
    cost_ = is_valid_ ? Judge() : std::numeric_limits<double>::infinity();
  }

  /// Takes corners out while that makes the whole cheaper.
  void Simplify() {
    for (bool is_simpler = true; is_simpler;) {
      is_simpler = false;
      for (const Removal& removal : FindRemovals()) {
        Fitter simpler = *this;
        simpler.prism_.rings[removal.ring] = removal.without;
        simpler.Fit(2.0 * kFarthest, 4);
        if (!(simpler.cost_ < cost_)) continue;
        prism_ = simpler.prism_;
        cost_ = simpler.cost_;
        explained_ratio_ = simpler.explained_ratio_;
        normal_ = simpler.normal_;
        is_valid_ = true;
        is_simpler = true;
        break;
      }
    }
  }

  PrismFit Result() const {
    PrismFit fit;
    if (!is_valid_) return fit;
    fit.polygon.outer = prism_.rings.front();
    fit.polygon.holes.assign(prism_.rings.begin() + 1, prism_.rings.end());
    fit.height_m = prism_.height_m;
    fit.cost = cost_;
    fit.explained_ratio = explained_ratio_;
    const MatrixXd covariance = normal_.ldlt().solve(MatrixXd::Identity(normal_.rows(), normal_.cols()));
    for (std::size_t i = 0; i < fit.polygon.outer.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(2 * i);
      fit.corner_std_m.push_back(std::sqrt(std::max(covariance(at, at), covariance(at + 1, at + 1))));
    }
    const Eigen::Index at = HeightIndex();
    fit.height_std_m = std::sqrt(covariance(at, at));
    return fit;
  }

 private:
  struct Removal {
    std::size_t ring;
    Ring without;
    double change_m;
  };

  Eigen::Index HeightIndex() const {
    std::size_t corners = 0;
    for (const Ring& ring : prism_.rings) corners += ring.size();
    return static_cast<Eigen::Index>(2 * corners);
  }

  /// The marks of the predicted outline. Edge 3 i is at the foot, from corner i (of all rings) to the next, 3
  /// i + 1 above it, 3 i + 2 the upright one over corner i.
  std::vector<Mark> PredictOutline(const View& view) const {
    constexpr double kBeside_px = 1.0;
    const Vector2d nadir = view.map_from_camera.translation_m.head<2>();
    std::vector<Mark> marks;
    std::size_t first = 0;
    for (const Ring& ring : prism_.rings) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d& a = ring[i];
        const Vector2d& b = ring[(i + 1) % ring.size()];
        const bool faces_away = Cross(a - nadir, b - a) > 0.0;
        const double z = faces_away ? prism_.height_m : 0.0;
        const std::size_t edge = 3 * (first + i);
        AddMarks(view, {a.x(), a.y(), z}, {b.x(), b.y(), z}, edge + (faces_away ? 1 : 0), kBeside_px, marks);
        AddMarks(view, {a.x(), a.y(), 0.0}, {a.x(), a.y(), prism_.height_m}, edge + 2, kBeside_px, marks);
      }
      first += ring.size();
    }
    return marks;
  }

  void AddMarks(const View& view, const Vector3d& from, const Vector3d& to, std::size_t edge,
                double beside_px, std::vector<Mark>& marks) const {
    const auto a = Project(view, from);
    const auto b = Project(view, to);
    if (!a || !b) return;
    const Vector2d side = *b - *a;
    const double length = side.norm();
    if (length < 1.0) return;
    const Vector2d along = side / length;
    const Vector2d left(-along.y(), along.x());
    const int count = std::max(1, static_cast<int>(std::lround(length / step_px_)));
    for (int k = 0; k < count; ++k) {
      const Vector2d pixel = *a + side * ((k + 0.5) / count);
      const bool is_left = Shows(prism_, view, pixel + beside_px * left);
      const bool is_right = Shows(prism_, view, pixel - beside_px * left);
      if (is_left != is_right) marks.push_back({pixel, is_left ? along : Vector2d(-along), edge});
    }
  }

  /// One step of Gauss-Newton; points farther than `scale` standard deviations are hardly heard.
  void Step(double scale) {
    std::vector<Vector2d> corners;
    std::vector<std::size_t> next;
    for (const Ring& ring : prism_.rings) {
      const std::size_t first = corners.size();
      for (std::size_t i = 0; i < ring.size(); ++i) {
        corners.push_back(ring[i]);
        next.push_back(first + (i + 1) % ring.size());
      }
    }
    const Eigen::Index height_at = HeightIndex();
    const Eigen::Index size = height_at + 1 + static_cast<Eigen::Index>(6 * prism_.views.size());
    MatrixXd normal = MatrixXd::Zero(size, size);
    VectorXd right = VectorXd::Zero(size);
    for (std::size_t v = 0; v < prism_.views.size(); ++v) {
      const View& view = prism_.views[v];
      const Eigen::Index pose_at = height_at + 1 + static_cast<Eigen::Index>(6 * v);
      std::vector<Projected> feet, roofs;
      for (const Vector2d& p : corners) {
        feet.push_back(ProjectPoint(view, {p.x(), p.y(), 0.0}));
        roofs.push_back(ProjectPoint(view, {p.x(), p.y(), prism_.height_m}));
      }
      const std::vector<Mark> predicted = PredictOutline(view);
      for (const Mark& mark : seen_[v]) {
        const Nearest nearest = FindNearest(mark, predicted, step_px_);
        if (!std::isfinite(nearest.distance_px)) continue;
        const std::size_t edge = predicted[nearest.index].edge;
        const std::size_t i = edge / 3;
        const std::size_t j = edge % 3 == 2 ? i : next[i];
        const bool is_roof_i = edge % 3 == 1;
        const bool is_roof_j = edge % 3 != 0;
        const Projected& a = is_roof_i ? roofs[i] : feet[i];
        const Projected& b = is_roof_j ? roofs[j] : feet[j];
        const Vector2d side = b.pixel - a.pixel;
        const Vector2d across = Vector2d(-side.y(), side.x()).normalized();
        const double share = std::clamp((mark.pixel - a.pixel).dot(side) / side.squaredNorm(), 0.0, 1.0);
        const double residual = across.dot(mark.pixel - a.pixel);
        const double inlier =
            1.0 / (1.0 + residual * residual / (kOutlineStd_px * kOutlineStd_px * scale * scale));
        const double weight = weight_ * inlier * inlier / (kOutlineStd_px * kOutlineStd_px);
        // How the edge moves, towards `across`, with all that is adjusted.
        const Eigen::RowVector2d at_a = (1.0 - share) * across.transpose();
        const Eigen::RowVector2d at_b = share * across.transpose();
        const Eigen::RowVector3d by_a = at_a * a.by_point;
        const Eigen::RowVector3d by_b = at_b * b.by_point;
        Eigen::Matrix<double, 11, 1> row;
        row << by_a.x(), by_a.y(), by_b.x(), by_b.y(),
            (is_roof_i ? by_a.z() : 0.0) + (is_roof_j ? by_b.z() : 0.0), -(by_a + by_b).transpose(),
            (at_a * a.by_turn + at_b * b.by_turn).transpose();
        std::array<Eigen::Index, 11> at{};
        at[0] = static_cast<Eigen::Index>(2 * i);
        at[1] = at[0] + 1;
        at[2] = static_cast<Eigen::Index>(2 * j);
        at[3] = at[2] + 1;
        at[4] = height_at;
        for (int k = 0; k < 6; ++k) at[static_cast<std::size_t>(5 + k)] = pose_at + k;
        for (int r = 0; r < 11; ++r) {
          right(at[static_cast<std::size_t>(r)]) += weight * residual * row(r);
          for (int c = 0; c < 11; ++c) {
            normal(at[static_cast<std::size_t>(r)], at[static_cast<std::size_t>(c)]) +=
                weight * row(r) * row(c);
          }
        }
      }
      AddPosePrior(v, pose_at, normal, right);
    }
    const double height_std = std::max(prior_.std_m, kExactStd);
    normal(height_at, height_at) += 1.0 / (height_std * height_std);
    right(height_at) += (prior_.value_m - prism_.height_m) / (height_std * height_std);
    normal_ = normal;
    constexpr double kUnseenStd_m = 1.0;  // Of what no outline tells.
    for (Eigen::Index i = 0; i <= height_at; ++i) {
      normal_(i, i) += 1.0 / (kUnseenStd_m * kUnseenStd_m);
      normal(i, i) += 1.0 / (kUnseenStd_m * kUnseenStd_m) + 1e-3 * normal(i, i);
    }
    Move(normal.ldlt().solve(right));
  }

  static Eigen::Matrix<double, 6, 1> PoseStd(const View& reported) {
    Eigen::Matrix<double, 6, 1> std;
    std.head<3>().setConstant(std::max(reported.position_std_m, kExactStd));
    std.tail<3>().setConstant(std::max(reported.orientation_std_rad, kExactStd));
    return std;
  }

  /// Of a view: position and rotation vector since it was reported, in standard deviations.
  Eigen::Matrix<double, 6, 1> Moved(std::size_t v) const {
    const Pose<Map, Camera>& now = prism_.views[v].map_from_camera;
    const Pose<Map, Camera>& reported = silhouettes_[v].view.map_from_camera;
    const Eigen::AngleAxisd turn(now.rotation * reported.rotation.conjugate());
    Eigen::Matrix<double, 6, 1> moved;
    moved << now.translation_m - reported.translation_m, turn.angle() * turn.axis();
    return moved.cwiseQuotient(PoseStd(silhouettes_[v].view));
  }

  void AddPosePrior(std::size_t v, Eigen::Index at, MatrixXd& normal, VectorXd& right) const {
    const Eigen::Matrix<double, 6, 1> std = PoseStd(silhouettes_[v].view);
    normal.diagonal().segment<6>(at) += std.cwiseProduct(std).cwiseInverse();
    right.segment<6>(at) -= Moved(v).cwiseQuotient(std);
  }

  void Move(const VectorXd& change) {
    if (!change.allFinite()) {
      is_valid_ = false;
      return;
    }
    Eigen::Index at = 0;
    for (Ring& ring : prism_.rings) {
      for (Vector2d& p : ring) {
        p += change.segment<2>(at);
        at += 2;
      }
    }
    prism_.height_m = std::clamp(prism_.height_m + change(at), 0.3 * prism_.height_m, highest_m_);
    ++at;
    for (View& view : prism_.views) {
      view.map_from_camera.translation_m += change.segment<3>(at);
      const Vector3d turn = change.segment<3>(at + 3);
      view.map_from_camera.rotation =
          (Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized())) *
           view.map_from_camera.rotation)
              .normalized();
      at += 6;
    }
  }

  bool IsSound() const {
    if (!IsSimple(prism_.rings.front()) || !(SignedArea(prism_.rings.front()) > 0.0)) return false;
    return std::all_of(prism_.rings.begin() + 1, prism_.rings.end(), [&](const Ring& hole) {
      return IsSimple(hole) && SignedArea(hole) < 0.0 &&
             std::all_of(hole.begin(), hole.end(),
                         [&](const Vector2d& p) { return Contains(prism_.rings.front(), p); });
    });
  }

  /// The cost; notes how much is explained.
  double Judge() {
    double squares = 0.0;
    double explained = 0.0;
    double all = 0.0;
    for (std::size_t v = 0; v < prism_.views.size(); ++v) {
      const std::vector<Mark> predicted = PredictOutline(prism_.views[v]);
      for (const Mark& mark : seen_[v]) {
        const double distance_px = std::min(1e6, FindNearest(mark, predicted, step_px_).distance_px);
        squares += weight_ * Robust(distance_px, kFarthest);
        explained += distance_px < kFarthest * kOutlineStd_px ? 1.0 : 0.0;
        all += 1.0;
      }
      squares += Moved(v).squaredNorm();
      if (silhouettes_[v].outline.is_cut) continue;
      for (const Mark& mark : predicted) {
        squares +=
            weight_ * Robust(std::min(1e6, FindNearest(mark, seen_[v], step_px_).distance_px), kFarthest);
      }
    }
    explained_ratio_ = all > 0.0 ? explained / all : 0.0;
    const double height_std = std::max(prior_.std_m, kExactStd);
    const double height_error = (prism_.height_m - prior_.value_m) / height_std;
    double price = 0.0;
    for (const Ring& ring : prism_.rings) price += PriceOf(ring);
    return 0.5 * (squares + height_error * height_error) + price * static_cast<double>(silhouettes_.size());
  }

  static double PriceOf(const Ring& ring) {
    double price = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vector2d before = (ring[i] - ring[(i + ring.size() - 1) % ring.size()]).normalized();
      const Vector2d after = (ring[(i + 1) % ring.size()] - ring[i]).normalized();
      price += std::abs(Cross(before, after)) < kFlatSine ? kFlatCornerPrice : kCornerPrice;
    }
    return price;
  }

  /// Ways to draw a ring with fewer corners that hardly change it, those that change it least first.
  std::vector<Removal> FindRemovals() const {
    constexpr double kMostChange_px = 15.0;
    constexpr std::size_t kMostTries = 5;
    const double most_m = kMostChange_px * GroundSampling_m(silhouettes_.front());
    std::vector<Removal> removals;
    for (std::size_t r = 0; r < prism_.rings.size(); ++r) {
      const Ring& ring = prism_.rings[r];
      const std::size_t n = ring.size();
      if (n <= 3) continue;
      const auto at = [&](std::size_t k) { return ring[k % n]; };
      const auto drop = [](Ring from, std::size_t index) {
        from.erase(from.begin() + static_cast<std::ptrdiff_t>(index));
        return from;
      };
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t j = (i + 1) % n;
        removals.push_back({r, drop(ring, i), DistanceToSegment(at(i), at(i + n - 1), at(j))});
        // The side from i to j: its neighbours go on until they meet, or are one line.
        const Vector2d before = at(i) - at(i + n - 1);
        const Vector2d after = at(j + 1) - at(j);
        const double sine = Cross(before.normalized(), after.normalized());
        if (std::abs(sine) > 0.15) {
          const Vector2d meeting =
              at(i) + before.normalized() * (Cross(at(j) - at(i), after.normalized()) / sine);
          Ring without = ring;
          without[i] = meeting;
          removals.push_back({r, drop(std::move(without), j), DistanceToSegment(meeting, at(i), at(j))});
        } else if (n > 4 && before.dot(after) > 0.0) {
          removals.push_back({r, drop(drop(ring, std::max(i, j)), std::min(i, j)), (at(j) - at(i)).norm()});
        }
      }
    }
    std::erase_if(removals, [&](const Removal& removal) { return !(removal.change_m < most_m); });
    std::sort(removals.begin(), removals.end(),
              [](const Removal& a, const Removal& b) { return a.change_m < b.change_m; });
    if (removals.size() > kMostTries) removals.resize(kMostTries);
    return removals;
  }

  const std::vector<Silhouette>& silhouettes_;
  HeightPrior prior_;
  double step_px_;
  double weight_;                        ///< Share of the points that err by themselves.
  std::vector<std::vector<Mark>> seen_;  ///< For each silhouette.
  Prism prism_;
  double highest_m_ = std::numeric_limits<double>::infinity();
  MatrixXd normal_;
  bool is_valid_ = false;
  double explained_ratio_ = 0.0;
  double cost_ = std::numeric_limits<double>::infinity();
};

/// Standard deviations within which outlines lie at first: poses and starts are off. What was carved from the
/// only silhouette lies in it, and must not be drawn away by openings that are near.
double FirstScale(const std::vector<Silhouette>& silhouettes) {
  if (silhouettes.size() == 1) return kFarthest;
  constexpr double kStart_px = 8.0;
  double most_px = 0.0;
  for (const Silhouette& s : silhouettes) {
    const double pose_px =
        s.view.intrinsics.fx_px *
        (s.view.orientation_std_rad + s.view.position_std_m / s.view.map_from_camera.translation_m.z());
    most_px = std::max(most_px, pose_px);
  }
  return (kStart_px + 2.0 * most_px) / kOutlineStd_px;
}

bool CanStart(const std::vector<Silhouette>& silhouettes, const Polygon& start, const HeightPrior& prior) {
  return start.outer.size() >= 3 && prior.value_m > 0.0 &&
         std::all_of(silhouettes.begin(), silhouettes.end(), [&](const Silhouette& s) {
           return prior.value_m < s.view.map_from_camera.translation_m.z();
         });
}

}  // namespace

PrismFit FitPrism(const std::vector<Silhouette>& silhouettes, const Polygon& start,
                  const HeightPrior& prior) {
  if (!CanStart(silhouettes, start, prior)) return {};
  Fitter fitter(silhouettes, start, prior, kStep_px);
  fitter.Fit(FirstScale(silhouettes), 8);
  fitter.Simplify();
  fitter.Fit(kFarthest, 2);
  return fitter.Result();
}

PrismFit FitRoughly(const std::vector<Silhouette>& silhouettes, const Polygon& start,
                    const HeightPrior& prior) {
  if (!CanStart(silhouettes, start, prior)) return {};
  Fitter fitter(silhouettes, start, prior, kRoughStep_px);
  fitter.Fit(FirstScale(silhouettes), 5);
  return fitter.Result();
}

}  // namespace soffit
