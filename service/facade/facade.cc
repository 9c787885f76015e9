#include "service/facade/facade.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "service/facade/elevation.h"
#include "service/facade/median.h"
#include "service/facade/recess.h"
#include "service/facade/seam.h"
#include "service/facade/wall.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr double kMinVisible = 0.90;       // Of a wall's columns: less does not tell what openings it has.
constexpr double kMinThroughShare = 0.50;  // Of what is seen beyond: clutter far behind may hide the rest.
constexpr double kMinSkyShare = 0.05;      // Of what is seen above the horizon: buildings may hide the rest.
constexpr double kMinDoubtShare = 0.05;    // Background in so little of it is noise on a closed surface.
constexpr double kMinGroundOnlyShare = 0.90;
constexpr double kStraightShare = 0.25;  // Of a head's columns that have to lie on one level.
constexpr double kLevelCells = 2.5;      // From a straight edge: points within are on it.
constexpr double kPixelStd = 0.7;
constexpr double kSameWidthShare = 0.92;  // A gap that narrows less shows no sides of a recess.
constexpr int kHeadSegments = 24;
constexpr int kJambEdgeCells = 3;  // Where colours mix.
constexpr int kLeastJambCells = 6;
constexpr double kSameColor = 14.0;        // Of 255, in each channel.
constexpr double kMostlyBackground = 0.7;  // Of the cells.
constexpr double kPaintedShare = 0.75;     // Of the rows.
constexpr double kJambCells = 2.5;         // A jamb's foot that moves by less does not drift.
constexpr double kJambShare = 0.15;        // Of the horizon's height: so far up its foot is looked at,
constexpr double kJambEnd = 0.9;           // and so far to its end.
constexpr double kThresholdShare = 0.06;   // The same where its end is not known.

bool Is(uchar seen, Seen wanted) { return seen == static_cast<uchar>(wanted); }

/// Top edge of the wall in each of its columns that shows one: structure below, background above.
std::vector<double> FindRoofEdge(const Elevation& view) {
  const int run = std::max(3, view.Row(0.08));
  std::vector<double> tops;
  for (int column = view.seen.cols / 20; column < view.seen.cols - view.seen.cols / 20; ++column) {
    int below = 0;
    int background = 0;
    for (int row = view.seen.rows - 1; row >= 0 && view.is_visible(row, column) != 0; --row) {
      if (Is(view.seen(row, column), Seen::kStructure)) {
        if (++below == run) {
          if (background >= run) tops.push_back((row + run) * view.cell_m);
          break;
        }
      } else {
        background += below + 1;
        below = 0;
      }
    }
  }
  return tops;
}

struct Height {
  double value_m = 0.0;
  double std_m = 0.0;
};

/// The height that the top edges of all walls agree on. A camera above the roof sees its far edge, not the
/// wall's.
Height MeasureHeight(const Footprint& object, const std::vector<Elevation>& views) {
  std::vector<double> tops;
  double std_m = 0.0;
  for (const Elevation& view : views) {
    const std::vector<double> edge = FindRoofEdge(view);
    if (edge.size() < static_cast<std::size_t>(view.seen.cols) / 4) continue;
    const double top = Median(edge);
    if (top <= view.camera_uv_m.y() + view.cell_m) continue;
    tops.push_back(top);
    std_m = std::max(std_m, std::hypot(view.pose_std_m, kPixelStd * view.cell_m));
  }
  if (tops.empty()) return {object.height_m, object.height_std_m};
  return {Median(tops), std_m / std::sqrt(static_cast<double>(tops.size()))};
}

/// A region of a wall that does not show the wall's own surface, as the lowest and highest cell of each
/// column.
struct Gap {
  cv::Rect bounds;
  cv::Mat1b inside;  ///< Size of the elevation, cropped to `bounds`.
  cv::Mat1b open;    ///< `inside` without the wall's half of the seams of mixed colours.
  bool is_standing = false;
};

