#include "service/outline/ring_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/result/result.h"

namespace soffit {
namespace {

using Eigen::Vector2d;

constexpr double kSidePrice = 25.0;  ///< In squared standard deviations.
constexpr double kTolerancePerSigma = 2.5;
constexpr std::size_t kMaxCandidates = 400;
constexpr std::size_t kMaxPoints = 20000;    ///< Of longer boundaries, not every step is looked at.
constexpr std::size_t kAnchorPoints = 1000;  ///< From one fixed candidate to the next: bounds the search.
constexpr double kTrimRatio = 0.12;          ///< Of a side at each end: the median filter rounds corners off.
constexpr double kMinCornerSine = 0.12;

/// At most kMaxPoints of the points, evenly.
std::vector<Vector2d> Thin(std::vector<Vector2d> points) {
  const std::size_t stride = (points.size() + kMaxPoints - 1) / kMaxPoints;
  if (stride <= 1) return points;
  std::vector<Vector2d> kept;
  for (std::size_t i = 0; i < points.size(); i += stride) kept.push_back(points[i]);
  return kept;
}

/// Middles of equal steps along the boundary: they scatter evenly about the true side of a staircase.
std::vector<Vector2d> Sample(const Ring& boundary, double step) {
  std::vector<Vector2d> points;
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    const Vector2d& a = boundary[i];
    const Vector2d side = boundary[(i + 1) % boundary.size()] - a;
    const int count = std::max(1, static_cast<int>(std::lround(side.norm() / step)));
    for (int k = 0; k < count; ++k) points.push_back(a + side * ((k + 0.5) / count));
  }
  return Thin(std::move(points));
}

struct Line {
  Vector2d point = Vector2d::Zero();
  Vector2d direction = Vector2d::Zero();  ///< Unit, along the boundary.
  double squares = 0.0;                   ///< Sum of squared distances.
  double count = 0.0;
};

/// Total least squares lines through runs of a closed sequence of points, each in constant time.
class LineFitter {
 public:
  explicit LineFitter(const std::vector<Vector2d>& points) : points_(points), sums_(2 * points.size() + 1) {
    origin_ = points.front();
    for (std::size_t i = 0; i < 2 * points.size(); ++i) {
      const Vector2d p = points[i % points.size()] - origin_;
      Sums& next = sums_[i + 1];
      next.p = sums_[i].p + p;
      next.xx = sums_[i].xx + p.x() * p.x();
      next.xy = sums_[i].xy + p.x() * p.y();
      next.yy = sums_[i].yy + p.y() * p.y();
    }
  }

  /// Points `from` to `to`, both included; `from` <= `to` < 2 n.
  Line Fit(std::size_t from, std::size_t to) const {
    const Spread spread = SpreadOf(from, to);
    const double angle = 0.5 * std::atan2(2.0 * spread.xy, spread.xx - spread.yy);
    Line line{spread.mean + origin_, Vector2d(std::cos(angle), std::sin(angle)), SquaresOf(spread),
              spread.count};
    const Vector2d along = points_[to % points_.size()] - points_[from % points_.size()];
    if (line.direction.dot(along) < 0.0) line.direction = -line.direction;
    return line;
  }

  /// Sum of squared distances of the points from the line through them.
  double Squares(std::size_t from, std::size_t to) const { return SquaresOf(SpreadOf(from, to)); }

 private:
  struct Sums {
    Vector2d p = Vector2d::Zero();
    double xx = 0.0, xy = 0.0, yy = 0.0;
  };
  struct Spread {
    double count = 0.0;
    Vector2d mean = Vector2d::Zero();
    double xx = 0.0, xy = 0.0, yy = 0.0;  ///< About the mean.
  };

  Spread SpreadOf(std::size_t from, std::size_t to) const {
    const Sums& a = sums_[from];
    const Sums& b = sums_[to + 1];
    const double n = static_cast<double>(to - from + 1);
    const Vector2d mean = (b.p - a.p) / n;
    return {n, mean, b.xx - a.xx - n * mean.x() * mean.x(), b.xy - a.xy - n * mean.x() * mean.y(),
            b.yy - a.yy - n * mean.y() * mean.y()};
  }
  static double SquaresOf(const Spread& spread) {
    const double difference = spread.xx - spread.yy;
    const double root = std::sqrt(difference * difference + 4.0 * spread.xy * spread.xy);
    return std::max(0.0, 0.5 * (spread.xx + spread.yy - root));
  }

