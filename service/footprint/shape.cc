#include "service/footprint/shape.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "service/footprint/carve.h"
#include "service/footprint/level_guess.h"
#include "service/footprint/massing_fit.h"
#include "service/footprint/profile.h"
#include "service/footprint/wireframe.h"

namespace soffit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSameBuilding = 0.3;    ///< Intersection over union of what is predicted and an outline.
constexpr double kSameEavesShare = 0.05;  ///< Of the height.
constexpr double kDetailShare = 0.03;  ///< Of the building's size: what levels may be drawn without at first.
constexpr std::size_t kLeastBeside = 2;  ///< Pictures that have to show what stands back.

struct Box {
  explicit Box(const Ring& ring) : low(ring.front()), high(ring.front()) {
    for (const Vector2d& p : ring) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  Vector2d low, high;
};

/// Whether a point lies within an outline's bounds, or not farther beside them than half of their size.
bool IsNear(const Ring& outline, const Vector2d& pixel) {
  const Box box(outline);
  const Vector2d from_middle = (pixel - 0.5 * (box.low + box.high)).cwiseAbs();
  return (from_middle.array() <= (box.high - box.low).array()).all();
}

/// Intersection over union, on a grid.
double Overlap(const Cover& cover, const Ring& outline) {
  constexpr int kCells = 32;
  const Box box(outline);
  const Vector2d size = box.high - box.low;
  int both = 0, any = 0;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const Vector2d share((i + 0.5) / kCells, (j + 0.5) / kCells);
      const Vector2d at = box.low - 0.5 * size + 2.0 * size.cwiseProduct(share);
      const bool is_predicted = cover.Contains(at), is_seen = Contains(outline, at);
      both += is_predicted && is_seen ? 1 : 0;
      any += is_predicted || is_seen ? 1 : 0;
    }
  }
  return any > 0 ? static_cast<double>(both) / any : 0.0;
}

/// Of each picture the outline that is this building's, if any.
std::vector<Silhouette> FindBeside(const Footprint& footprint, const std::vector<Silhouette>& beside) {
  const double height_m = footprint.height_m > 0.0 ? footprint.height_m : 1.0;
  const Wireframe frame = FrameOf(Upright(footprint.polygon_in_map_m, height_m));
  const Vector2d center_m = Centroid(footprint.polygon_in_map_m);
  const Vector3d middle_m(center_m.x(), center_m.y(), 0.5 * height_m);
  std::vector<Silhouette> found;
  std::vector<double> share;
  for (const Silhouette& candidate : beside) {
    const Ring& outline = candidate.outline.polygon_px.outer;
    const auto middle = Project(candidate.view, middle_m);
    if (candidate.outline.color != footprint.color || !middle || !IsNear(outline, *middle)) continue;
    const double overlap = Overlap(Cover(frame, candidate.view), outline);
    if (overlap < kSameBuilding) continue;
    if (!found.empty() && found.back().capture_id == candidate.capture_id) {
      if (overlap <= share.back()) continue;
      found.pop_back();
      share.pop_back();
    }
    found.push_back(candidate);
    share.push_back(overlap);
  }
  return found;
}

bool HasInsets(const std::vector<Level>& levels) {
  return std::any_of(levels.begin(), levels.end(), [](const Level& level) {
    return std::any_of(level.inset_m.begin(), level.inset_m.end(),
                       [](double inset_m) { return inset_m > 0.0; });
  });
}

/// Heights at which the profiles suggest that the outline which is seen from above may be.
std::vector<double> FindEaves_m(const std::vector<Ring>& rings, const std::vector<Profile>& profiles,
                                double height_m) {
  std::vector<double> eaves_m;
  for (const Ring& ring : rings) {
    for (const LevelGuess& guess : GuessLevels(ring, profiles, height_m)) {
      if (!HasInsets(guess.levels)) continue;
      for (const Level& level : guess.levels) eaves_m.push_back(level.height_m);
    }
  }
  std::sort(eaves_m.begin(), eaves_m.end());
  const auto is_same = [&](double a, double b) { return b - a < kSameEavesShare * height_m; };
  eaves_m.erase(std::unique(eaves_m.begin(), eaves_m.end(), is_same), eaves_m.end());
  return eaves_m;
}

std::vector<cv::Point2f> ToPoints(const Ring& ring) {
  std::vector<cv::Point2f> points;
  for (const Vector2d& p : ring) points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  return points;
}

Ring ToRing(const std::vector<cv::Point2f>& points) {
  Ring ring;
  for (const cv::Point2f& p : points) ring.emplace_back(p.x, p.y);
  return ring;
}

/// With the corners that matter (D. Douglas and T. Peucker, Cartographica 10(2), 1973): sides that stand back
/// must not be short.
Ring WithoutDetails(const Ring& ring) {
  if (ring.size() < 3) return ring;
  std::vector<cv::Point2f> thinned;
  cv::approxPolyDP(ToPoints(ring), thinned, kDetailShare * std::sqrt(std::abs(SignedArea(ring))), true);
  return ToRing(thinned);
}

