#include "service/footprint/lean.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace soffit::lean {
namespace {

using Eigen::Vector2d;

constexpr double kOutlineStd_px = 0.5;
constexpr double kMinSine = 0.15;          ///< Flatter corners are not intersected.
constexpr double kHighestRatio = 0.9;      ///< Of the camera's height: no building reaches nearer to it.
constexpr int kSamples = 96;               ///< On each outline, to compare two of them.
constexpr double kIndependentSamples = 6;  ///< That many of them err by themselves: about one for each side.

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

Vector2d Nadir(const View& view) { return view.map_from_camera.translation_m.head<2>(); }
double CameraHeight(const View& view) { return view.map_from_camera.translation_m.z(); }

double PositionStd(const Silhouette& s) {
  return std::hypot(s.view.position_std_m, CameraHeight(s.view) * s.view.orientation_std_rad);
}

/// The ring on the ground, turned to be counter-clockwise (outer) or clockwise (hole). Empty when a corner's
/// ray does not meet the ground.
Ring OnGround(const View& view, const Ring& ring_px, bool is_hole) {
  Ring ring;
  for (const Vector2d& pixel : ring_px) {
    const auto p = MeetHorizontalPlane(view, pixel, 0.0);
    if (!p) return {};
    ring.push_back(*p);
  }
  if ((SignedArea(ring) < 0.0) != is_hole) std::reverse(ring.begin(), ring.end());
  return ring;
}

enum class Side { kBase, kRoof, kRadial };

/// What each side of a silhouette is: seen from the nadir, walls face it and roofs end away from it.
std::vector<Side> ClassifySides(const Ring& ring, double noise_m) {
  std::vector<Side> sides;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d& a = ring[i];
    const Vector2d& b = ring[(i + 1) % ring.size()];
    const Vector2d side = b - a;
    const double offset =
        std::abs(Cross(a, side)) / std::max(side.norm(), 1e-12);  // Of its line from the nadir.
    const double reach = std::min(a.norm(), b.norm());
    const double tolerance = 0.04 + 1.5 * noise_m / std::max(side.norm(), 1e-12);
    const bool points_away = a.dot(side) * b.dot(side) > 0.0;
    if (points_away && offset < reach * std::min(tolerance, 0.5)) {
      sides.push_back(Side::kRadial);
    } else {
      sides.push_back(Cross(a, side) > 0.0 ? Side::kRoof
                                           : Side::kBase);  // Outward is to the right of the side.
    }
  }
  return sides;
}

/// A silhouette's ring relative to the nadir: side i runs from corner i to the next.
struct Sides {
  Ring ring;
  std::vector<Side> kinds;
};

