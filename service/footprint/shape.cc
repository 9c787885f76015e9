#include "service/footprint/shape.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "service/footprint/level_guess.h"
#include "service/footprint/massing_fit.h"
#include "service/footprint/profile.h"
#include "service/footprint/wireframe.h"

namespace soffit {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSameBuilding = 0.3;    ///< Intersection over union of what is predicted and an outline.
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

/// Outlines that the building may stand on: as it was drawn from above, and the smallest rectangle about it.
std::vector<Ring> FindRings(const Ring& drawn) {
  std::vector<cv::Point2f> points;
  for (const Vector2d& p : drawn) points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  cv::Point2f corners[4];
  cv::minAreaRect(points).points(corners);
  Ring rectangle;
  for (const cv::Point2f& p : corners) rectangle.emplace_back(p.x, p.y);
  if (SignedArea(rectangle) < 0.0) std::reverse(rectangle.begin(), rectangle.end());
  std::vector<Ring> rings = {drawn};
  if (drawn.size() != 4 && std::abs(SignedArea(drawn)) > 0.7 * SignedArea(rectangle))
    rings.push_back(rectangle);
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
  return InsetRing(ring, inset_m);
}

bool HasInsets(const std::vector<Level>& levels) {
  return std::any_of(levels.begin(), levels.end(), [](const Level& level) {
    return std::any_of(level.inset_m.begin(), level.inset_m.end(),
                       [](double inset_m) { return inset_m > 0.0; });
  });
}

std::vector<Profile> ElevateAll(const std::vector<Silhouette>& beside, const Vector2d& middle_m) {
  std::vector<Profile> profiles;
  for (const Silhouette& silhouette : beside) {
    if (auto profile = Elevate(silhouette, middle_m)) profiles.push_back(*std::move(profile));
  }
  return profiles;
}

/// The best fit of those with levels that profiles suggest; its polygon is empty when there is none.
MassingFit FitLevels(const Polygon& polygon, const std::vector<Profile>& profiles, double height_m,
                     const std::vector<Silhouette>& silhouettes) {
  MassingFit best;
  for (const Ring& drawn : FindRings(polygon.outer)) {
    Massing start{{FitToBase(drawn, profiles, height_m)}, {}, {}};
    if (!IsSimple(start.rings.front()) || !(SignedArea(start.rings.front()) > 0.0)) continue;
    start.rings.insert(start.rings.end(), polygon.holes.begin(), polygon.holes.end());
    for (LevelGuess& guess : GuessLevels(drawn, profiles, height_m)) {
      if (!HasInsets(guess.levels)) continue;
      start.levels = std::move(guess.levels);
      start.is_free = std::move(guess.is_free);
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
  const std::vector<Profile> profiles = ElevateAll(shown, Centroid(polygon));
  if (profiles.size() < kLeastBeside) return std::nullopt;
  double height_m = 0.0;
  for (const Profile& profile : profiles) height_m = std::max(height_m, profile.Top());

  std::vector<Silhouette> all = shown;
  for (const Silhouette& s : footprint.silhouettes) {
    if (IsWhole(s)) all.push_back(s);
  }
  const MassingFit best = FitLevels(polygon, profiles, height_m, all);
  if (best.polygon.outer.empty() || !HasInsets(best.levels)) return std::nullopt;
  const MassingFit plain = FitMassing(all, Upright(polygon, height_m));
  if (plain.cost <= best.cost) return std::nullopt;
  return Apply(best, footprint, std::move(shown));
}

}  // namespace soffit