/// Whether nothing of the wall is seen between a gap and one of the wall's ends, in most rows of the gap:
/// then it is not in the wall but beside it.
bool LiesBeside(const Elevation& view, const Gap& gap) {
  int open_left = 0, open_right = 0;
  for (int row = 0; row < gap.inside.rows; ++row) {
    const uchar* inside = gap.inside[row];
    const uchar* seen = view.seen[gap.bounds.y + row];
    const auto is_structure = [](uchar s) { return Is(s, Seen::kStructure); };
    const int first = static_cast<int>(std::find(inside, inside + gap.inside.cols, 255) - inside);
    if (first == gap.inside.cols) continue;
    int last = gap.inside.cols - 1;
    while (inside[last] == 0) --last;
    open_left += std::none_of(seen, seen + gap.bounds.x + first, is_structure) ? 1 : 0;
    open_right += std::none_of(seen + gap.bounds.x + last, seen + view.seen.cols, is_structure) ? 1 : 0;
  }
  return 2 * std::max(open_left, open_right) > gap.inside.rows;
}

std::vector<Gap> FindGaps(const Elevation& view, double height_m, double min_opening_m) {
  const int rows = std::min(view.seen.rows, view.Row(height_m) - 2);
  if (rows < 4) return {};
  cv::Mat1b gap(rows, view.seen.cols, uchar{0});
  for (int row = 0; row < rows; ++row) {
    for (int column = 2; column < gap.cols - 2; ++column) {
      const bool is_own = Is(view.seen(row, column), Seen::kStructure);
      if (!is_own && view.is_visible(row, column) != 0) gap(row, column) = 255;
    }
  }
  const int reach = std::max(1, static_cast<int>(0.1 * min_opening_m / view.cell_m));
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * reach + 1, 2 * reach + 1));
  cv::Mat1b open;
  cv::bitwise_and(gap, SplitSeams(view).rowRange(0, rows), open);
  cv::morphologyEx(open, open, cv::MORPH_OPEN, kernel);
  cv::morphologyEx(gap, gap, cv::MORPH_OPEN, kernel);
  cv::Mat1i component;
  cv::Mat stats, centers;
  const int count = cv::connectedComponentsWithStats(gap, component, stats, centers, 8, CV_32S);
  std::vector<Gap> gaps;
  const int least = std::max(2, static_cast<int>(min_opening_m / view.cell_m));
  for (int i = 1; i < count; ++i) {
    Gap found;
    found.bounds = {stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                    stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT)};
    found.is_standing = found.bounds.y <= 2 + reach;
    if (found.bounds.width < least || (!found.is_standing && found.bounds.height < least)) continue;
    found.inside = component(found.bounds) == i;
    if (LiesBeside(view, found)) continue;
    cv::bitwise_and(found.inside, open(found.bounds), found.open);
    gaps.push_back(found);
  }
  return gaps;
}

struct Evidence {
  bool is_through = false;
  bool shows_background = false;
  std::string text;
};

/// What a gap shows beyond the building: sky above the horizon and ground below it, or something else.
Evidence WeighBackground(const Elevation& view, const Gap& gap, double shrink) {
  const double horizon = view.camera_uv_m.y();
  const double far_base = horizon * (1.0 - shrink);
  double beyond = 0.0, background = 0.0, above = 0.0, sky = 0.0;
  for (int row = 0; row < gap.inside.rows; ++row) {
    const double v = view.Center(0, row + gap.bounds.y).y();
    if (v < far_base) continue;
    for (int column = 0; column < gap.inside.cols; ++column) {
      if (gap.inside(row, column) == 0) continue;
      const uchar seen = view.seen(row + gap.bounds.y, column + gap.bounds.x);
      ++beyond;
      if (Is(seen, Seen::kSky) || Is(seen, Seen::kGround)) ++background;
      if (v > horizon + 2.0 * view.cell_m) {
        ++above;
        if (Is(seen, Seen::kSky)) ++sky;
      }
    }
  }
  Evidence evidence;
  if (beyond <= 0.0) return {false, false, "nothing beyond it is seen"};
  const double share = background / beyond;
  const bool shows_sky = above > 0.05 * beyond;
  evidence.is_through =
      shows_sky ? share >= kMinThroughShare && sky / above >= kMinSkyShare : share >= kMinGroundOnlyShare;
  evidence.shows_background = share >= kMinDoubtShare;
  std::ostringstream text;
  text.precision(2);
  text << "sky or ground in " << share << " of what is seen through it";
  if (shows_sky) text << ", sky in " << sky / above << " above the horizon";
  evidence.text = text.str();
  return evidence;
}