/// Consecutive radial sides are one wall corner whose side was broken by noise.
Sides DescribeSides(const Ring& ring_on_ground, const Vector2d& nadir, double noise_m) {
  Sides sides;
  for (const Vector2d& p : ring_on_ground) sides.ring.push_back(p - nadir);
  sides.kinds = ClassifySides(sides.ring, noise_m);
  for (std::size_t i = 0; sides.ring.size() > 3 && i < sides.ring.size();) {
    const std::size_t before = (i + sides.ring.size() - 1) % sides.ring.size();
    const double outward = (sides.ring[(i + 1) % sides.ring.size()] - sides.ring[i]).dot(sides.ring[i]);
    const double outward_before = (sides.ring[i] - sides.ring[before]).dot(sides.ring[i]);
    if (sides.kinds[i] == Side::kRadial && sides.kinds[before] == Side::kRadial &&
        outward * outward_before > 0.0) {
      sides.ring.erase(sides.ring.begin() + static_cast<std::ptrdiff_t>(i));
      sides.kinds.erase(sides.kinds.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
  return sides;
}

struct StraightLine {
  Vector2d point;
  Vector2d direction;
};

std::optional<Vector2d> Meet(const StraightLine& a, const StraightLine& b) {
  const double sine = Cross(a.direction, b.direction);
  if (std::abs(sine) < kMinSine) return std::nullopt;
  return a.point + a.direction * (Cross(b.point - a.point, b.direction) / sine);
}

/// The footprint's ring, relative to the nadir too; `shrink` = 1 / s.
Ring StraightenRing(const Sides& silhouette, double shrink, double noise_m) {
  const Ring& ring = silhouette.ring;
  const std::vector<Side>& sides = silhouette.kinds;
  const std::size_t n = ring.size();
  const auto factor = [&](Side side) { return side == Side::kRoof ? shrink : 1.0; };
  const auto line = [&](std::size_t i) {
    const double k = factor(sides[i]);
    return StraightLine{k * ring[i], (ring[(i + 1) % n] - ring[i]).normalized()};
  };
  struct Corner {
    Vector2d point;
    std::size_t before, after;  ///< The sides that meet there.
  };
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = (i + n - 1) % n;
    const Side a = sides[before];
    const Side b = sides[i];
    const bool meets_roof = a == Side::kRoof || b == Side::kRoof;
    const bool meets_base = a == Side::kBase || b == Side::kBase;
    if (!(meets_roof && meets_base)) {
      corners.push_back({(meets_roof ? shrink : 1.0) * ring[i], before, i});
      continue;
    }
    const auto meeting = Meet(line(before), line(i));
    const double jump = (1.0 - shrink) * ring[i].norm();
    if (meeting && (*meeting - ring[i]).norm() <= 2.0 * jump + 4.0 * noise_m) {
      corners.push_back({*meeting, before, i});
    } else if (jump < 2.0 * noise_m) {
      corners.push_back({0.5 * (1.0 + shrink) * ring[i], before, i});
    } else {
      corners.push_back({factor(a) * ring[i], before, i});
      corners.push_back({factor(b) * ring[i], before, i});
    }
  }
  // What is left of a radial side of the right height is its noise: its ends become one corner again.
  Ring straight;
  const std::size_t m = corners.size();
  std::vector<bool> is_taken(m, false);
  for (std::size_t i = 0; i < m; ++i) {
    const Corner& a = corners[i];
    const Corner& b = corners[(i + 1) % m];
    const bool is_radial = a.after == b.before && sides[a.after] == Side::kRadial;
    const double length = (a.point - b.point).norm();
    const double gone = (1.0 - shrink) * std::max(a.point.norm(), b.point.norm());
    if (is_radial && m > 3 && !is_taken[i] && !is_taken[(i + 1) % m] &&
        length < 4.0 * noise_m + 0.25 * gone) {
      const auto meeting = Meet(line(a.before), line(b.after));
      const Vector2d middle = 0.5 * (a.point + b.point);
      const bool is_near = meeting && (*meeting - middle).norm() < length + 4.0 * noise_m;
      straight.push_back(is_near ? *meeting : middle);
      is_taken[i] = is_taken[(i + 1) % m] = true;
    } else if (!is_taken[i]) {
      straight.push_back(a.point);
    }
  }
  if (is_taken[0] && is_taken[m - 1] && corners[m - 1].after == corners[0].before &&
      sides[corners[0].before] == Side::kRadial && straight.size() > 3 &&
      (straight.front() - corners[0].point).norm() < 1e-12) {
    straight.erase(straight.begin());
  }
  return straight;
}

/// Without the sides and corners that are only noise: corners that hardly bend the ring, and short sides
/// across a corner in which their neighbours meet.
Ring TidyRing(Ring ring, double noise_m) {
  const double tolerance_m = 1.2 * noise_m;
  for (std::size_t i = 0; ring.size() > 3 && i < ring.size();) {
    const std::size_t n = ring.size();
    const Vector2d before = ring[(i + n - 1) % n];
    const Vector2d next = ring[(i + 1) % n];
    const Vector2d after = ring[(i + 2) % n];
    const auto drop = [&](std::size_t at) { ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at)); };
    if (DistanceToSegment(ring[i], before, next) < tolerance_m) {
      drop(i);
      i = i > 0 ? i - 1 : 0;
      continue;
    }
    const auto corner = Meet({before, (ring[i] - before).normalized()}, {next, (after - next).normalized()});
    if ((next - ring[i]).norm() < 6.0 * noise_m && corner &&
        DistanceToSegment(*corner, ring[i], next) < 2.0 * tolerance_m) {
      ring[i] = *corner;
      drop((i + 1) % n);
      continue;
    }
    ++i;
  }
  return ring;
}

