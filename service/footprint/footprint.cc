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
constexpr double kExplainedShare = 0.8;       ///< Of what was seen, when nothing else stands there.
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
  std::vector<Estimate> corners;
  for (const Silhouette& s : footprint.silhouettes) {
    if (s.outline.is_cut) continue;
    if (const auto estimate = lean::HeightFromCorners(s, max_height_m)) corners.push_back(*estimate);
  }
  const std::optional<Estimate> height =
      footprint.silhouettes.size() == 1 && !corners.empty()
          ? std::optional(corners.front())
          : lean::HeightFromParallax(footprint.silhouettes, corners, max_height_m);
  footprint.height_m = height ? height->value : 0.0;
  footprint.height_std_m = height ? height->std : 0.0;
  if (Draw(footprint)) return true;
  footprint.height_m = footprint.height_std_m = 0.0;
  return Draw(footprint);
}

/// Points all over the bounding box of a polygon.
std::vector<Vector2d> GridOver(const Polygon& polygon) {
  constexpr int kCells = 24;
  Vector2d low = polygon.outer.front();
  Vector2d high = low;
  for (const Vector2d& p : polygon.outer) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  std::vector<Vector2d> points;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      points.push_back(low + (high - low).cwiseProduct(Vector2d((i + 0.5) / kCells, (j + 0.5) / kCells)));
    }
  }
  return points;
}

/// How far a whole silhouette lies beside the footprint, as far as the noise of its pose explains that.
Vector2d ShiftOfPose(const Silhouette& silhouette, const Polygon& polygon, double height_m) {
  const double reach_m = 3.0 * std::hypot(silhouette.view.position_std_m,
                                          CameraHeight(silhouette) * silhouette.view.orientation_std_rad);
  if (reach_m <= 0.0 || silhouette.outline.is_cut) return Vector2d::Zero();
  const Vector2d shift = Centroid(polygon) - Centroid(lean::Straighten(silhouette, height_m));
  return shift * std::min(1.0, reach_m / std::max(1e-12, shift.norm()));
}

/// Share of what a silhouette covers on the ground that a building of this footprint and height would cover:
/// a point is covered when some part of the plumb line on the footprint, or of the roof, appears in front of
/// it.
double ShareExplained(const Silhouette& silhouette, const Polygon& polygon, double height_m) {
  constexpr int kLevels = 8;
  const Polygon shadow = lean::Straighten(silhouette, 0.0);
  const Vector2d nadir = silhouette.view.map_from_camera.translation_m.head<2>();
  const double shrink = (CameraHeight(silhouette) - height_m) / CameraHeight(silhouette);
  const Vector2d shift = ShiftOfPose(silhouette, polygon, height_m);
  int covered = 0;
  int explained = 0;
  for (const Vector2d& p : GridOver(shadow)) {
    if (!Contains(shadow.outer, p)) continue;
    ++covered;
    for (int level = 0; level <= kLevels; ++level) {
      const double k = 1.0 + (shrink - 1.0) * level / kLevels;
      if (Contains(polygon.outer, nadir + k * (p - nadir) + shift)) {
        ++explained;
        break;
      }
    }
  }
  return covered > 0 ? static_cast<double>(explained) / covered : 0.0;
}

/// Share of `inner` that lies in `outer`.
double ShareInside(const Polygon& inner, const Polygon& outer) {
  int inside = 0;
  int both = 0;
  for (const Vector2d& p : GridOver(inner)) {
    if (!Contains(inner.outer, p)) continue;
    ++inside;
    if (Contains(outer.outer, p)) ++both;
  }
  return inside > 0 ? static_cast<double>(both) / inside : 0.0;
}

/// Whether what `other` was seen as is this building, or part of it. A height that is not known yet is tried
/// at a middling value.
bool Explains(const Footprint& building, const Footprint& other) {
  double ceiling_m = CameraHeight(other.silhouettes.front());
  for (const Silhouette& s : building.silhouettes) ceiling_m = std::min(ceiling_m, CameraHeight(s));
  double height_m = building.height_m > 0.0 ? building.height_m : other.height_m;
  if (!(height_m > 0.0 && height_m < 0.9 * ceiling_m)) height_m = kMiddlingHeightRatio * ceiling_m;
  const auto at_height = [&](const Footprint& f) {
    return f.height_m > 0.0 ? f.polygon_in_map_m : lean::Straighten(BestSilhouette(f.silhouettes), height_m);
  };
  if (building.is_cut && !other.is_cut) {  // Whatever stands in it, its silhouette covers the foot of it.
    return ShareInside(at_height(other), lean::Straighten(BestSilhouette(building.silhouettes), 0.0)) >=
           kExplainedShare;
  }
  const Polygon polygon = at_height(building);
  return std::all_of(other.silhouettes.begin(), other.silhouettes.end(), [&](const Silhouette& s) {
    return ShareExplained(s, polygon, height_m) >= kSameBuildingShare;
  });
}

