#include "service/footprint/footprint.h"

#include <algorithm>
#include <cmath>

#include "service/footprint/lean.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

using Eigen::Vector2d;
using lean::Estimate;

constexpr double kSameBuildingShare = 0.6;    ///< Of a silhouette, that the building explains.
constexpr double kMiddlingHeightRatio = 0.3;  ///< Of the lowest camera's height.
constexpr double kMaxHeight_m = 120.0;

double CameraHeight(const Silhouette& s) { return s.view.map_from_camera.translation_m.z(); }

/// How far off a footprint drawn from this silhouette may be: coarse pixels, slanted looks and noisy poses.
double ExpectedError_m(const Silhouette& s) {
  const auto middle = MeetHorizontalPlane(s.view, Centroid(s.outline.polygon_px), 0.0);
  if (!middle) return 1e9;
  const double slant = (*middle - s.view.map_from_camera.translation_m.head<2>()).norm() / CameraHeight(s);
  return lean::GroundSampling_m(s) * (1.0 + 6.0 * slant) +
         0.2 * std::hypot(s.view.position_std_m, CameraHeight(s) * s.view.orientation_std_rad);
}

/// Whole before cut, then the one that errs least.
const Silhouette& BestSilhouette(const std::vector<Silhouette>& silhouettes) {
  return *std::min_element(silhouettes.begin(), silhouettes.end(),
                           [](const Silhouette& a, const Silhouette& b) {
                             if (a.outline.is_cut != b.outline.is_cut) return b.outline.is_cut;
                             return ExpectedError_m(a) < ExpectedError_m(b);
                           });
}

/// With noisy poses every picture shows the building somewhere else: their weighted mean.
Vector2d MeanShift(const std::vector<Silhouette>& silhouettes, const Polygon& polygon, double height_m) {
  Vector2d sum = Vector2d::Zero();
  double weights = 0.0;
  for (const Silhouette& s : silhouettes) {
    const double std_m = std::hypot(s.view.position_std_m, CameraHeight(s) * s.view.orientation_std_rad);
    if (std_m <= 0.0) return Vector2d::Zero();
    const Polygon other = s.outline.is_cut ? Polygon{} : lean::Straighten(s, height_m);
    if (other.outer.empty()) continue;
    sum += (Centroid(other) - Centroid(polygon)) / (std_m * std_m);
    weights += 1.0 / (std_m * std_m);
  }
  return weights > 0.0 ? Vector2d(sum / weights) : Vector2d::Zero();
}

void Shift(Polygon& polygon, const Vector2d& by) {
  for (Vector2d& p : polygon.outer) p += by;
  for (Ring& hole : polygon.holes) {
    for (Vector2d& p : hole) p += by;
  }
}

/// Draws polygon and standard deviations from the silhouettes, for the height that is set. False when none
/// can be.
bool Draw(Footprint& footprint) {
  const Silhouette& best = BestSilhouette(footprint.silhouettes);
  footprint.is_cut = best.outline.is_cut;
  footprint.polygon_in_map_m = lean::Straighten(best, footprint.height_m);
  if (footprint.polygon_in_map_m.outer.empty()) return false;
  Shift(footprint.polygon_in_map_m,
        MeanShift(footprint.silhouettes, footprint.polygon_in_map_m, footprint.height_m));
  const double pixel_m = lean::GroundSampling_m(best);
  const double pose_m =
      std::hypot(best.view.position_std_m, CameraHeight(best) * best.view.orientation_std_rad);
  const Vector2d nadir = best.view.map_from_camera.translation_m.head<2>();
  footprint.corner_std_m.clear();
  for (const Vector2d& corner : footprint.polygon_in_map_m.outer) {
    const double from_height_m = footprint.height_std_m * (corner - nadir).norm() / CameraHeight(best);
    footprint.corner_std_m.push_back(std::hypot(0.5 * pixel_m, std::hypot(pose_m, from_height_m)));
  }
  footprint.captures.clear();
  for (const Silhouette& s : footprint.silhouettes) footprint.captures.push_back(s.capture_id);
  return true;
}

/// Height, polygon and standard deviations from all silhouettes.
bool Understand(Footprint& footprint, double max_height_m) {
  std::vector<Silhouette> whole;
  for (const Silhouette& s : footprint.silhouettes) {
    if (!s.outline.is_cut) whole.push_back(s);
  }
  std::vector<Estimate> corners;
  for (const Silhouette& s : whole) {
    if (const auto estimate = lean::HeightFromCorners(s, max_height_m)) corners.push_back(*estimate);
  }
  const std::optional<Estimate> height = whole.size() == 1 && !corners.empty()
                                             ? std::optional(corners.front())
                                             : lean::HeightFromParallax(whole, corners, max_height_m);
  footprint.height_m = height ? height->value : 0.0;
  footprint.height_std_m = height ? height->std : 0.0;
  if (Draw(footprint)) return true;
  footprint.height_m = footprint.height_std_m = 0.0;
  return Draw(footprint);
}

