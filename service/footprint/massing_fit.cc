#include "service/footprint/massing_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "service/footprint/carve.h"
#include "service/footprint/cross.h"
#include "service/footprint/mark.h"
#include "service/footprint/simpler.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::RowVector2d;
using Eigen::RowVector3d;
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
constexpr double kHighestRatio = 0.9;   ///< Of the lowest camera's height: no building reaches nearer to it.
constexpr double kExactStd = 1e-6;      ///< For what is said to be known exactly.
constexpr double kMassingStarts = 4.0;  ///< How much farther off than others starts with levels may be.

double Robust(double distance_px, double scale) {
  const double squared = distance_px * distance_px / (kOutlineStd_px * kOutlineStd_px);
  return squared / (1.0 + squared / (scale * scale));
}

/// Of a point of the building: where its picture is, and how that moves with the point.
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

/// Normal equations of weighted least squares.
struct Equations {
  /// By how much a residual changes with the parameters; one may be named more than once.
  using Row = std::vector<std::pair<Index, double>>;

  explicit Equations(Index size) : normal(MatrixXd::Zero(size, size)), right(VectorXd::Zero(size)) {}
  void Add(const Row& row, double residual, double weight) {
    for (const auto& [r, by_r] : row) {
      right(r) += weight * residual * by_r;
      for (const auto& [c, by_c] : row) normal(r, c) += weight * by_r * by_c;
    }
  }

  MatrixXd normal;
  VectorXd right;
};

bool LooksDown(const View& view) {
  return (view.map_from_camera.rotation * Vector3d::UnitZ()).z() < -std::sqrt(0.5) + 1e-6;
}

class Fitter {
 public:
  Fitter(const std::vector<Silhouette>& silhouettes, Massing start, const HeightPrior& prior, double step_px)
      : silhouettes_(silhouettes),
        prior_(prior),
        step_px_(step_px),
        weight_(std::min(1.0, step_px / kSpacing_px)),
        massing_(std::move(start)) {
    for (const Silhouette& s : silhouettes) {
      views_.push_back(s.view);
      seen_.push_back(SampleOutline(s, step_px));
      if (LooksDown(s.view))
        highest_m_ = std::min(highest_m_, kHighestRatio * s.view.map_from_camera.translation_m.z());
    }
    highest_m_ = std::max(highest_m_, prior.value_m);
  }