/// Brings the boundary of a see-through region back to the outline of the mouth. The wall's plane shows the
/// common part of the near mouth and of the far one, which is shrunk about the camera's foot: an edge of the
/// common part that has the camera's foot on its inner side belongs to the far mouth, any other to the near
/// one.
struct Mouth {
  Eigen::Vector2d camera_uv_m;
  double shrink = 1.0;

  double Edge(double seen, double foot, double outward) const {
    return (seen - foot) * outward > 0.0 ? foot + (seen - foot) / shrink : seen;
  }
  double Left(double u) const { return Edge(u, camera_uv_m.x(), -1.0); }
  double Right(double u) const { return Edge(u, camera_uv_m.x(), 1.0); }
  double Bottom(double v) const { return Edge(v, camera_uv_m.y(), -1.0); }
};

struct Span {
  double low = 0.0;
  double high = 0.0;
};

/// A jamb of an opening that stands on the ground, from where its foot runs.
struct Jamb {
  double u_m = 0.0;             ///< Where it begins, in the wall's plane.
  std::optional<double> drift;  ///< Of u for each metre into the building; none: the mouth's edge hides it.
};

struct Jambs {
  Jamb left, right;
  Span Mouth() const { return {left.u_m, right.u_m}; }
};

/// y = value + slope x, from the medians over all pairs of points (H. Theil, P. Sen).
struct SteadyLine {
  double value = 0.0;
  double slope = 0.0;
};

SteadyLine FitSteadyLine(const std::vector<Eigen::Vector2d>& points) {
  std::vector<double> slopes;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j)
      slopes.push_back((points[j].y() - points[i].y()) / (points[j].x() - points[i].x()));
  }
  const double slope = slopes.empty() ? 0.0 : Median(slopes);
  std::vector<double> values;
  for (const Eigen::Vector2d& p : points) values.push_back(p.y() - slope * p.x());
  return {Median(values), slope};
}

/// @param foot  (depth behind the wall's plane, u seen in the wall's plane), deeper ones later; not empty.
Jamb FitJamb(const Elevation& view, std::vector<Eigen::Vector2d> foot) {
  const double reach = kJambCells * view.cell_m;
  const auto drifts = [&](const SteadyLine& line) {
    return std::abs(line.slope) * (foot.back().x() - foot.front().x()) > reach;
  };
  const auto middle = [&] {
    std::vector<double> us;
    for (const Eigen::Vector2d& p : foot) us.push_back(p.y());
    return Median(us);
  };
  if (!drifts(FitSteadyLine(foot))) return {middle(), std::nullopt};
  for (Eigen::Vector2d& p : foot) {
    p.y() = view.camera_uv_m.x() + (p.y() - view.camera_uv_m.x()) * (1.0 + p.x() / view.camera_front_m);
  }
  const SteadyLine line = FitSteadyLine(foot);
  return drifts(line) ? Jamb{line.value, line.slope} : Jamb{middle(), 0.0};
}