/// Share of what a silhouette covers on the ground that a building of this footprint and height would cover:
/// a point is covered when some part of the plumb line on the footprint, or of the roof, appears in front of
/// it.
double ShareExplained(const Silhouette& silhouette, const Polygon& polygon, double height_m) {
  constexpr int kCells = 24;
  constexpr int kLevels = 8;
  const Polygon shadow = lean::Straighten(silhouette, 0.0);
  const Vector2d nadir = silhouette.view.map_from_camera.translation_m.head<2>();
  const double shrink = (CameraHeight(silhouette) - height_m) / CameraHeight(silhouette);
  Vector2d low = shadow.outer.front();
  Vector2d high = low;
  for (const Vector2d& p : shadow.outer) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  int covered = 0;
  int explained = 0;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const Vector2d p = low + (high - low).cwiseProduct(Vector2d((i + 0.5) / kCells, (j + 0.5) / kCells));
      if (!Contains(shadow.outer, p)) continue;
      ++covered;
      for (int level = 0; level <= kLevels; ++level) {
        const double k = 1.0 + (shrink - 1.0) * level / kLevels;
        if (Contains(polygon.outer, nadir + k * (p - nadir))) {
          ++explained;
          break;
        }
      }
    }
  }
  return covered > 0 ? static_cast<double>(explained) / covered : 0.0;
}

/// Whether what `other` was seen as is this building. One whose height is not known yet is tried at a
/// middling one.
bool Explains(const Footprint& building, const Footprint& other) {
  double ceiling_m = CameraHeight(other.silhouettes.front());
  for (const Silhouette& s : building.silhouettes) ceiling_m = std::min(ceiling_m, CameraHeight(s));
  double height_m = building.height_m > 0.0 ? building.height_m : other.height_m;
  if (!(height_m > 0.0 && height_m < 0.9 * ceiling_m)) height_m = kMiddlingHeightRatio * ceiling_m;
  const Polygon polygon = building.height_m > 0.0
                              ? building.polygon_in_map_m
                              : lean::Straighten(BestSilhouette(building.silhouettes), height_m);
  return std::all_of(other.silhouettes.begin(), other.silhouettes.end(), [&](const Silhouette& s) {
    return ShareExplained(s, polygon, height_m) >= kSameBuildingShare;
  });
}

bool IsSameBuilding(const Footprint& a, const Footprint& b) {
  return a.color == b.color && (Explains(a, b) || Explains(b, a));
}

}  // namespace

std::vector<Footprint> TraceFootprints(const Image& image, const std::vector<Outline>& outlines,
                                       const FootprintOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  const Eigen::Vector3d axis = image.view.map_from_camera.rotation * Eigen::Vector3d::UnitZ();
  SOFFIT_EXPECT(axis.z() <= -std::sqrt(0.5) + 1e-9);
  SOFFIT_EXPECT(image.view.map_from_camera.translation_m.z() > 0.0);
  std::vector<Footprint> footprints;
  for (const Outline& outline : outlines) {
    Footprint footprint;
    footprint.color = outline.color;
    footprint.silhouettes = {{image.capture_id, image.view, outline}};
    if (!Understand(footprint, options.max_height_m)) continue;
    if (Area(footprint.polygon_in_map_m) < options.min_area_m2) continue;
    footprints.push_back(std::move(footprint));
  }
  return footprints;
}

std::vector<Footprint> MergeFootprints(const std::vector<Footprint>& map,
                                       const std::vector<Footprint>& seen) {
  std::vector<Footprint> merged = map;
  std::uint32_t next_id = 1;
  for (const Footprint& known : map) next_id = std::max(next_id, known.object_id + 1);
  for (const Footprint& candidate : seen) {
    const auto known = std::find_if(merged.begin(), merged.end(),
                                    [&](const Footprint& f) { return IsSameBuilding(f, candidate); });
    if (known == merged.end()) {
      merged.push_back(candidate);
      merged.back().object_id = next_id++;
      continue;
    }
    Footprint together = *known;
    for (const Silhouette& s : candidate.silhouettes) together.silhouettes.push_back(s);
    if (Understand(together, kMaxHeight_m)) *known = std::move(together);
  }
  return merged;
}

Footprint WithHeight(const Footprint& footprint, double height_m, double height_std_m) {
  SOFFIT_EXPECT(height_m > 0.0 && height_std_m >= 0.0);
  SOFFIT_EXPECT(!footprint.silhouettes.empty());
  for (const Silhouette& s : footprint.silhouettes) SOFFIT_EXPECT(height_m < CameraHeight(s));
  Footprint result = footprint;
  result.height_m = height_m;
  result.height_std_m = height_std_m;
  SOFFIT_EXPECT(Draw(result));
  return result;
}

}  // namespace soffit