  /// From the massing as it is.
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
    constexpr double kMostChange_px = 15.0;
    const double most_m = kMostChange_px * GroundSampling_m(silhouettes_.front());
    const auto is_taken = [this](Massing& simpler) { return TryInstead(std::move(simpler), 4); };
    for (bool is_simpler = true; is_simpler;) {
      std::vector<Massing> simpler = WithFewerCorners(massing_, most_m);
      is_simpler = std::any_of(simpler.begin(), simpler.end(), is_taken);
    }
  }

  /// Makes sides go straight on at levels, and takes levels out, where that makes the whole cheaper.
  void Straighten() {
    for (std::size_t l = 0; l < massing_.is_free.size(); ++l) {
      for (std::size_t side = 0; side < massing_.is_free[l].size(); ++side) {
        if (massing_.is_free[l][side]) TryInstead(WithoutInset(massing_, l, side), 3);
      }
    }
    for (std::size_t l = massing_.levels.size(); l-- > 0 && massing_.levels.size() > 1;)
      TryInstead(WithoutLevel(massing_, l), 3);
  }

  MassingFit Result() const {
    MassingFit fit;
    if (!is_valid_) return fit;
    fit.polygon.outer = massing_.rings.front();
    fit.polygon.holes.assign(massing_.rings.begin() + 1, massing_.rings.end());
    fit.height_m = massing_.height_m();
    fit.levels = massing_.levels;
    fit.cost = cost_;
    fit.explained_ratio = explained_ratio_;
    const MatrixXd covariance = normal_.ldlt().solve(MatrixXd::Identity(normal_.rows(), normal_.cols()));
    for (std::size_t i = 0; i < fit.polygon.outer.size(); ++i) {
      const auto at = static_cast<Index>(2 * i);
      fit.corner_std_m.push_back(std::sqrt(std::max(covariance(at, at), covariance(at + 1, at + 1))));
    }
    const Index at = Layout(massing_).roof_height;
    fit.height_std_m = std::sqrt(covariance(at, at));
    fit.views = views_;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const Index pose_at = Layout(massing_).size + static_cast<Index>(6 * v);
      const Eigen::Matrix<double, 6, 6> pose = normal_.block<6, 6>(pose_at, pose_at).inverse();
      fit.views[v].position_std_m = std::sqrt(pose.diagonal().head<3>().mean());
      fit.views[v].orientation_std_rad = std::sqrt(pose.diagonal().tail<3>().mean());
    }
    return fit;
  }

 private:
  /// Whether a massing that is simpler makes the whole cheaper; then it is taken.
  bool TryInstead(Massing massing, int steps) {
    Fitter simpler = *this;
    simpler.massing_ = std::move(massing);
    simpler.Fit(2.0 * kFarthest, steps);
    if (!(simpler.cost_ < cost_)) return false;
    massing_ = simpler.massing_;
    views_ = simpler.views_;
    cost_ = simpler.cost_;
    explained_ratio_ = simpler.explained_ratio_;
    normal_ = simpler.normal_;
    is_valid_ = true;
    return true;
  }

  /// One step of Gauss-Newton; points farther than `scale` standard deviations are hardly heard.
  void Step(double scale) {
    const Wireframe frame = FrameOf(massing_);
    const Layout layout(massing_);
    Equations equations(layout.size + static_cast<Index>(6 * views_.size()));
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const Index pose_at = layout.size + static_cast<Index>(6 * v);
      const std::vector<Mark> predicted = PredictOutline(frame, views_[v], step_px_);
      for (const Mark& mark : seen_[v]) {
        const NearestMark nearest = FindNearest(mark, predicted, step_px_);
        if (std::isfinite(nearest.distance_px))
          Draw(mark, frame, predicted[nearest.index].edge, views_[v], pose_at, scale, equations);
      }
      AddPosePrior(v, pose_at, equations);
    }
    const double height_std = std::max(prior_.std_m, kExactStd);
    equations.Add({{layout.roof_height, 1.0}}, prior_.value_m - massing_.height_m(),
                  1.0 / (height_std * height_std));
    MatrixXd& normal = equations.normal;
    normal_ = normal;
    constexpr double kUnseenStd_m = 1.0;  // Of what no outline tells.
    for (Index i = 0; i < layout.size; ++i) {
      normal_(i, i) += 1.0 / (kUnseenStd_m * kUnseenStd_m);
      normal(i, i) += 1.0 / (kUnseenStd_m * kUnseenStd_m) + 1e-3 * normal(i, i);
    }
    Move(normal.ldlt().solve(equations.right), layout);
  }

  /// Draws an edge towards a mark, across it, with all that is adjusted.
  void Draw(const Mark& mark, const Wireframe& frame, std::size_t edge, const View& view, Index pose_at,
            double scale, Equations& equations) const {
    const auto& [from, to] = frame.edges[edge];
    const Projected a = ProjectPoint(view, frame.corners[from].in_map_m);
    const Projected b = ProjectPoint(view, frame.corners[to].in_map_m);
    const Vector2d side = b.pixel - a.pixel;
    const Vector2d across = Vector2d(-side.y(), side.x()).normalized();
    const double share = std::clamp((mark.pixel - a.pixel).dot(side) / side.squaredNorm(), 0.0, 1.0);
    const double residual = across.dot(mark.pixel - a.pixel);
    const double inlier =
        1.0 / (1.0 + residual * residual / (kOutlineStd_px * kOutlineStd_px * scale * scale));
    const RowVector2d at_a = (1.0 - share) * across.transpose(), at_b = share * across.transpose();
    const RowVector3d by_a = at_a * a.by_point, by_b = at_b * b.by_point;
    const RowVector3d by_turn = at_a * a.by_turn + at_b * b.by_turn;
    Equations::Row row;
    for (const auto& [parameter, by] : frame.corners[from].by) row.emplace_back(parameter, by_a * by);
    for (const auto& [parameter, by] : frame.corners[to].by) row.emplace_back(parameter, by_b * by);
    for (int k = 0; k < 3; ++k) {
      row.emplace_back(pose_at + k, -(by_a + by_b)(k));
      row.emplace_back(pose_at + 3 + k, by_turn(k));
    }
    equations.Add(row, residual, weight_ * inlier * inlier / (kOutlineStd_px * kOutlineStd_px));
  }

  static Eigen::Matrix<double, 6, 1> PoseStd(const View& reported) {
    Eigen::Matrix<double, 6, 1> std;
    std.head<3>().setConstant(std::max(reported.position_std_m, kExactStd));
    std.tail<3>().setConstant(std::max(reported.orientation_std_rad, kExactStd));
    return std;
  }

  /// Of a view: position and rotation vector since it was reported, in standard deviations.
  Eigen::Matrix<double, 6, 1> Moved(std::size_t v) const {
    const Pose<Map, Camera>& now = views_[v].map_from_camera;
    const Pose<Map, Camera>& reported = silhouettes_[v].view.map_from_camera;
    const Eigen::AngleAxisd turn(now.rotation * reported.rotation.conjugate());
    Eigen::Matrix<double, 6, 1> moved;
    moved << now.translation_m - reported.translation_m, turn.angle() * turn.axis();
    return moved.cwiseQuotient(PoseStd(silhouettes_[v].view));
  }

  void AddPosePrior(std::size_t v, Index at, Equations& equations) const {
    const Eigen::Matrix<double, 6, 1> std = PoseStd(silhouettes_[v].view);
    equations.normal.diagonal().segment<6>(at) += std.cwiseProduct(std).cwiseInverse();
    equations.right.segment<6>(at) -= Moved(v).cwiseQuotient(std);
  }

  void Move(const VectorXd& change, const Layout& layout) {
    if (!change.allFinite()) {
      is_valid_ = false;
      return;
    }
    VectorXd of_massing = change.head(layout.size);
    const double height_m = massing_.height_m();
    of_massing(layout.roof_height) =
        std::clamp(height_m + of_massing(layout.roof_height), 0.3 * height_m, highest_m_) - height_m;
    massing_ = Changed(massing_, of_massing);
    Index at = layout.size;
    for (View& view : views_) {
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
    if (!IsSimple(massing_.rings.front()) || !(SignedArea(massing_.rings.front()) > 0.0)) return false;
    return std::all_of(massing_.rings.begin() + 1, massing_.rings.end(), [&](const Ring& hole) {
      return IsSimple(hole) && SignedArea(hole) < 0.0 &&
             std::all_of(hole.begin(), hole.end(),
                         [&](const Vector2d& p) { return Contains(massing_.rings.front(), p); });
    });
  }

  /// The cost; notes how much is explained.
  double Judge() {
    const Wireframe frame = FrameOf(massing_);
    double squares = 0.0;
    double explained = 0.0;
    double all = 0.0;
    for (std::size_t v = 0; v < views_.size(); ++v) {
      const std::vector<Mark> predicted = PredictOutline(frame, views_[v], step_px_);
      for (const Mark& mark : seen_[v]) {
        const double distance_px = std::min(1e6, FindNearest(mark, predicted, step_px_).distance_px);
        squares += weight_ * Robust(distance_px, kFarthest);
        explained += distance_px < kFarthest * kOutlineStd_px ? 1.0 : 0.0;
        all += 1.0;
      }
      squares += Moved(v).squaredNorm();
      if (!IsWhole(silhouettes_[v])) continue;
      for (const Mark& mark : predicted) {
        squares +=
            weight_ * Robust(std::min(1e6, FindNearest(mark, seen_[v], step_px_).distance_px), kFarthest);
      }
    }
    explained_ratio_ = all > 0.0 ? explained / all : 0.0;
    const double height_std = std::max(prior_.std_m, kExactStd);
    const double height_error = (massing_.height_m() - prior_.value_m) / height_std;
    double price = 0.0;
    for (const Ring& ring : massing_.rings) price += PriceOf(ring);
    const Layout layout(massing_);
    price += kCornerPrice * static_cast<double>(layout.size - layout.height.front() - 1);
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

  const std::vector<Silhouette>& silhouettes_;
  HeightPrior prior_;
  double step_px_;
  double weight_;                        ///< Share of the points that err by themselves.
  std::vector<std::vector<Mark>> seen_;  ///< For each silhouette.
  Massing massing_;
  std::vector<View> views_;
  double highest_m_ = std::numeric_limits<double>::infinity();
  MatrixXd normal_;
  bool is_valid_ = false;
  double explained_ratio_ = 0.0;
  double cost_ = std::numeric_limits<double>::infinity();
};

/// Standard deviations within which outlines lie at first: poses and starts are off. What was carved from the
/// only silhouette lies in it, and must not be drawn away by openings that are near.
double FirstScale(const std::vector<Silhouette>& silhouettes, const Vector2d& middle) {
  if (silhouettes.size() == 1) return kFarthest;
  constexpr double kStart_px = 8.0;
  double most_px = 0.0;
  for (const Silhouette& s : silhouettes) {
    const Vector3d& camera = s.view.map_from_camera.translation_m;
    const double range_m = LooksDown(s.view) ? camera.z() : (camera.head<2>() - middle).norm();
    const double pose_px =
        s.view.intrinsics.fx_px * (s.view.orientation_std_rad + s.view.position_std_m / range_m);
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

MassingFit FitPrism(const std::vector<Silhouette>& silhouettes, const Polygon& start,
                    const HeightPrior& prior) {
  if (!CanStart(silhouettes, start, prior)) return {};
  Fitter fitter(silhouettes, Upright(start, prior.value_m), prior, kStep_px);
  fitter.Fit(FirstScale(silhouettes, Centroid(start)), 8);
  fitter.Simplify();
  fitter.Fit(kFarthest, 2);
  return fitter.Result();
}

MassingFit FitRoughly(const std::vector<Silhouette>& silhouettes, const Polygon& start,
                      const HeightPrior& prior) {
  if (!CanStart(silhouettes, start, prior)) return {};
  Fitter fitter(silhouettes, Upright(start, prior.value_m), prior, kRoughStep_px);
  fitter.Fit(FirstScale(silhouettes, Centroid(start)), 5);
  return fitter.Result();
}

MassingFit FitMassing(const std::vector<Silhouette>& silhouettes, const Massing& start) {
  SOFFIT_EXPECT(!start.rings.empty() && !start.levels.empty());
  Fitter fitter(silhouettes, start, {start.height_m()}, kStep_px);
  fitter.Fit(kMassingStarts * FirstScale(silhouettes, Centroid({start.rings.front(), {}})), 12);
  fitter.Simplify();
  fitter.Straighten();
  fitter.Fit(kFarthest, 3);
  return fitter.Result();
}

}  // namespace soffit