/// Share of a region of the map at `height_m` that lies in the silhouette's blob.
double ShareSeen(const Silhouette& silhouette, const Ring& region, double height_m) {
  constexpr int kCells = 16;
  Vector2d low = region.front();
  Vector2d high = low;
  for (const Vector2d& p : region) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  int inside = 0;
  int seen = 0;
  for (int cell = 0; cell < kCells * kCells; ++cell) {
    const int column = cell % kCells;
    const int row = cell / kCells;
    const Vector2d share((column + 0.5) / kCells, (row + 0.5) / kCells);
    const Vector2d p = low + (high - low).cwiseProduct(share);
    if (!Contains(region, p)) continue;
    ++inside;
    const auto pixel = Project(silhouette.view, {p.x(), p.y(), height_m});
    if (pixel && Contains(silhouette.outline.polygon_px, *pixel)) ++seen;
  }
  return inside > 0 ? static_cast<double>(seen) / inside : 0.0;
}

/// Ground that shows through an opening of a wall dents the silhouette as a notch of the building would. It
/// is an opening when the wall goes on in one line behind the dent and the roof over the dent was seen whole.
Ring CloseOpenings(Ring ring, const Silhouette& silhouette, double height_m, double noise_m) {
  constexpr double kMinShareOfRoof = 0.97;
  constexpr std::size_t kMaxSides = 8;
  const Vector2d nadir = Nadir(silhouette.view);
  const auto is_in_line = [&](const Vector2d& side, const Vector2d& along) {
    const double tolerance = 0.04 + 1.5 * noise_m / std::max(side.norm(), 1e-12);
    return side.dot(along) > 0.0 && std::abs(Cross(side.normalized(), along)) < std::min(tolerance, 0.2);
  };
  for (std::size_t i = 0; i < ring.size(); ++i) {
    for (std::size_t sides = 3; sides <= kMaxSides && sides + 3 <= ring.size(); ++sides) {
      const std::size_t n = ring.size();
      const auto at = [&](std::size_t k) { return ring[(i + k) % n]; };
      const Vector2d gap = at(sides) - at(0);
      const Vector2d along = gap.normalized();
      const bool faces_nadir = Cross(at(0) - nadir, gap) < 0.0;
      if (!faces_nadir || !is_in_line(at(0) - at(n - 1), along) ||
          !is_in_line(at(sides + 1) - at(sides), along)) {
        continue;
      }
      Ring dent;
      for (std::size_t k = 0; k <= sides; ++k) dent.push_back(at(k));
      const bool is_dent = std::all_of(dent.begin() + 1, dent.end() - 1, [&](const Vector2d& p) {
        return Cross(along, p - dent.front()) > 0.0;
      });
      if (!is_dent || ShareSeen(silhouette, dent, height_m) < kMinShareOfRoof) continue;
      Ring closed;
      for (std::size_t k = sides + 1; k < n; ++k) closed.push_back(at(k));
      ring = std::move(closed);
      i = 0;
      sides = 2;
    }
  }
  return ring;
}

std::vector<Vector2d> SampleRing(const Ring& ring, int count) {
  std::vector<Vector2d> points;
  const double step = Perimeter(ring) / count;
  double at = 0.5 * step;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
    const double length = side.norm();
    for (; at < length; at += step) points.push_back(ring[i] + side * (at / length));
    at -= length;
  }
  return points;
}

/// Mean of squared distances in standard deviations. Far parts count for no more than `kFarthest` of them:
/// they are of something else.
class RobustMean {
 public:
  explicit RobustMean(double std_m) : std_m_(std_m) {}

  void Add(double distance_m) {
    constexpr double kFarthest = 4.0;
    const double squared = distance_m * distance_m / (std_m_ * std_m_);
    sum_ += squared / (1.0 + squared / (kFarthest * kFarthest));
    count_ += 1.0;
  }
  double Value() const { return sum_ / std::max(1.0, count_); }

 private:
  double std_m_;
  double sum_ = 0.0;
  double count_ = 0.0;
};

/// Between two outlines, both ways.
double MeanSquaredDistance(const Ring& a, const Ring& b, const Vector2d& b_offset, double std_m) {
  RobustMean mean(std_m);
  for (const Vector2d& p : SampleRing(a, kSamples)) mean.Add(DistanceToRing(p - b_offset, b));
  for (const Vector2d& p : SampleRing(b, kSamples)) mean.Add(DistanceToRing(p + b_offset, a));
  return mean.Value();
}

