#include "service/footprint/footprint.h"

#include <algorithm>
#include <cmath>

#include "service/footprint/carve.h"
#include "service/footprint/mark.h"
#include "service/footprint/massing_fit.h"
#include "shared/result/result.h"

namespace soffit {
namespace {

using Eigen::Vector2d;

constexpr double kSameBuildingShare = 0.6;    ///< Of a silhouette, that the building explains.
constexpr double kExplainedShare = 0.8;       ///< Of what was seen, when nothing else stands there.
constexpr double kMiddlingHeightRatio = 0.3;  ///< Of the lowest camera's height.
constexpr double kMaxHeight_m = 120.0;
constexpr double kHighestRatio = 0.9;  ///< Of the lowest camera's height: no building reaches nearer to it.
constexpr double kLeastExplainedRatio = 0.75;
constexpr double kLeastCourtyardRatio =
    0.02;                                ///< Of a roof: smaller holes are chimneys, skylights and masts.
constexpr double kLeastSureRatio = 0.5;  ///< Of the height: with a larger standard deviation it is not known.

double CameraHeight(const Silhouette& s) { return s.view.map_from_camera.translation_m.z(); }

/// How far off a footprint drawn from this silhouette may be: coarse pixels, slanted looks and noisy poses.
double ExpectedError_m(const Silhouette& s) {
  const auto middle = MeetHorizontalPlane(s.view, Centroid(s.outline.polygon_px), 0.0);
  if (!middle) return 1e9;
  const double slant = (*middle - s.view.map_from_camera.translation_m.head<2>()).norm() / CameraHeight(s);
  return GroundSampling_m(s) * (1.0 + 6.0 * slant) +
         0.2 * std::hypot(s.view.position_std_m, CameraHeight(s) * s.view.orientation_std_rad);
}

/// Whole before cut, then the one that errs least.
const Silhouette& BestSilhouette(const std::vector<Silhouette>& silhouettes) {
  return *std::min_element(silhouettes.begin(), silhouettes.end(),
                           [](const Silhouette& a, const Silhouette& b) {
                             if (IsWhole(a) != IsWhole(b)) return IsWhole(a);
                             return ExpectedError_m(a) < ExpectedError_m(b);
                           });
}

/// Of what is drawn from the silhouette alone.
double PoseStd_m(const Silhouette& s) {
  return std::hypot(s.view.position_std_m, CameraHeight(s) * s.view.orientation_std_rad);
}

/// One silhouette alone, drawn for a height: good enough to tell buildings apart.
Polygon DrawAlone(const Silhouette& s, double height_m) {
  const Polygon carved = height_m > 0.0 ? Carve(s, height_m) : Polygon{};
  return carved.outer.empty() ? ProjectOutline(s, height_m) : carved;
}

/// What pictures that each cut the building show of it together, drawn for a height.
Polygon DrawParts(const std::vector<Silhouette>& silhouettes, double height_m) {
  std::vector<Polygon> parts;
  for (const Silhouette& s : silhouettes) parts.push_back(DrawAlone(s, height_m));
  if (parts.size() == 1) return parts.front();
  return Unite(parts, 0.5 * GroundSampling_m(BestSilhouette(silhouettes)));
}

bool AreParts(const std::vector<Silhouette>& silhouettes) {
  return std::all_of(silhouettes.begin(), silhouettes.end(),
                     [](const Silhouette& s) { return s.outline.is_cut && !s.holds_more; });
}

/// The building drawn for a height, without a fit.
Polygon Draw(const std::vector<Silhouette>& silhouettes, double height_m) {
  return AreParts(silhouettes) ? DrawParts(silhouettes, height_m)
                               : DrawAlone(BestSilhouette(silhouettes), height_m);
}

/// Draws the footprint as the silhouettes lie on the ground.
bool DrawOnGround(Footprint& footprint) {
  const Silhouette& best = BestSilhouette(footprint.silhouettes);
  footprint.height_m = footprint.height_std_m = 0.0;
  footprint.polygon_in_map_m = Draw(footprint.silhouettes, 0.0);
  footprint.corner_std_m.assign(footprint.polygon_in_map_m.outer.size(),
                                std::hypot(0.5 * GroundSampling_m(best), PoseStd_m(best)));
  return !footprint.polygon_in_map_m.outer.empty();
}

/// Footprints that a building of this height may have.
std::vector<Polygon> FindStarts(const std::vector<Silhouette>& silhouettes, double height_m) {
  constexpr std::size_t kMost = 2;
  if (AreParts(silhouettes) && silhouettes.size() > 1) return {DrawParts(silhouettes, height_m)};
  std::vector<const Silhouette*> whole;
  for (const Silhouette& s : silhouettes) {
    if (IsWhole(s)) whole.push_back(&s);
  }
  std::stable_sort(whole.begin(), whole.end(), [](const Silhouette* a, const Silhouette* b) {
    return ExpectedError_m(*a) < ExpectedError_m(*b);
  });
  std::vector<Polygon> starts;
  for (const Silhouette* s : whole) {
    if (starts.size() == kMost) break;
    Polygon start = Carve(*s, height_m);
    if (start.outer.empty()) continue;
    start.outer = CloseOpenings(std::move(start.outer), *s, silhouettes, height_m);
    starts.push_back(std::move(start));
  }
  return starts;
}

bool IsBetter(const MassingFit& a, const MassingFit& b) { return a.cost < b.cost; }

/// The building of about this height that fits best.
MassingFit FitAt(const std::vector<Silhouette>& silhouettes, const HeightPrior& prior) {
  MassingFit best;
  for (const Polygon& start : FindStarts(silhouettes, prior.value_m)) {
    best = std::min(best, FitPrism(silhouettes, start, prior), IsBetter);
  }
  return best;
}

/// Heights at which the building is looked for.
std::vector<double> FindHeights(const std::vector<Silhouette>& silhouettes, double ceiling_m) {
  constexpr double kLowestRatio = 0.04;
  constexpr double kFactor = 1.3;
  constexpr double kAgreeRatio = 0.25;
  std::vector<double> heights;
  for (const Silhouette& s : silhouettes) {
    if (!IsWhole(s)) continue;
    for (const double height_m : HeightsOfUprightSides(s)) {
      if (height_m < ceiling_m) heights.push_back(height_m);
    }
  }
  if (silhouettes.size() == 1) {  // One upright edge may be another side by chance; a building shows two.
    const std::vector<double> all = heights;
    std::erase_if(heights, [&](double h) {
      return std::count_if(all.begin(), all.end(),
                           [h](double o) { return std::abs(o - h) < kAgreeRatio * h; }) < 2;
    });
  }
  if (silhouettes.size() > 1) {
    for (double h = kLowestRatio * ceiling_m; h < ceiling_m; h *= kFactor) heights.push_back(h);
  }
  return heights;
}

/// The prism that all silhouettes show, if they tell its height.
std::optional<MassingFit> FitToAll(const std::vector<Silhouette>& silhouettes, double max_height_m) {
  constexpr std::size_t kMostThorough = 3;
  double ceiling_m = max_height_m;
  for (const Silhouette& s : silhouettes) ceiling_m = std::min(ceiling_m, kHighestRatio * CameraHeight(s));
  struct Candidate {
    Polygon start;
    double height_m;
    double cost;
  };
  std::vector<Candidate> candidates;
  for (const double height_m : FindHeights(silhouettes, ceiling_m)) {
    for (Polygon& start : FindStarts(silhouettes, height_m)) {
      const double cost = FitRoughly(silhouettes, start, {height_m}).cost;
      candidates.push_back({std::move(start), height_m, cost});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
  if (candidates.size() > kMostThorough) candidates.resize(kMostThorough);
  MassingFit best;
  for (const Candidate& c : candidates)
    best = std::min(best, FitPrism(silhouettes, c.start, {c.height_m}), IsBetter);
  // A single picture may have sides that only happen to look upright.
  if (silhouettes.size() == 1 && best.explained_ratio < kLeastExplainedRatio) return std::nullopt;
  if (best.polygon.outer.empty() || best.height_std_m > kLeastSureRatio * best.height_m ||
      best.height_m >= ceiling_m) {
    return std::nullopt;
  }
  return best;
}

void Apply(const MassingFit& fit, Footprint& footprint) {
  footprint.polygon_in_map_m = fit.polygon;
  footprint.corner_std_m = fit.corner_std_m;
  footprint.height_m = fit.height_m;
  footprint.height_std_m = fit.height_std_m;
}

bool IsShown(const std::vector<Silhouette>& pictures, const Vector2d& p, double height_m) {
  return std::any_of(pictures.begin(), pictures.end(), [&](const Silhouette& s) {
    const auto pixel = Project(s.view, {p.x(), p.y(), height_m});
    return pixel && IsWellInside(s.view, *pixel);
  });
}

/// Whether pictures that each cut the building show its whole roof together: no side of it is but the end of
/// a picture.
bool IsShownAllAround(const Footprint& footprint) {
  constexpr int kPlaces = 20;  // On a side.
  if (!AreParts(footprint.silhouettes)) return false;
  const Ring& ring = footprint.polygon_in_map_m.outer;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
    for (int k = 0; k < kPlaces; ++k) {
      const Vector2d p = ring[i] + side * k / kPlaces;
      if (!IsShown(footprint.silhouettes, p, footprint.height_m)) return false;
    }
  }
  return true;
}

/// Height, polygon and standard deviations from all silhouettes.
bool Understand(Footprint& footprint, double max_height_m) {
  footprint.captures.clear();
  for (const Silhouette& s : footprint.silhouettes) footprint.captures.push_back(s.capture_id);
  const std::optional<MassingFit> fit = FitToAll(footprint.silhouettes, max_height_m);
  if (fit) {
    Apply(*fit, footprint);
  } else if (!DrawOnGround(footprint)) {
    return false;
  }
  footprint.is_cut = !IsWhole(BestSilhouette(footprint.silhouettes)) && !IsShownAllAround(footprint);
  return true;
}

/// How far a whole silhouette lies beside the footprint, as far as the noise of its pose explains that.
Vector2d ShiftOfPose(const Silhouette& silhouette, const Polygon& polygon, double height_m) {
  const double reach_m = 3.0 * std::hypot(silhouette.view.position_std_m,
                                          CameraHeight(silhouette) * silhouette.view.orientation_std_rad);
  if (reach_m <= 0.0 || !IsWhole(silhouette)) return Vector2d::Zero();
  const Vector2d shift = Centroid(polygon) - Centroid(DrawAlone(silhouette, height_m));
  return shift * std::min(1.0, reach_m / std::max(1e-12, shift.norm()));
}

/// Of the places that a silhouette covers on the ground.
struct Covered {
  int places = 0;
  int explained = 0;
};

/// How many of them a building of this footprint and height would cover: those at which some part of the
/// plumb line on the footprint, or of the roof, appears in front. Only places that some of `pictures` show,
/// when there are any.
Covered CountExplained(const Silhouette& silhouette, const Polygon& polygon, double height_m,
                       const std::vector<Silhouette>& pictures) {
  constexpr int kLevels = 8;
  const Polygon shadow = DrawAlone(silhouette, 0.0);
  const Vector2d nadir = silhouette.view.map_from_camera.translation_m.head<2>();
  const double shrink = (CameraHeight(silhouette) - height_m) / CameraHeight(silhouette);
  const Vector2d shift = ShiftOfPose(silhouette, polygon, height_m);
  Covered covered;
  for (const Vector2d& p : GridOver(shadow.outer)) {
    if (!Contains(shadow.outer, p)) continue;
    const Vector2d on_roof = nadir + shrink * (p - nadir);
    if (!pictures.empty() && !(IsShown(pictures, p, 0.0) && IsShown(pictures, on_roof, height_m))) continue;
    ++covered.places;
    for (int level = 0; level <= kLevels; ++level) {
      const double k = 1.0 + (shrink - 1.0) * level / kLevels;
      if (Contains(polygon.outer, nadir + k * (p - nadir) + shift)) {
        ++covered.explained;
        break;
      }
    }
  }
  return covered;
}

double ShareExplained(const Silhouette& silhouette, const Polygon& polygon, double height_m) {
  const Covered covered = CountExplained(silhouette, polygon, height_m, {});
  return covered.places > 0 ? static_cast<double>(covered.explained) / covered.places : 0.0;
}

/// Whether what `other` was seen as is this building, or part of it. A height that is not known yet is tried
/// at a middling value.
bool Explains(const Footprint& building, const Footprint& other) {
  double ceiling_m = CameraHeight(other.silhouettes.front());
  for (const Silhouette& s : building.silhouettes) ceiling_m = std::min(ceiling_m, CameraHeight(s));
  double height_m = building.height_m > 0.0 ? building.height_m : other.height_m;
  if (!(height_m > 0.0 && height_m < 0.9 * ceiling_m)) height_m = kMiddlingHeightRatio * ceiling_m;
  const auto at_height = [&](const Footprint& f) {
    return f.height_m > 0.0 ? f.polygon_in_map_m : Draw(f.silhouettes, height_m);
  };
  if (building.is_cut && !other.is_cut) {  // Whatever stands in it, its silhouette covers the foot of it.
    return ShareInside(at_height(other).outer, Draw(building.silhouettes, 0.0).outer) >= kExplainedShare;
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
           return IsWhole(s) &&
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
                                                     [](const Silhouette& s) { return IsWhole(s); }));
  };
  if (count_whole(a) != count_whole(b)) return count_whole(a) > count_whole(b);
  return ExpectedError_m(BestSilhouette(a.silhouettes)) < ExpectedError_m(BestSilhouette(b.silhouettes));
}

std::vector<Silhouette> MarkedBlobs(std::vector<Silhouette> silhouettes) {
  for (Silhouette& s : silhouettes) s.holds_more = true;
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
      blob.silhouettes = MarkedBlobs(std::move(blob.silhouettes));
      blob.is_cut = true;
      if (is_known_larger) blobs.insert(blobs.end(), known.silhouettes.begin(), known.silhouettes.end());
    } else if (is_known_larger) {
      known = Join(std::move(known), MarkedBlobs(seen.silhouettes));
      return;
    } else {
      known.silhouettes = MarkedBlobs(std::move(known.silhouettes));
      known = Join(std::move(known), seen.silhouettes);
      return;
    }
  }
  seen = Join(std::move(seen), blobs);
  seen.object_id = next_id++;
  map.push_back(std::move(seen));
}

