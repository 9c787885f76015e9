#include "service/outline/ring_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "service/outline/arc_fit.h"
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
constexpr double kSidesPerArc = 2.5;  ///< An arc has five numbers, a side two.
constexpr std::size_t kMinSidesOfArc = 3;
constexpr std::size_t kMaxArcPoints = 150;  ///< Of longer arcs, not every point is looked at.
constexpr double kMaxTurnOnArc_rad = 1.3;
constexpr double kMaxChordRatio = 4.0;     ///< Of the longest chord of an arc to the shortest.
constexpr double kBulgeRatio = 1.0 / 3.0;  ///< From an arc to its chords, of the tolerance.

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
  std::size_t farthest = 0;
  double greatest = -1.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double squared = (points[i] - center).squaredNorm();
    if (squared <= greatest) continue;
    greatest = squared;
    farthest = i;
  }
  return farthest;
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

/// A straight side, or a curved one.
struct FitSide {
  Line line;         ///< Of an arc: the chord.
  Vector2d start;    ///< The breakpoint before it.
  std::size_t from;  ///< Points [from, to] of the closed sequence, from <= to < 2 n.
  std::size_t to;
  std::optional<Arc> arc = {};
  double turn_rad = 0.0;  ///< Of an arc: from its start to its end.
};

FitSide Fit(const LineFitter& fitter, const std::vector<Vector2d>& points, std::size_t from, std::size_t to) {
  const std::size_t base = from >= points.size() ? points.size() : 0;
  const auto trim = static_cast<std::size_t>(kTrimRatio * static_cast<double>(to - from));
  return {fitter.Fit(from - base + trim, to - base - trim), points[from - base], from - base, to - base};
}

double TurnBetween(const Vector2d& before, const Vector2d& after) {
  return std::atan2(Cross(before, after), before.dot(after));
}

/// Finds the sides of a ring that are chords of a circle or an ellipse: those that turn gently to one hand,
/// and that an arc explains no worse with fewer numbers.
class ArcFinder {
 public:
  ArcFinder(const std::vector<FitSide>& sides, const LineFitter& fitter, const std::vector<Vector2d>& points,
            double sigma)
      : sides_(sides), fitter_(fitter), points_(points), sigma_(sigma) {}

  /// The sides, with one curved side for each run of chords; from after the longest side on.
  std::vector<FitSide> JoinChords() const {
    const std::size_t n = sides_.size();
    if (CountAlike(0, n + 1) > n) {
      if (const auto whole = Join(0, n)) return {whole->side};
    }
    const std::size_t begin = FindLongest() + 1;
    std::vector<FitSide> joined;
    for (std::size_t i = begin; i < begin + n;) {
      const auto run = JoinLongest(i, begin + n - i);
      joined.push_back(run ? run->side : SideAt(i));
      i += run ? run->count : 1;
    }
    return joined;
  }

 private:
  struct Run {
    std::size_t count = 0;
    FitSide side;
    double saving = 0.0;
  };

  const FitSide& SideAt(std::size_t i) const { return sides_[i % sides_.size()]; }

  std::size_t FindLongest() const {
    const auto shorter = [](const FitSide& a, const FitSide& b) { return a.to - a.from < b.to - b.from; };
    return static_cast<std::size_t>(std::max_element(sides_.begin(), sides_.end(), shorter) - sides_.begin());
  }

  double TurnAfter(std::size_t i) const {
    return TurnBetween(SideAt(i).line.direction, SideAt(i + 1).line.direction);
  }

  /// How many sides from `first` on turn gently to the same hand, and are about as long.
  std::size_t CountAlike(std::size_t first, std::size_t most) const {
    const double hand = TurnAfter(first);
    double shortest = SideAt(first).line.count;
    double longest = shortest;
    std::size_t count = 1;
    for (; count < most; ++count) {
      const double turn = TurnAfter(first + count - 1);
      shortest = std::min(shortest, SideAt(first + count).line.count);
      longest = std::max(longest, SideAt(first + count).line.count);
      if (turn * hand <= 0.0 || std::abs(turn) > kMaxTurnOnArc_rad || longest > kMaxChordRatio * shortest)
        break;
    }
    return count;
  }

  /// The run of chords from side `first` on that is best taken for an arc.
  std::optional<Run> JoinLongest(std::size_t first, std::size_t most) const {
    constexpr int kMaxMisses = 2;
    std::optional<Run> best;
    const std::size_t alike = CountAlike(first, most);
    int misses = 0;
    for (std::size_t count = kMinSidesOfArc; count <= alike && misses < kMaxMisses; ++count) {
      const std::optional<Run> run = Join(first, count);
      if (run && (!best || run->saving > best->saving)) best = run;
      misses = run ? 0 : misses + 1;
    }
    return best;
  }

  std::optional<Run> Join(std::size_t first, std::size_t count) const {
    double squares = 0.0;
    double turn = 0.0;
    std::size_t steps = 0;
    for (std::size_t i = first; i < first + count; ++i) {
      const FitSide& side = SideAt(i);
      squares += fitter_.Squares(side.from, side.to);
      steps += side.to - side.from;
      if (i + 1 < first + count) turn += TurnAfter(i);
    }
    const std::size_t stride = steps / kMaxArcPoints + 1;
    std::vector<Vector2d> points;
    for (std::size_t i = 0; i <= steps; i += stride) {
      points.push_back(points_[(SideAt(first).from + i) % points_.size()]);
    }
    const double length = static_cast<double>(steps + 1);
    const double share = static_cast<double>(points.size()) / length;
    const double price = kSidePrice * sigma_ * sigma_;
    const std::optional<Arc> arc = FitArc(points, share * price);
    if (!arc || arc->squares / share > squares) return std::nullopt;
    Run run{count, SideAt(first), 0.0};
    run.saving = (squares - arc->squares / share) / price + static_cast<double>(count) - kSidesPerArc;
    if (run.saving <= 0.0) return std::nullopt;
    run.side.to = run.side.from + steps;
    run.side.line.squares = arc->squares / share;
    run.side.line.count = length;
    run.side.turn_rad = turn;
    run.side.arc = arc;
    return run;
  }