  const std::vector<Vector2d>& points_;
  Vector2d origin_;
  std::vector<Sums> sums_;
};

/// Douglas-Peucker on points [from, to] of the closed sequence; marks the points that stay.
void MarkCandidates(const std::vector<Vector2d>& points, std::size_t from, std::size_t to, double tolerance,
                    std::vector<bool>& stays) {
  const std::size_t n = points.size();
  std::vector<std::pair<std::size_t, std::size_t>> open = {{from, to}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    double farthest = tolerance;
    std::size_t at = a;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double distance = DistanceToSegment(points[i % n], points[a % n], points[b % n]);
      if (distance > farthest) {
        farthest = distance;
        at = i;
      }
    }
    if (at == a) continue;
    stays[at % n] = true;
    open.emplace_back(a, at);
    open.emplace_back(at, b);
  }
}

std::size_t FarthestFrom(const std::vector<Vector2d>& points, const Vector2d& center) {
  const auto farther = [&](const Vector2d& a, const Vector2d& b) {
    return (a - center).squaredNorm() < (b - center).squaredNorm();
  };
  return static_cast<std::size_t>(std::max_element(points.begin(), points.end(), farther) - points.begin());
}

/// Indices of the points at which a side may end, from `first` on, and once more `first` + n at the end.
std::vector<std::size_t> FindCandidates(const std::vector<Vector2d>& points, double tolerance) {
  const std::size_t n = points.size();
  Vector2d mean = Vector2d::Zero();
  for (const Vector2d& p : points) mean += p / static_cast<double>(n);
  const std::size_t first = FarthestFrom(points, mean);
  const std::size_t second = FarthestFrom(points, points[first]);
  std::vector<std::size_t> anchors = {second > first ? second : second + n};
  for (std::size_t i = first; i < first + n; i += kAnchorPoints) anchors.push_back(i);
  std::sort(anchors.begin(), anchors.end());
  anchors.push_back(first + n);
  std::vector<std::size_t> candidates;
  do {
    std::vector<bool> stays(n, false);
    for (std::size_t i = 0; i + 1 < anchors.size(); ++i) {
      stays[anchors[i] % n] = true;
      MarkCandidates(points, anchors[i], anchors[i + 1], tolerance, stays);
    }
    candidates.clear();
    for (std::size_t i = first; i < first + n; ++i) {
      if (stays[i % n]) candidates.push_back(i);
    }
    tolerance *= 1.5;
  } while (candidates.size() > kMaxCandidates);
  candidates.push_back(first + n);
  return candidates;
}

/// The cheapest chain of sides from the first candidate round to itself.
std::vector<std::size_t> ChooseBreakpoints(const LineFitter& fitter,
                                           const std::vector<std::size_t>& candidates, double sigma) {
  std::vector<double> price(candidates.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> previous(candidates.size(), 0);
  price[0] = 0.0;
  for (std::size_t j = 1; j < candidates.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      if (i == 0 && j + 1 == candidates.size()) continue;
      const double squares = fitter.Squares(candidates[i], candidates[j]);
      const double sum = price[i] + squares / (sigma * sigma) + kSidePrice;
      if (sum < price[j]) {
        price[j] = sum;
        previous[j] = i;
      }
    }
  }
  std::vector<std::size_t> breakpoints;
  for (std::size_t j = previous.back();; j = previous[j]) {
    breakpoints.push_back(candidates[j]);
    if (j == 0) break;
  }
  std::reverse(breakpoints.begin(), breakpoints.end());
  return breakpoints;
}

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Where two neighbouring sides meet. Nearly parallel ones meet where the boundary was broken.
Vector2d MeetSides(const Line& a, const Line& b, const Vector2d& breakpoint, double reach) {
  const double sine = Cross(a.direction, b.direction);
  if (std::abs(sine) >= kMinCornerSine) {
    const Vector2d corner = a.point + a.direction * (Cross(b.point - a.point, b.direction) / sine);
    if ((corner - breakpoint).norm() <= reach / std::abs(sine)) return corner;
  }
  const auto foot = [&](const Line& line) -> Vector2d {
    return line.point + line.direction * line.direction.dot(breakpoint - line.point);
  };
  return 0.5 * (foot(a) + foot(b));
}

struct FitSide {
  Line line;
  Vector2d start;    ///< The breakpoint before it.
  std::size_t from;  ///< Points [from, to] of the closed sequence, from <= to < 2 n.
  std::size_t to;
};

FitSide Fit(const LineFitter& fitter, const std::vector<Vector2d>& points, std::size_t from, std::size_t to) {
  const std::size_t base = from >= points.size() ? points.size() : 0;
  const auto trim = static_cast<std::size_t>(kTrimRatio * static_cast<double>(to - from));
  return {fitter.Fit(from - base + trim, to - base - trim), points[from - base], from - base, to - base};
}