/// The outline on the ground, without what is only the edge of the picture.
std::vector<Vector2d> SampleInsidePicture(const Silhouette& s) {
  constexpr double kEdge_px = 4.0;
  const Intrinsics& k = s.view.intrinsics;
  std::vector<Vector2d> on_ground;
  for (const Vector2d& pixel : SampleRing(s.outline.polygon_px.outer, kSamples)) {
    const bool is_inside = pixel.x() > kEdge_px && pixel.y() > kEdge_px &&
                           pixel.x() < k.width_px - 1 - kEdge_px && pixel.y() < k.height_px - 1 - kEdge_px;
    const auto p = is_inside ? MeetHorizontalPlane(s.view, pixel, 0.0) : std::nullopt;
    if (p) on_ground.push_back(*p);
  }
  return on_ground;
}

/// From what a cut silhouette shows of its outline to the outline that a building of this footprint and
/// height would have in its picture: the base of walls that face the nadir, the edge of the roof away from
/// it, and wall corners.
double MeanSquaredDistanceOfCut(const Silhouette& cut, const Ring& footprint, double height_m, double std_m) {
  const Vector2d nadir = Nadir(cut.view);
  const double stretch = CameraHeight(cut.view) / (CameraHeight(cut.view) - height_m);
  const std::size_t n = footprint.size();
  std::vector<std::pair<Vector2d, Vector2d>> lines;
  std::vector<bool> is_roof;
  for (std::size_t i = 0; i < n; ++i) {
    const Vector2d a = footprint[i] - nadir;
    const Vector2d b = footprint[(i + 1) % n] - nadir;
    is_roof.push_back(Cross(a, b - a) > 0.0);
    const double k = is_roof.back() ? stretch : 1.0;
    lines.emplace_back(nadir + k * a, nadir + k * b);
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (is_roof[i] != is_roof[(i + n - 1) % n]) {
      lines.emplace_back(footprint[i], nadir + stretch * (footprint[i] - nadir));
    }
  }
  RobustMean mean(std_m);
  for (const Vector2d& p : SampleInsidePicture(cut)) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : lines) least = std::min(least, DistanceToSegment(p, a, b));
    mean.Add(least);
  }
  return mean.Value();
}

/// How well the place of a corner along its sides is known: two sides in nearly one line hardly tell it.
double CornerSine(const Ring& ring, std::size_t at) {
  const Vector2d before = (ring[at] - ring[(at + ring.size() - 1) % ring.size()]).normalized();
  const Vector2d after = (ring[(at + 1) % ring.size()] - ring[at]).normalized();
  return std::max(0.03, std::abs(Cross(before, after)));
}

/// How far an outline at `height_m` may be off by its pixels and by the camera's height.
double OutlineStd(const Silhouette& s, const Polygon& at_height, double height_m) {
  const double size_m = std::sqrt(std::max(1e-12, SignedArea(at_height.outer)));
  const double scale_std = s.view.position_std_m / (CameraHeight(s.view) - height_m);
  return std::hypot(kOutlineStd_px * GroundSampling_m(s), 0.5 * size_m * scale_std);
}

/// Half of chi squared, at one height, of all pairs of silhouettes and of the priors.
class Disagreement {
 public:
  Disagreement(const std::vector<Silhouette>& silhouettes, const std::vector<Estimate>& priors)
      : silhouettes_(silhouettes), priors_(priors) {}

  double operator()(double height_m) const { return OfPairs(height_m) + OfPriors(height_m); }