/// Whether a part of a building of this height covers what its pictures show of the other part.
bool Covers(const Footprint& part, const Footprint& other, double height_m) {
  constexpr int kLeastPlaces = 8;
  const Polygon drawn = Draw(part.silhouettes, height_m);
  Covered all;
  for (const Silhouette& s : other.silhouettes) {
    const Covered covered = CountExplained(s, drawn, height_m, part.silhouettes);
    all.places += covered.places;
    all.explained += covered.explained;
  }
  return all.places >= kLeastPlaces && all.explained >= kExplainedShare * all.places;
}

/// The building that two parts are of, if the edges of pictures parted it.
std::optional<Footprint> JoinParts(const Footprint& a, const Footprint& b) {
  if (!a.is_cut || !b.is_cut || a.color != b.color || !AreParts(a.silhouettes) || !AreParts(b.silhouettes))
    return std::nullopt;
  const Polygon ground = Draw(a.silhouettes, 0.0);
  if (!(ShareInside(Draw(b.silhouettes, 0.0).outer, ground.outer) > 0.0)) return std::nullopt;
  const Footprint together = Join(a, b.silhouettes);
  const bool is_one = Covers(a, b, together.height_m) && Covers(b, a, together.height_m);
  return is_one ? std::make_optional(together) : std::nullopt;
}