/// Neighbours that one line explains within `tolerance` become one side.
void JoinStraightSides(std::vector<FitSide>& sides, const LineFitter& fitter,
                       const std::vector<Vector2d>& points, double tolerance) {
  for (std::size_t i = 0; i < sides.size() && sides.size() > 3;) {
    FitSide& side = sides[i];
    const FitSide& next = sides[(i + 1) % sides.size()];
    const Vector2d& end = points[next.to % points.size()];
    if (DistanceToSegment(next.start, side.start, end) < tolerance &&
        (next.start - side.start).dot(end - next.start) > 0.0) {
      side = Fit(fitter, points, side.from, side.to + (next.to - next.from));
      sides.erase(sides.begin() + static_cast<std::ptrdiff_t>((i + 1) % sides.size()));
      if (i == sides.size()) --i;
    } else {
      ++i;
    }
  }
}

/// Takes out the short sides across corners that a median filter or coarse pixels rounded off: those whose
/// neighbours meet, when extended, within `reach` of them.
void SharpenCorners(std::vector<FitSide>& sides, double reach) {
  for (std::size_t i = 0; i < sides.size() && sides.size() > 3;) {
    const std::size_t n = sides.size();
    const FitSide& before = sides[(i + n - 1) % n];
    FitSide& after = sides[(i + 1) % n];
    const double sine = Cross(before.line.direction, after.line.direction);
    const double length = (after.start - sides[i].start).norm();
    const double shorter = std::min(before.line.count, after.line.count);
    bool is_bevel = std::abs(sine) > 0.3 && length < 0.7 * shorter;
    if (is_bevel) {
      const Vector2d corner =
          before.line.point +
          before.line.direction * (Cross(after.line.point - before.line.point, after.line.direction) / sine);
      is_bevel = DistanceToSegment(corner, sides[i].start, after.start) <= reach;
      if (is_bevel) after.start = corner;
    }
    if (is_bevel) {
      sides.erase(sides.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
}

double SideStd(const Line& line) {
  constexpr double kCorrelatedPoints = 4.0;  // Neighbours on a staircase err alike.
  return std::sqrt((line.squares / line.count + 1.0 / 12.0) / std::max(1.0, line.count / kCorrelatedPoints));
}

}  // namespace

FittedRing FitRing(const Ring& boundary, double step, double tolerance) {
  SOFFIT_EXPECT(step > 0.0 && tolerance > 0.0);
  if (boundary.size() < 3) return {};
  std::vector<Vector2d> points = Sample(boundary, step);
  for (Vector2d& p : points) p /= step;
  const double reach = 4.0 * tolerance / step;
  const double sigma = tolerance / step / kTolerancePerSigma;
  const LineFitter fitter(points);
  const std::vector<std::size_t> candidates = FindCandidates(points, 0.6 * tolerance / step);
  const std::vector<std::size_t> breaks = ChooseBreakpoints(fitter, candidates, sigma);
  if (breaks.size() < 3) return {};

  const std::size_t n = points.size();
  std::vector<FitSide> sides;
  Ring unfitted;
  for (std::size_t i = 0; i < breaks.size(); ++i) {
    const std::size_t from = breaks[i];
    const std::size_t to = i + 1 < breaks.size() ? breaks[i + 1] : breaks[0] + n;
    sides.push_back(Fit(fitter, points, from, to));
    unfitted.push_back(step * points[from % n]);
  }
  JoinStraightSides(sides, fitter, points, 0.4 * tolerance / step);
  SharpenCorners(sides, 2.0 * tolerance / step);
  FittedRing fitted;
  double squares = 0.0;
  double count = 0.0;
  for (const FitSide& side : sides) {
    squares += side.line.squares;
    count += side.line.count;
  }
  fitted.roughness = step * std::sqrt(squares / count);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Line& before = sides[(i + sides.size() - 1) % sides.size()].line;
    const Line& after = sides[i].line;
    fitted.ring.push_back(step * MeetSides(before, after, sides[i].start, reach));
    const double sine = std::max(0.3, std::abs(Cross(before.direction, after.direction)));
    fitted.corner_std.push_back(step * std::hypot(SideStd(before), SideStd(after)) / sine);
  }
  if (!IsSimple(fitted.ring) || SignedArea(fitted.ring) * SignedArea(boundary) <= 0.0) {
    if (!IsSimple(unfitted) || SignedArea(unfitted) * SignedArea(boundary) <= 0.0) return {};
    fitted.corner_std.assign(unfitted.size(), tolerance);
    fitted.ring = std::move(unfitted);
  }
  return fitted;
}

Ring ThinRing(const Ring& staircase, double tolerance_px) {
  const std::vector<Vector2d> points = Sample(staircase, 1.0);
  Ring ring;
  std::vector<std::size_t> kept = FindCandidates(points, tolerance_px);
  kept.pop_back();
  for (const std::size_t i : kept) ring.push_back(points[i % points.size()]);
  return ring;
}

}  // namespace soffit