  const std::vector<FitSide>& sides_;
  const LineFitter& fitter_;
  const std::vector<Vector2d>& points_;
  double sigma_;
};

/// The line along which a side passes the breakpoint `at` one of its ends.
Line LineAt(const FitSide& side, const Vector2d& at) {
  if (!side.arc) return side.line;
  const double angle = side.arc->AngleOf(at);
  Line tangent = side.line;
  tangent.point = side.arc->PointAt(angle);
  const double quarter = std::copysign(std::numbers::pi / 2.0, side.turn_rad);
  tangent.direction = (side.arc->PointAt(angle + quarter) - side.arc->center).normalized();
  return tangent;
}

/// Points of an arc between the corners at its ends, which may be the same: chords through them enclose its
/// area.
Ring SampleArc(const FitSide& side, const Vector2d& from, const Vector2d& to, double bulge) {
  constexpr double kFullTurn = 2.0 * std::numbers::pi;
  const double hand = std::copysign(1.0, side.turn_rad);
  const double start = side.arc->AngleOf(from);
  double sweep = hand * (side.arc->AngleOf(to) - start);
  sweep += kFullTurn * std::nearbyint((std::abs(side.turn_rad) - sweep) / kFullTurn);
  const bool is_closed = from == to;
  if (is_closed) sweep = kFullTurn;
  const double chord = 2.0 * std::acos(1.0 - std::min(0.5, bulge / side.arc->LongerRadius()));
  const int count = static_cast<int>(std::ceil(sweep / chord));
  Ring ring;
  for (int i = is_closed ? 0 : 1; i < count; ++i) {
    const double step = sweep / count;
    const Vector2d on_arc = side.arc->PointAt(start + hand * step * i);
    ring.push_back(side.arc->center + std::sqrt(step / std::sin(step)) * (on_arc - side.arc->center));
  }
  return ring;
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
    const bool is_straight = !before.arc && !sides[i].arc && !after.arc;
    bool is_bevel = is_straight && std::abs(sine) > 0.3 && length < 0.7 * shorter;
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

/// The ring of sides that meet, and how they scatter.
FittedRing DrawRing(const std::vector<FitSide>& sides, double tolerance) {
  const double reach = 4.0 * tolerance;
  const std::size_t n = sides.size();
  FittedRing drawn;
  Ring corners;
  std::vector<double> stds;
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Line before = LineAt(sides[(i + n - 1) % n], sides[i].start);
    const Line after = LineAt(sides[i], sides[i].start);
    const double sine = std::max(0.3, std::abs(Cross(before.direction, after.direction)));
    corners.push_back(MeetSides(before, after, sides[i].start, reach));
    stds.push_back(std::hypot(SideStd(before), SideStd(after)) / sine);
    squares += after.squares;
    count += after.count;
  }
  drawn.roughness = std::sqrt(squares / count);
  for (std::size_t i = 0; i < n; ++i) {
    if (n > 1) {  // A circle has no corner.
      drawn.ring.push_back(corners[i]);
      drawn.corner_std.push_back(stds[i]);
    }
    if (!sides[i].arc) continue;
    const Ring curve = SampleArc(sides[i], corners[i], corners[(i + 1) % n], kBulgeRatio * tolerance);
    drawn.ring.insert(drawn.ring.end(), curve.begin(), curve.end());
    drawn.corner_std.resize(drawn.ring.size(), SideStd(sides[i].line));
  }
  return drawn;
}

bool IsSound(const Ring& ring, const Ring& boundary) {
  return IsSimple(ring) && SignedArea(ring) * SignedArea(boundary) > 0.0;
}

}  // namespace

FittedRing FitRing(const Ring& boundary, double step, double tolerance) {
  SOFFIT_EXPECT(step > 0.0 && tolerance > 0.0);
  if (boundary.size() < 3) return {};
  std::vector<Vector2d> points = Sample(boundary, step);
  for (Vector2d& p : points) p /= step;
  tolerance /= step;
  const double sigma = tolerance / kTolerancePerSigma;
  const LineFitter fitter(points);
  const std::vector<std::size_t> breaks =
      ChooseBreakpoints(fitter, FindCandidates(points, 0.6 * tolerance), sigma);
  if (breaks.size() < 3) return {};

  const std::size_t n = points.size();
  std::vector<FitSide> sides;
  Ring unfitted;
  for (std::size_t i = 0; i < breaks.size(); ++i) {
    const std::size_t from = breaks[i];
    const std::size_t to = i + 1 < breaks.size() ? breaks[i + 1] : breaks[0] + n;
    sides.push_back(Fit(fitter, points, from, to));
    unfitted.push_back(points[from % n]);
  }
  JoinStraightSides(sides, fitter, points, 0.4 * tolerance);
  sides = ArcFinder(sides, fitter, points, sigma).JoinChords();
  SharpenCorners(sides, 2.0 * tolerance);

  FittedRing fitted = DrawRing(sides, tolerance);
  if (!IsSound(fitted.ring, boundary)) {
    if (!IsSound(unfitted, boundary)) return {};
    fitted.corner_std.assign(unfitted.size(), tolerance);
    fitted.ring = std::move(unfitted);
  }
  fitted.roughness *= step;
  for (Vector2d& p : fitted.ring) p *= step;
  for (double& std : fitted.corner_std) std *= step;
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