/// The jambs of an opening that stands on the ground, from where they meet the ground: a line on the wall's
/// plane that begins where the jamb does, whatever way it leads.
///
/// @param depth_m  To the far mouth; 0: not known.
std::optional<Jambs> MeasureJambs(const Elevation& view, const Gap& gap, double depth_m) {
  const double horizon = view.camera_uv_m.y();
  const double up_to =
      depth_m > 0.0 ? std::min(kJambShare, kJambEnd * depth_m / (view.camera_front_m + depth_m)) * horizon
                    : kThresholdShare * horizon;
  std::vector<Eigen::Vector2d> left, right;
  for (int row = 0; row < gap.inside.rows; ++row) {
    const double v = view.Center(0, row + gap.bounds.y).y();
    if (v < 1.5 * view.cell_m) continue;
    if (v > std::max(4.0 * view.cell_m, up_to)) break;
    int first = -1;
    int last = -1;
    for (int column = 0; column < gap.inside.cols; ++column) {
      if (gap.inside(row, column) == 0) continue;
      if (first < 0) first = column;
      last = column;
    }
    if (first < 0) continue;
    const double below_horizon = std::max(0.05 * horizon, horizon - v);
    if (!(below_horizon > 0.0)) break;
    const double depth = view.camera_front_m * v / below_horizon;
    left.emplace_back(depth, (gap.bounds.x + first) * view.cell_m);
    right.emplace_back(depth, (gap.bounds.x + last + 1) * view.cell_m);
  }
  if (left.empty()) return std::nullopt;
  return Jambs{FitJamb(view, std::move(left)), FitJamb(view, std::move(right))};
}

/// Sides of an opening that does not reach the ground, from its middle rows.
Span MeasureSides(const Elevation& view, const Gap& gap, const Mouth& mouth) {
  std::vector<double> lefts, rights;
  for (int row = gap.inside.rows / 4; row <= 3 * gap.inside.rows / 4 && row < gap.inside.rows; ++row) {
    int first = -1;
    int last = -1;
    for (int column = 0; column < gap.inside.cols; ++column) {
      if (gap.open(row, column) == 0) continue;
      if (first < 0) first = column;
      last = column;
    }
    if (first < 0) continue;
    lefts.push_back(mouth.Left((gap.bounds.x + first) * view.cell_m));
    rights.push_back(mouth.Right((gap.bounds.x + last + 1) * view.cell_m));
  }
  if (lefts.empty()) return {gap.bounds.x * view.cell_m, (gap.bounds.x + gap.bounds.width) * view.cell_m};
  return {Median(lefts), Median(rights)};
}

/// Some cells of one row.
struct Strip {
  cv::Vec3d color;          ///< Their mean.
  double background = 0.0;  ///< Share of them.
};

Strip Summarize(const Elevation& view, int row, int first, int count) {
  Strip strip;
  for (int column = first; column < first + count; ++column) {
    strip.color += cv::Vec3d(view.bgr(row, column)) / count;
    const uchar seen = view.seen(row, column);
    strip.background += Is(seen, Seen::kSky) || Is(seen, Seen::kGround) ? 1.0 / count : 0.0;
  }
  return strip;
}