 private:
  double OfPairs(double height_m) const {
    double sum = 0.0;
    std::vector<Polygon> polygons;
    for (const Silhouette& s : silhouettes_) polygons.push_back(Straighten(s, height_m));
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      for (std::size_t j = i + 1; j < polygons.size(); ++j) {
        if (!(silhouettes_[i].outline.is_cut && silhouettes_[j].outline.is_cut)) {
          sum += Pair(i, j, polygons[i], polygons[j], height_m);
        }
      }
    }
    return sum;
  }

  double OfPriors(double height_m) const {
    double sum = 0.0;
    for (const Estimate& prior :
         priors_) {  // Cauchy: a side of the building that happens to be radial misleads.
      const double error = (height_m - prior.value) / prior.std;
      sum += 2.0 * std::log1p(0.25 * error * error);
    }
    return sum;
  }

  double Pair(std::size_t i, std::size_t j, const Polygon& a, const Polygon& b, double height_m) const {
    constexpr double kHopeless = 1e6;
    if (a.outer.empty() || b.outer.empty()) return kHopeless;
    const double position_std = std::hypot(PositionStd(silhouettes_[i]), PositionStd(silhouettes_[j]));
    const double outline_std =
        std::hypot(OutlineStd(silhouettes_[i], a, height_m), OutlineStd(silhouettes_[j], b, height_m));
    if (silhouettes_[i].outline.is_cut || silhouettes_[j].outline.is_cut) {
      const Silhouette& cut = silhouettes_[i].outline.is_cut ? silhouettes_[i] : silhouettes_[j];
      const Ring& whole = silhouettes_[i].outline.is_cut ? b.outer : a.outer;
      const double std_m = std::hypot(outline_std, position_std);
      return 0.5 * kIndependentSamples * MeanSquaredDistanceOfCut(cut, whole, height_m, std_m);
    }
    if (position_std == 0.0) {
      return 0.5 * kIndependentSamples * MeanSquaredDistance(a.outer, b.outer, Vector2d::Zero(), outline_std);
    }
    const Vector2d between = Centroid(Polygon{a.outer, {}}) - Centroid(Polygon{b.outer, {}});
    const Vector2d offset =
        between * (position_std * position_std / (position_std * position_std + outline_std * outline_std));
    const double chi2 = kIndependentSamples * MeanSquaredDistance(a.outer, b.outer, offset, outline_std) +
                        offset.squaredNorm() / (position_std * position_std);
    return 0.5 * chi2;
  }

  const std::vector<Silhouette>& silhouettes_;
  const std::vector<Estimate>& priors_;
};

}  // namespace

double GroundSampling_m(const Silhouette& s) {
  const Vector2d middle = Centroid(s.outline.polygon_px);
  const auto a = MeetHorizontalPlane(s.view, middle, 0.0);
  const auto b = MeetHorizontalPlane(s.view, middle + Vector2d(1.0, 0.0), 0.0);
  if (a && b) return (*a - *b).norm();
  return CameraHeight(s.view) / s.view.intrinsics.fx_px;
}

Polygon Straighten(const Silhouette& silhouette, double height_m) {
  const double camera_height_m = CameraHeight(silhouette.view);
  const Vector2d nadir = Nadir(silhouette.view);
  const double shrink = (camera_height_m - height_m) / camera_height_m;
  const double noise_m = GroundSampling_m(silhouette);
  const auto straighten = [&](const Ring& ring_px, bool is_hole) -> Ring {
    Ring ring = OnGround(silhouette.view, ring_px, is_hole);
    if (ring.size() < 3 || height_m == 0.0) return ring;
    const Ring leaning = StraightenRing(DescribeSides(ring, nadir, noise_m), shrink, noise_m);
    Ring straight = TidyRing(leaning, noise_m);
    for (Vector2d& p : straight) p += nadir;
    if (!is_hole) straight = CloseOpenings(std::move(straight), silhouette, height_m, noise_m);
    if (IsSimple(straight) && (SignedArea(straight) < 0.0) == is_hole) return straight;
    for (Vector2d& p : ring) p = nadir + shrink * (p - nadir);  // All of it taken for roof.
    return ring;
  };
  Polygon result;
  result.outer = straighten(silhouette.outline.polygon_px.outer, false);
  if (result.outer.empty()) return {};
  for (const Ring& hole_px : silhouette.outline.polygon_px.holes) {
    Ring hole = straighten(hole_px, true);
    const bool is_inside =
        std::all_of(hole.begin(), hole.end(), [&](const Vector2d& p) { return Contains(result.outer, p); });
    if (!hole.empty() && is_inside) result.holes.push_back(std::move(hole));
  }
  return result;
}