/// What a footprint that was just seen is to one of the map.
enum class Relation {
  kApart,
  kSame,
  kPartOfKnown,  ///< Seen whole, but the map's holds more: one blob of several buildings, or this is but a
                 ///< fragment.
  kPartOfSeen,   ///< The other way round.
};

Footprint Join(const Footprint& footprint, const std::vector<Silhouette>& silhouettes) {
  Footprint together = footprint;
  together.silhouettes.insert(together.silhouettes.end(), silhouettes.begin(), silhouettes.end());
  return Understand(together, kMaxHeight_m) ? together : footprint;
}

/// Whether some silhouette shows more than the one building that both were taken for.
bool HoldsMore(const Footprint& part, const Footprint& together) {
  return together.height_m > 0.0 &&
         std::any_of(part.silhouettes.begin(), part.silhouettes.end(), [&](const Silhouette& s) {
           return !s.outline.is_cut &&
                  ShareExplained(s, together.polygon_in_map_m, together.height_m) < kExplainedShare;
         });
}

Relation Relate(const Footprint& known, const Footprint& seen) {
  if (known.color != seen.color) return Relation::kApart;
  const bool is_seen_explained = Explains(known, seen);
  const bool is_known_explained = Explains(seen, known);
  if (is_seen_explained && is_known_explained) {
    const Footprint together = Join(known, seen.silhouettes);
    if (HoldsMore(known, together)) return Relation::kPartOfKnown;
    return HoldsMore(seen, together) ? Relation::kPartOfSeen : Relation::kSame;
  }
  if (is_seen_explained) return seen.is_cut ? Relation::kSame : Relation::kPartOfKnown;
  if (is_known_explained) return known.is_cut ? Relation::kSame : Relation::kPartOfSeen;
  return Relation::kApart;
}

/// How far the shape can be trusted: two pictures that agree are right, else the steeper and nearer one is.
bool IsMoreCertain(const Footprint& a, const Footprint& b) {
  const auto count_whole = [](const Footprint& f) {
    return std::min<std::ptrdiff_t>(2, std::count_if(f.silhouettes.begin(), f.silhouettes.end(),
                                                     [](const Silhouette& s) { return !s.outline.is_cut; }));
  };
  if (count_whole(a) != count_whole(b)) return count_whole(a) > count_whole(b);
  return ExpectedError_m(BestSilhouette(a.silhouettes)) < ExpectedError_m(BestSilhouette(b.silhouettes));
}

std::vector<Silhouette> MarkedCut(std::vector<Silhouette> silhouettes) {
  for (Silhouette& s : silhouettes) s.outline.is_cut = true;
  return silhouettes;
}

/// Whether the whole buildings of the map cover what this one, which is not seen whole anywhere, was seen as.
bool IsExplainedByOthers(const Footprint& footprint, const std::vector<Footprint>& map) {
  return std::all_of(footprint.silhouettes.begin(), footprint.silhouettes.end(), [&](const Silhouette& s) {
    double share = 0.0;
    for (const Footprint& other : map) {
      if (other.is_cut || other.color != footprint.color || other.height_m >= CameraHeight(s)) continue;
      share += ShareExplained(s, other.polygon_in_map_m, other.height_m);
    }
    return share >= kExplainedShare;
  });
}

/// Puts one building into the map, which holds none from the same picture but those put in before it.
void Insert(Footprint seen, std::vector<Footprint>& map, std::uint32_t& next_id) {
  std::vector<Silhouette> blobs;  // That show it together with others.
  for (Footprint& known : map) {
    const Relation relation = Relate(known, seen);
    if (relation == Relation::kApart) continue;
    if (relation == Relation::kSame) {
      known = Join(std::move(known), seen.silhouettes);
      return;
    }
    const bool is_known_larger = relation == Relation::kPartOfKnown;
    if (IsMoreCertain(seen, known) == is_known_larger) {  // The larger one is a blob.
      Footprint& blob = is_known_larger ? known : seen;
      blob.silhouettes = MarkedCut(std::move(blob.silhouettes));
      blob.is_cut = true;
      if (is_known_larger) blobs.insert(blobs.end(), known.silhouettes.begin(), known.silhouettes.end());
    } else if (is_known_larger) {
      known = Join(std::move(known), MarkedCut(seen.silhouettes));
      return;
    } else {
      known.silhouettes = MarkedCut(std::move(known.silhouettes));
      known = Join(std::move(known), seen.silhouettes);
      return;
    }
  }
  seen = Join(std::move(seen), blobs);
  seen.object_id = next_id++;
  map.push_back(std::move(seen));
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
  for (const Footprint& candidate : seen) Insert(candidate, merged, next_id);
  const std::vector<Footprint> all = merged;
  std::erase_if(merged, [&](const Footprint& f) { return f.is_cut && IsExplainedByOthers(f, all); });
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