/// Whether a mouth shows background on both sides, where the jambs of a passage would hide it, and the same
/// as beside that, between them: then it is painted on the wall. False when that cannot be told.
bool LacksJambs(const Elevation& view, const Span& mouth, double bottom, double top, double shrink) {
  const double foot = view.camera_uv_m.x();
  const double horizon = view.camera_uv_m.y();
  if (foot < mouth.low || foot > mouth.high) return false;
  const Span far{foot + (mouth.low - foot) * shrink, foot + (mouth.high - foot) * shrink};
  const int wide = view.Column(std::min(far.low - mouth.low, mouth.high - far.high)) - 2 * kJambEdgeCells;
  const int left = view.Column(far.low);
  const int right = view.Column(far.high);
  if (wide < kLeastJambCells || left < kJambEdgeCells + wide || right + kJambEdgeCells + wide > view.bgr.cols)
    return false;
  const auto goes_on = [&](int row, int beside, int between) {
    const Strip jamb = Summarize(view, row, beside, wide);
    const double apart = cv::norm(jamb.color - Summarize(view, row, between, wide).color, cv::NORM_INF);
    return jamb.background > kMostlyBackground && apart < kSameColor;
  };
  const int first = view.Row(std::max(bottom, horizon * (1.0 - shrink))) + kJambEdgeCells;
  const int last =
      std::min(view.Row(std::min(top, horizon + (top - horizon) * shrink)) - kJambEdgeCells, view.bgr.rows);
  int alike = 0;
  for (int row = first; row < last; ++row) {
    const bool is_left = goes_on(row, left - kJambEdgeCells - wide, left + kJambEdgeCells);
    alike += is_left && goes_on(row, right + kJambEdgeCells, right - kJambEdgeCells - wide) ? 1 : 0;
  }
  return last - first >= kLeastJambCells && alike >= kPaintedShare * (last - first);
}

struct Head {
  double spring_m = 0.0;
  double rise_m = 0.0;  ///< 0: straight.
};

/// The levels of the points from `low` to `high`.
std::vector<double> LevelsBetween(const std::vector<Eigen::Vector2d>& points, double low, double high) {
  std::vector<double> levels;
  for (const Eigen::Vector2d& point : points) {
    if (point.y() >= low && point.y() <= high) levels.push_back(point.y());
  }
  return levels;
}

/// Share of the points that lie within `reach` of level `at`.
double ShareAt(const std::vector<Eigen::Vector2d>& points, double at, double reach) {
  double count = 0.0;
  for (const Eigen::Vector2d& point : points) count += std::abs(point.y() - at) <= reach ? 1.0 : 0.0;
  return count / static_cast<double>(points.size());
}

/// How far from the level of a straight edge its points may lie, brought back to the mouth.
double LevelReach(const Elevation& view, const Mouth& mouth) {
  return kLevelCells * view.cell_m / mouth.shrink;
}

/// The highest level at which a straight edge can lie: things behind an opening may hide more than half of
/// its head, and things in it seem to go on below its sill.
double HighestLevel(const std::vector<Eigen::Vector2d>& points, double reach) {
  std::vector<Eigen::Vector2d> sorted = points;
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.y() > b.y(); });
  const double least = kStraightShare * static_cast<double>(points.size());
  for (const Eigen::Vector2d& candidate : sorted) {
    const std::vector<double> levels = LevelsBetween(points, candidate.y() - 2.0 * reach, candidate.y());
    if (static_cast<double>(levels.size()) >= least) return Median(levels);
  }
  return sorted[sorted.size() / 2].y();
}

/// Least squares of v = spring + rise sqrt(1 - t^2), t from -1 to 1 over the opening, with the worst fifth
/// left out.
Head FitArch(std::vector<Eigen::Vector2d> points, const Span& sides) {
  const double middle = 0.5 * (sides.low + sides.high);
  const double half = 0.5 * (sides.high - sides.low);
  Head head;
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& point : points) {
      const double t = std::clamp((point.x() - middle) / half, -1.0, 1.0);
      const Eigen::Vector2d row(1.0, std::sqrt(1.0 - t * t));
      normal += row * row.transpose();
      right += point.y() * row;
    }
    const Eigen::Vector2d fit = normal.ldlt().solve(right);
    head = {fit.x(), fit.y()};
    const auto residual = [&](const Eigen::Vector2d& point) {
      const double t = std::clamp((point.x() - middle) / half, -1.0, 1.0);
      return std::abs(point.y() - head.spring_m - head.rise_m * std::sqrt(1.0 - t * t));
    };
    std::stable_sort(points.begin(), points.end(),
                     [&](const auto& a, const auto& b) { return residual(a) < residual(b); });
    if (points.size() > 20) points.resize(points.size() * 4 / 5);
  }
  return head;
}