std::optional<Estimate> HeightFromCorners(const Silhouette& silhouette, double max_height_m) {
  const double camera_height_m = CameraHeight(silhouette.view);
  const Vector2d nadir = Nadir(silhouette.view);
  const double noise_m = GroundSampling_m(silhouette);
  const Ring on_ground = OnGround(silhouette.view, silhouette.outline.polygon_px.outer, false);
  if (on_ground.size() < 3) return std::nullopt;
  const auto [ring, sides] = DescribeSides(on_ground, nadir, noise_m);
  const std::size_t n = ring.size();
  std::vector<Estimate> candidates;
  for (std::size_t i = 0; i < n; ++i) {
    const Side before = sides[(i + n - 1) % n];
    const Side after = sides[(i + 1) % n];
    const bool is_corner = sides[i] == Side::kRadial && ((before == Side::kBase && after == Side::kRoof) ||
                                                         (before == Side::kRoof && after == Side::kBase));
    if (!is_corner) continue;
    const double first = ring[i].norm();
    const double second = ring[(i + 1) % n].norm();
    const double base = before == Side::kBase ? first : second;
    const double roof = before == Side::kBase ? second : first;
    const double scale = roof / base;
    const double height_m = camera_height_m * (1.0 - 1.0 / scale);
    if (!(height_m > 0.0) || height_m > std::min(max_height_m, kHighestRatio * camera_height_m)) continue;
    const double before_std = noise_m * kOutlineStd_px / CornerSine(ring, i);
    const double after_std = noise_m * kOutlineStd_px / CornerSine(ring, (i + 1) % n);
    const double scale_std = std::hypot(before_std, after_std) * scale / base;
    candidates.push_back({height_m, camera_height_m / (scale * scale) * scale_std});
  }
  if (candidates.empty()) return std::nullopt;

  // The height that most corners tell; the lowest of them, for a side that happens to be radial only adds
  // length.
  std::sort(candidates.begin(), candidates.end(),
            [](const Estimate& a, const Estimate& b) { return a.value < b.value; });
  const auto agrees = [](const Estimate& a, const Estimate& b) {
    return std::abs(a.value - b.value) <= 3.0 * std::hypot(a.std, b.std);
  };
  const auto votes = [&](const Estimate& candidate) {
    return std::count_if(candidates.begin(), candidates.end(),
                         [&](const Estimate& e) { return agrees(e, candidate); });
  };
  const Estimate chosen =
      *std::max_element(candidates.begin(), candidates.end(),
                        [&](const auto& a, const auto& b) { return votes(a) < votes(b); });
  double weight = 0.0;
  double sum = 0.0;
  for (const Estimate& e : candidates) {
    if (!agrees(e, chosen)) continue;
    weight += 1.0 / (e.std * e.std);
    sum += e.value / (e.std * e.std);
  }
  // A noisy pose moves the nadir and scales the heights.
  const double height_m = sum / weight;
  const double reach_m = (Centroid(Polygon{on_ground, {}}) - nadir).norm();
  const double pose_std_m = height_m * std::hypot(silhouette.view.position_std_m / camera_height_m,
                                                  PositionStd(silhouette) / std::max(1e-9, reach_m));
  return Estimate{height_m, std::hypot(1.0 / std::sqrt(weight), pose_std_m)};
}

std::optional<Estimate> HeightFromParallax(const std::vector<Silhouette>& silhouettes,
                                           const std::vector<Estimate>& priors, double max_height_m) {
  double ceiling_m = max_height_m;
  for (const Silhouette& s : silhouettes)
    ceiling_m = std::min(ceiling_m, kHighestRatio * CameraHeight(s.view));
  if (!(ceiling_m > 0.0) || silhouettes.empty() || (silhouettes.size() < 2 && priors.empty()))
    return std::nullopt;
  constexpr int kSteps = 80;
  const Disagreement disagreement(silhouettes, priors);
  double best_m = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 1; i <= kSteps; ++i) {
    const double height_m = ceiling_m * i / kSteps;
    const double value = disagreement(height_m);
    if (value < least) {
      least = value;
      best_m = height_m;
    }
  }
  if (!std::isfinite(least)) return std::nullopt;
  double step_m = ceiling_m / kSteps;
  for (int i = 0; i < 30; ++i) {  // Shrinking steps downhill.
    const double lower = disagreement(std::max(1e-6, best_m - step_m));
    const double upper = disagreement(std::min(ceiling_m, best_m + step_m));
    if (lower < least && lower <= upper) {
      least = lower;
      best_m = std::max(1e-6, best_m - step_m);
    } else if (upper < least) {
      least = upper;
      best_m = std::min(ceiling_m, best_m + step_m);
    } else {
      step_m *= 0.5;
    }
  }
  // The height is known as well as the disagreement rises about it: by one half in one standard deviation.
  double std_m = 0.002 * ceiling_m;
  while (std_m < ceiling_m) {
    const double above = disagreement(std::min(ceiling_m, best_m + std_m));
    const double below = disagreement(std::max(1e-6, best_m - std_m));
    if (std::min(above, below) - least >= 0.5) break;
    std_m *= 1.25;
  }
  if (std_m > 0.5 * best_m || best_m >= ceiling_m) return std::nullopt;
  return Estimate{best_m, std_m};
}

}  // namespace soffit::lean