/// Outlines that the building may stand on: as it was drawn from above, the smallest rectangle about it, and
/// as each picture from above shows it when what it shows are the eaves.
std::vector<Ring> FindRings(const Footprint& footprint, const std::vector<Profile>& profiles,
                            double height_m) {
  const Ring& drawn = footprint.polygon_in_map_m.outer;
  std::vector<cv::Point2f> corners(4);
  cv::minAreaRect(ToPoints(drawn)).points(corners.data());
  Ring rectangle = ToRing(corners);
  if (SignedArea(rectangle) < 0.0) std::reverse(rectangle.begin(), rectangle.end());
  std::vector<Ring> rings = {drawn};
  if (drawn.size() != 4 && std::abs(SignedArea(drawn)) > 0.7 * SignedArea(rectangle))
    rings.push_back(rectangle);
  for (const double eaves_m : FindEaves_m(rings, profiles, height_m)) {
    for (const Silhouette& silhouette : footprint.silhouettes) {
      if (silhouette.outline.is_cut) continue;
      Ring carved = WithoutDetails(Carve(silhouette, eaves_m).outer);
      if (carved.size() >= 3 && IsSimple(carved)) rings.push_back(std::move(carved));
    }
  }
  return rings;
}

/// Moves the sides so that the ring ends where the pictures show the foot of the building end.
Ring FitToBase(Ring ring, const std::vector<Profile>& profiles, double height_m) {
  const std::size_t n = ring.size();
  std::vector<double> inset_m(n, 0.0), count(n, 0.0);
  for (const Profile& profile : profiles) {
    const auto extent = profile.Extent(kFootShare * height_m);
    if (!extent) continue;
    for (const bool is_right : {false, true}) {
      const Vector2d seen =
          profile.middle_m + (is_right ? extent->y() : extent->x()) * profile.right - profile.camera_m;
      const Vector2d beyond = (is_right ? 1.0 : -1.0) * Vector2d(seen.y(), -seen.x()).normalized();
      double farthest = -1e18;
      for (const Vector2d& p : ring) farthest = std::max(farthest, beyond.dot(p - profile.camera_m));
      for (std::size_t i = 0; i < n; ++i) {
        const Vector2d along = (ring[(i + 1) % n] - ring[i]).normalized();
        const double facing = beyond.dot(Vector2d(along.y(), -along.x()));
        if (facing < kSideCosine) continue;
        inset_m[i] += farthest / facing;
        count[i] += 1.0;
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i) inset_m[i] /= std::max(1.0, count[i]);
  Ring fitted = InsetRing(ring, inset_m);
  return IsSimple(fitted) && SignedArea(fitted) > 0.0 ? fitted : ring;
}

std::vector<Profile> ElevateAll(const std::vector<Silhouette>& beside, const Ring& drawn) {
  std::vector<Profile> profiles;
  for (const Silhouette& silhouette : beside) {
    if (auto profile = Elevate(silhouette, drawn)) profiles.push_back(*std::move(profile));
  }
  return profiles;
}

/// The best fit of those with levels that profiles suggest; its polygon is empty when there is none.
MassingFit FitLevels(const Footprint& footprint, const std::vector<Profile>& profiles, double height_m,
                     const std::vector<Silhouette>& silhouettes) {
  const Polygon& polygon = footprint.polygon_in_map_m;
  MassingFit best;
  for (const Ring& drawn : FindRings(footprint, profiles, height_m)) {
    Massing start{{FitToBase(drawn, profiles, height_m)}, {}, {}};
    start.rings.insert(start.rings.end(), polygon.holes.begin(), polygon.holes.end());
    for (LevelGuess& guess : GuessLevels(drawn, profiles, height_m)) {
      if (!HasInsets(guess.levels)) continue;
      start.levels = std::move(guess.levels);
      start.is_free = std::move(guess.is_free);
      start = Changed(start, Eigen::VectorXd::Zero(Layout(start).size));
      MassingFit fit = FitMassing(silhouettes, start);
      if (fit.cost < best.cost) best = std::move(fit);
    }
  }
  return best;
}

/// @param fit  To `beside`, and after these to the footprint's whole silhouettes.
Shaping Apply(const MassingFit& fit, Footprint footprint, std::vector<Silhouette> beside) {
  footprint.polygon_in_map_m = fit.polygon;
  footprint.corner_std_m = fit.corner_std_m;
  footprint.height_m = fit.height_m;
  footprint.height_std_m = fit.height_std_m;
  footprint.levels = fit.levels;
  auto view = fit.views.begin();
  for (Silhouette& s : beside) s.view = *view++;
  for (Silhouette& s : footprint.silhouettes) {
    if (IsWhole(s)) s.view = *view++;
  }
  return {std::move(footprint), std::move(beside)};
}

}  // namespace

std::optional<Shaping> ShapeBuilding(const Footprint& footprint, const std::vector<Silhouette>& beside) {
  if (footprint.is_cut) return std::nullopt;
  const Polygon& polygon = footprint.polygon_in_map_m;
  std::vector<Silhouette> shown = FindBeside(footprint, beside);
  const std::vector<Profile> profiles = ElevateAll(shown, polygon.outer);
  if (profiles.size() < kLeastBeside) return std::nullopt;
  double height_m = 0.0;
  for (const Profile& profile : profiles) height_m = std::max(height_m, profile.Top());

  std::vector<Silhouette> all = shown;
  for (const Silhouette& s : footprint.silhouettes) {
    if (IsWhole(s)) all.push_back(s);
  }
  const MassingFit best = FitLevels(footprint, profiles, height_m, all);
  if (best.polygon.outer.empty() || !HasInsets(best.levels)) return std::nullopt;
  const MassingFit plain = FitMassing(all, Upright(polygon, height_m));
  if (plain.cost <= best.cost) return std::nullopt;
  return Apply(best, footprint, std::move(shown));
}

}  // namespace soffit