double HeightAt(const Head& head, const Span& sides, double u) {
  const double t = std::clamp((2.0 * u - sides.low - sides.high) / (sides.high - sides.low), -1.0, 1.0);
  return head.spring_m + head.rise_m * std::sqrt(1.0 - t * t);
}

double ShareOn(const std::vector<Eigen::Vector2d>& points, const Head& head, const Span& sides,
               double reach) {
  double count = 0.0;
  const double step = 1e-3 * (sides.high - sides.low);
  for (const Eigen::Vector2d& point : points) {
    const double height = HeightAt(head, sides, point.x());
    const double slope =
        (HeightAt(head, sides, point.x() + step) - HeightAt(head, sides, point.x() - step)) / (2.0 * step);
    count += std::abs(point.y() - height) <= reach * std::hypot(1.0, slope) ? 1.0 : 0.0;  // Across the arch.
  }
  return count / static_cast<double>(points.size());
}

/// The upper boundary of a gap, brought back to the mouth as if it were straight (its edge faces up
/// everywhere), or as if it were an arch (its edge faces away from the middle).
std::vector<Eigen::Vector2d> TraceHead(const Elevation& view, const Gap& gap, const Mouth& mouth,
                                       const Span& sides, bool is_arch) {
  std::vector<Eigen::Vector2d> points;
  const double width = sides.high - sides.low;
  const double middle = 0.5 * (sides.low + sides.high);
  for (int column = 0; column < gap.inside.cols; ++column) {
    int top = -1;
    for (int row = gap.inside.rows - 1; row >= 0 && top < 0; --row) {
      if (gap.open(row, column) != 0) top = row;
    }
    if (top < 0) continue;
    const Eigen::Vector2d seen(view.Center(gap.bounds.x + column, 0).x(),
                               (gap.bounds.y + top + 1) * view.cell_m);
    const double t = is_arch ? std::clamp(2.0 * (seen.x() - middle) / width, -1.0, 1.0) : 0.0;
    const Eigen::Vector2d outward(t, std::sqrt(1.0 - t * t));
    const bool is_far = outward.dot(seen - mouth.camera_uv_m) > 0.0;
    const Eigen::Vector2d point =
        is_far ? mouth.camera_uv_m + (seen - mouth.camera_uv_m) / mouth.shrink : seen;
    if (point.x() > sides.low + 0.02 * width && point.x() < sides.high - 0.02 * width)
      points.push_back(point);
  }
  return points;
}

Head MeasureHead(const Elevation& view, const Gap& gap, const Mouth& mouth, const Span& sides) {
  const std::vector<Eigen::Vector2d> as_straight = TraceHead(view, gap, mouth, sides, false);
  const std::vector<Eigen::Vector2d> as_arch = TraceHead(view, gap, mouth, sides, true);
  if (as_straight.empty() || as_arch.empty()) return {(gap.bounds.y + gap.bounds.height) * view.cell_m, 0.0};
  const double reach = LevelReach(view, mouth);
  const double level = HighestLevel(as_straight, reach);
  const Head arch = FitArch(as_arch, sides);
  const bool is_arch = arch.rise_m > 0.05 * (sides.high - sides.low) && arch.spring_m >= 0.0;
  const bool fits_better = ShareOn(as_arch, arch, sides, reach) > ShareAt(as_straight, level, reach);
  return is_arch && fits_better ? arch : Head{level, 0.0};
}

/// The sill of an opening that does not reach the ground.
double MeasureBottom(const Elevation& view, const Gap& gap, const Mouth& mouth, const Span& sides) {
  std::vector<Eigen::Vector2d> points;
  for (int column = 0; column < gap.inside.cols; ++column) {
    const double u = view.Center(gap.bounds.x + column, 0).x();
    int row = 0;
    while (row < gap.inside.rows && gap.open(row, column) == 0) ++row;
    if (row < gap.inside.rows && u > sides.low && u < sides.high)
      points.emplace_back(u, mouth.Bottom((gap.bounds.y + row) * view.cell_m));
  }
  if (points.empty()) return mouth.Bottom(gap.bounds.y * view.cell_m);
  return HighestLevel(points, LevelReach(view, mouth));
}