/// Joins what can be, until nothing can.
void JoinAllParts(std::vector<Footprint>& map) {
  for (std::size_t i = 0; i < map.size(); ++i) {
    for (std::size_t k = i + 1; k < map.size();) {
      std::optional<Footprint> together = JoinParts(map[i], map[k]);
      if (!together) {
        ++k;
        continue;
      }
      map[i] = std::move(*together);
      map.erase(map.begin() + static_cast<std::ptrdiff_t>(k));
      k = i + 1;
    }
  }
}

Outline WithoutRoofFurniture(Outline outline) {
  const double roof = Area(Polygon{outline.polygon_px.outer, {}});
  std::erase_if(outline.polygon_px.holes,
                [&](const Ring& hole) { return std::abs(SignedArea(hole)) < kLeastCourtyardRatio * roof; });
  return outline;
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
    footprint.silhouettes = {{image.capture_id, image.view, WithoutRoofFurniture(outline)}};
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
  JoinAllParts(merged);
  const std::vector<Footprint> all = merged;
  std::erase_if(merged, [&](const Footprint& f) { return f.is_cut && IsExplainedByOthers(f, all); });
  return merged;
}

Footprint WithHeight(const Footprint& footprint, double height_m, double height_std_m) {
  SOFFIT_EXPECT(height_m > 0.0 && height_std_m >= 0.0);
  SOFFIT_EXPECT(!footprint.silhouettes.empty());
  for (const Silhouette& s : footprint.silhouettes) SOFFIT_EXPECT(height_m < CameraHeight(s));
  const HeightPrior prior{height_m, 0.0};
  MassingFit fit = FitAt(footprint.silhouettes, prior);
  if (footprint.height_m > 0.0) {
    fit = std::min(fit, FitPrism(footprint.silhouettes, footprint.polygon_in_map_m, prior), IsBetter);
  }
  Footprint result = footprint;
  if (fit.polygon.outer.empty()) {
    result.polygon_in_map_m = Draw(footprint.silhouettes, height_m);
    result.corner_std_m.clear();
  } else {
    Apply(fit, result);
  }
  result.height_m = height_m;
  result.height_std_m = height_std_m;
  const Silhouette& best = BestSilhouette(footprint.silhouettes);
  const Vector2d nadir = best.view.map_from_camera.translation_m.head<2>();
  result.corner_std_m.resize(result.polygon_in_map_m.outer.size(), PoseStd_m(best));
  for (std::size_t i = 0; i < result.corner_std_m.size(); ++i) {
    const double lean = (result.polygon_in_map_m.outer[i] - nadir).norm() / CameraHeight(best);
    result.corner_std_m[i] = std::hypot(result.corner_std_m[i], height_std_m * lean);
  }
  return result;
}

}  // namespace soffit