/// Counter-clockwise as seen from outside.
Ring MouthRing(const Span& sides, double bottom, const Head& head) {
  Ring ring = {{sides.low, bottom}, {sides.high, bottom}};
  if (head.rise_m == 0.0) {
    ring.emplace_back(sides.high, head.spring_m);
    ring.emplace_back(sides.low, head.spring_m);
    return ring;
  }
  const double middle = 0.5 * (sides.low + sides.high);
  const double half = 0.5 * (sides.high - sides.low);
  for (int i = 0; i <= kHeadSegments; ++i) {
    const double angle = M_PI * i / kHeadSegments;
    ring.emplace_back(middle + half * std::cos(angle), head.spring_m + head.rise_m * std::sin(angle));
  }
  return ring;
}

/// The gap as a recess. Where its sides look like the wall, the gap is as wide as the mouth at the foot and
/// as the back wall above; where they are dark, it is as wide as the mouth everywhere and the back wall's
/// edges are looked for.
std::optional<Recess> MeasureRecess(const Elevation& view, const Sight& sight, const Gap& gap,
                                    double deepest_m) {
  Mouth mouth{view.camera_uv_m, 1.0};
  const Span inner = MeasureSides(view, gap, mouth);
  const std::optional<Jambs> jambs = gap.is_standing ? MeasureJambs(view, gap, 0.0) : std::nullopt;
  const Span foot = jambs ? jambs->Mouth() : inner;
  const double width_m = foot.high - foot.low;
  if (!(width_m > 2.0 * view.cell_m)) return std::nullopt;
  const double share = (inner.high - inner.low) / width_m;
  const bool shows_sides = share < kSameWidthShare;
  if (shows_sides) mouth.shrink = share;
  const Span& outer = shows_sides ? foot : inner;
  const double bottom = gap.is_standing ? 0.0 : MeasureBottom(view, gap, mouth, outer);
  const Head head = MeasureHead(view, gap, mouth, outer);
  if (!(head.spring_m + head.rise_m > bottom + 2.0 * view.cell_m)) return std::nullopt;
  const Ring ring = MouthRing(outer, bottom, head);
  if (!IsSimple(ring)) return std::nullopt;
  if (!shows_sides) return FindRecess(sight, view.wall, ring, deepest_m);
  const double depth_m = view.camera_front_m * (1.0 / share - 1.0);
  if (depth_m > deepest_m) return std::nullopt;
  const double share_std = 2.0 * kPixelStd * view.cell_m / width_m;
  return Recess{ring, depth_m, view.camera_front_m / (share * share) * share_std};
}

std::optional<Opening> MeasureOpening(const Elevation& view, const Sight& sight, const Gap& gap,
                                      const Polygon& footprint, int side, double height_m) {
  const double middle_u = (gap.bounds.x + 0.5 * gap.bounds.width) * view.cell_m;
  const std::optional<WayOut> way = FindWayOut(footprint, side, middle_u);
  Opening opening;
  opening.captures = {view.capture_id};
  Mouth mouth{view.camera_uv_m, 1.0};
  if (way) {
    const double shrink = view.camera_front_m / (view.camera_front_m + way->length_m);
    const Evidence evidence = WeighBackground(view, gap, shrink);
    opening.is_through = evidence.is_through;
    opening.shows_background = evidence.shows_background;
    opening.evidence = evidence.text;
    if (opening.shows_background) mouth.shrink = shrink;
  } else {
    opening.evidence = "no wall opposite it";
  }
  Span sides = MeasureSides(view, gap, mouth);
  double bottom = 0.0;
  if (gap.is_standing) {
    if (const auto jambs = MeasureJambs(view, gap, way ? way->length_m : 0.0)) {
      sides = jambs->Mouth();
      opening.left_drift = jambs->left.drift;
      opening.right_drift = jambs->right.drift;
    }
  } else {
    bottom = MeasureBottom(view, gap, mouth, sides);
  }
  sides.low = std::max(sides.low, 0.0);
  sides.high = std::min(sides.high, view.wall.width_m);
  if (!(sides.high - sides.low > 2.0 * view.cell_m)) return std::nullopt;
  Head head = MeasureHead(view, gap, mouth, sides);
  const double top = head.spring_m + head.rise_m;
  if (!(top > bottom + 2.0 * view.cell_m) || top >= height_m) return std::nullopt;
  if (opening.shows_background && LacksJambs(view, sides, bottom, top, mouth.shrink)) {
    opening.is_through = opening.shows_background = false;
    opening.evidence += ", but not the sides of a passage: it may be painted";
  }
  opening.ring_in_wall_m = MouthRing(sides, bottom, head);
  opening.std_m = std::hypot(view.pose_std_m, kPixelStd * view.cell_m / mouth.shrink);
  if (!IsSimple(opening.ring_in_wall_m)) return std::nullopt;
  if (way && !opening.is_through) {
    opening.recess = MeasureRecess(view, sight, gap, way->length_m);
  }
  return opening;
}

}  // namespace

std::vector<Facade> ReadFacades(const Footprint& object, const std::vector<Image>& images,
                                const std::vector<Mask>& masks, const std::vector<Sight>& sights,
                                const FacadeOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  SOFFIT_EXPECT(images.size() == sights.size() && masks.size() == sights.size());
  const Polygon& footprint = object.polygon_in_map_m;
  const int sides = static_cast<int>(footprint.outer.size());

  std::vector<std::optional<Elevation>> best(static_cast<std::size_t>(sides));
  std::vector<std::size_t> best_sight(static_cast<std::size_t>(sides));
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const auto found = std::find(masks[i].classes.begin(), masks[i].classes.end(), object.color);
    const int own_class =
        found == masks[i].classes.end() ? 0 : static_cast<int>(found - masks[i].classes.begin()) + 1;
    for (int side = 0; side < sides; ++side) {
      std::optional<Elevation> view =
          Rectify(object, side, own_class, images[i], masks[i], sights[i], options.resolution_m);
      std::optional<Elevation>& chosen = best[static_cast<std::size_t>(side)];
      if (!view || view->visible_ratio < kMinVisible) continue;
      if (chosen && view->quality <= chosen->quality) continue;
      chosen = std::move(view);
      best_sight[static_cast<std::size_t>(side)] = i;
    }
  }

  std::vector<Elevation> seen;
  for (const auto& view : best) {
    if (view) seen.push_back(*view);
  }
  const Height height =
      object.levels.empty() ? MeasureHeight(object, seen) : Height{object.height_m, object.height_std_m};

  std::vector<Facade> facades;
  for (int side = 0; side < sides; ++side) {
    const std::optional<Elevation>& view = best[static_cast<std::size_t>(side)];
    Facade facade;
    facade.object_id = object.object_id;
    facade.side = side;
    facade.width_m = WallOf(footprint.outer, side).width_m;
    facade.height_m = height.value_m;
    facade.height_std_m = height.std_m;
    facade.was_seen = view.has_value();
    if (view) facade.capture_id = view->capture_id;
    if (facade.was_seen && height.value_m > 0.0) {
      for (const Gap& gap : FindGaps(*view, height.value_m, options.min_opening_m)) {
        std::optional<Opening> opening = MeasureOpening(
            *view, sights[best_sight[static_cast<std::size_t>(side)]], gap, footprint, side, height.value_m);
        if (opening) facade.openings.push_back(*std::move(opening));
      }
    }
    facades.push_back(std::move(facade));
  }
  return facades;
}

}  // namespace soffit
