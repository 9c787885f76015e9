#include "service/pipeline/pipeline.h"

#include <algorithm>
#include <exception>
#include <map>
#include <utility>

#include "service/facade/align.h"
#include "service/footprint/shape.h"
#include "service/solid/face_picture.h"

namespace soffit {
namespace {

bool IsFromAbove(Purpose purpose) { return purpose == Purpose::kOverview || purpose == Purpose::kTop; }

void Extract(Image image, const PipelineOptions& options, Observation& seen) {
  seen.image = std::move(image);
  seen.mask = SegmentBuildings(seen.image, options.mask);
  seen.outlines = TraceOutlines(seen.mask, seen.image.seen, options.outline);
  if (!IsFromAbove(seen.image.purpose)) return;
  JudgedOutlines judged = JudgeOutlines(std::move(seen.outlines), seen.image);
  seen.outlines = std::move(judged.buildings);
  seen.refused = std::move(judged.refused);
}

struct HorizontalViews {
  std::vector<Image> images;
  std::vector<Mask> masks;
  std::vector<Sight> sights;
};

HorizontalViews CollectHorizontalViews(const std::vector<Observation>& observations) {
  HorizontalViews views;
  for (const Observation& seen : observations) {
    if (IsFromAbove(seen.image.purpose)) continue;
    views.images.push_back(seen.image);
    views.masks.push_back(seen.mask);
    views.sights.push_back(seen.sight);
  }
  return views;
}

/// The picture's view as it was adjusted to a wanted building, where it was.
void TakeAdjustedView(const std::vector<SceneObject>& objects, Sight& sight) {
  for (const SceneObject& object : objects) {
    for (const Silhouette& silhouette : object.footprint.silhouettes) {
      if (!object.is_matched || silhouette.capture_id != sight.capture_id) continue;
      sight.view.map_from_camera = silhouette.view.map_from_camera;
      sight.view.position_std_m = silhouette.view.position_std_m;
      sight.view.orientation_std_rad = silhouette.view.orientation_std_rad;
    }
  }
}

/// Of all pictures, as they were adjusted.
std::vector<Sight> CollectSights(const std::vector<Observation>& observations,
                                 const HorizontalViews& horizontal, const std::vector<SceneObject>& objects) {
  std::vector<Sight> sights = horizontal.sights;
  for (const Observation& seen : observations) {
    if (!IsFromAbove(seen.image.purpose)) continue;
    sights.push_back(seen.sight);
    TakeAdjustedView(objects, sights.back());
  }
  return sights;
}

/// Where the buildings that are no plain prisms were seen from beside, by object.
using Shapings = std::map<std::uint32_t, std::vector<Silhouette>>;

/// The vector map of the pictures from above, with the shapes that those from beside show.
std::vector<Footprint> MakeVectorMap(const std::vector<Observation>& observations, Shapings& shapings) {
  std::vector<Footprint> map;
  std::vector<Silhouette> beside;
  for (const Observation& seen : observations) {
    map = MergeFootprints(map, seen.footprints);
    if (IsFromAbove(seen.image.purpose)) continue;
    for (const Outline& outline : seen.outlines)
      beside.push_back({seen.image.capture_id, seen.image.view, outline});
  }
  for (Footprint& footprint : map) {
    std::optional<Shaping> shaping = ShapeBuilding(footprint, beside);
    if (!shaping) continue;
    footprint = std::move(shaping->footprint);
    shapings[footprint.object_id] = std::move(shaping->beside);
  }
  return map;
}

/// Only whole shapes can be recognized; `Match::shapes` of the answer index `map`.
std::vector<Match> Recognize(const std::vector<Footprint>& map, const Reference& reference,
                             const MatchOptions& options) {
  std::vector<std::size_t> whole;
  std::vector<TracedShape> shapes;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i].is_cut) continue;
    whole.push_back(i);
    const std::vector<double>& stds = map[i].corner_std_m;
    const double position_std_m = stds.empty() ? 0.0 : *std::max_element(stds.begin(), stds.end());
    shapes.push_back({map[i].polygon_in_map_m, 0.0, position_std_m});
  }
  std::vector<Match> matches = FindMatches(shapes, reference, options);
  for (Match& match : matches) {
    for (std::size_t& shape : match.shapes) shape = whole[shape];
  }
  return matches;
}

/// The wanted objects are those of the best match, unless another place fits about as well.
std::vector<SceneObject> MarkWanted(const std::vector<Footprint>& map, const std::vector<Match>& matches,
                                    int neighbours) {
  std::vector<SceneObject> objects;
  for (const Footprint& footprint : map)
    objects.push_back({footprint, false, {}, FindNeighbours(footprint, map, neighbours)});
  if (matches.empty() || matches.front().is_ambiguous) return objects;
  for (const std::size_t shape : matches.front().shapes) {
    objects[shape].is_matched = true;
    objects[shape].match = matches.front();
  }
  return objects;
}

/// Fits the best match once more, to the footprints as the models adjusted them.
void RefineMatch(std::vector<SceneObject>& objects, Match& match, const Reference& reference,
                 const MatchOptions& options) {
  std::vector<TracedShape> shapes;
  for (const std::size_t shape : match.shapes) shapes.push_back({objects[shape].footprint.polygon_in_map_m});
  const std::vector<Match> found = FindMatches(shapes, reference, options);
  if (found.empty() || found.front().shapes.size() != match.shapes.size()) return;
  Match refined = found.front();
  for (std::size_t& shape : refined.shapes) shape = match.shapes[shape];
  refined.score = match.score;
  refined.is_ambiguous = match.is_ambiguous;
  match = refined;
  for (const std::size_t shape : match.shapes) objects[shape].match = match;
}

std::string DescribeRecognition(const std::vector<Match>& matches) {
  if (matches.empty()) return "the wanted building is not among those that were seen";
  if (!matches.front().is_ambiguous) return "";
  return "the wanted building may be any of several that fit about as well (matches: " +
         std::to_string(matches.size()) + "): give a reference with its neighbours";
}

/// The building and the pictures of it, adjusted to each other; one with levels already is.
Alignment Align(const Footprint& object, const Shapings& shapings, const HorizontalViews& views,
                const FacadeOptions& options) {
  const auto shaping = shapings.find(object.object_id);
  if (shaping == shapings.end()) return AlignSights(object, views.masks, views.sights, options);
  Alignment aligned{object, views.sights};
  for (Sight& sight : aligned.sights) {
    for (const Silhouette& silhouette : shaping->second) {
      if (silhouette.capture_id == sight.capture_id) sight.view = silhouette.view;
    }
  }
  return aligned;
}

/// The model of a wanted building has what the horizontal pictures show of its walls, that of another one is
/// plain. The pictures that show a wanted building are adjusted to it. A stage that throws has a bug or met a
/// library's failure: the building stays unknown then.
Result<Solid> ModelObject(const SceneObject& object, const Shapings& shapings, HorizontalViews& views,
                          const PipelineOptions& options, std::vector<Facade>& facades) try {
  if (!object.is_matched) return RaiseSolid(object.footprint, {});
  const Alignment aligned = Align(object.footprint, shapings, views, options.facade);
  std::vector<Facade> walls =
      ReadFacades(aligned.footprint, views.images, views.masks, aligned.sights, options.facade);
  views.sights = aligned.sights;
  facades.insert(facades.end(), walls.begin(), walls.end());
  return RaiseSolid(aligned.footprint, walls);
} catch (const std::exception& failure) {
  return Error{Error::Code::kInternal, failure.what()};
}

ClearanceDecision Undecided(std::uint32_t object_id, const std::string& problem,
                            const VehicleEnvelope& vehicle) {
  ClearanceDecision decision;
  decision.object_id = object_id;
  decision.reason = problem;
  decision.vehicle = vehicle;
  return decision;
}

std::vector<ClearanceDecision> Decide(const Scene& scene, std::uint32_t object_id,
                                      const std::vector<Sight>& sights, const VehicleEnvelope& vehicle,
                                      const PipelineOptions& options) try {
  const std::vector<Corridor> corridors = PlanCorridors(scene, object_id, vehicle, options.corridor);
  return JudgeClearance(scene, object_id, corridors, sights, vehicle, options.clearance);
} catch (const std::exception& failure) {
  return {Undecided(object_id, failure.what(), vehicle)};
}

}  // namespace

Result<Observation> Observe(const Capture& capture, const PipelineOptions& options) try {
  Result<Image> image = DecodeImage(capture, options.image);
  if (!image.ok()) return image.error();
  Observation seen;
  const Image kept = ShrinkImage(image.value(), options.image.kept_megapixels);
  if (IsFromAbove(capture.purpose)) {
    Extract(image.value(), options, seen);
    seen.footprints = TraceFootprints(seen.image, seen.outlines, options.footprint);
  }
  if (seen.image.bgr.size() != kept.bgr.size()) Extract(kept, options, seen);
  seen.sight = LabelSight(seen.image, seen.mask, options.facade);
  return seen;
} catch (const std::exception& failure) {
  return Error{Error::Code::kInternal, capture.name + ": " + failure.what()};
}

Understanding Understand(const std::vector<Observation>& observations, const Reference& reference,
                         const VehicleEnvelope& vehicle, std::uint64_t revision,
                         const PipelineOptions& options, const Eigen::Vector3d& map_origin_m) {
  Understanding all;
  HorizontalViews views = CollectHorizontalViews(observations);
  Shapings shapings;
  std::vector<Footprint> map = MakeVectorMap(observations, shapings);
  all.matches = Recognize(map, reference, options.match);
  std::vector<SceneObject> objects = MarkWanted(map, all.matches, options.scene.neighbours);
  if (const std::string problem = DescribeRecognition(all.matches); !problem.empty())
    all.problems.push_back(problem);

  std::vector<Solid> solids;
  for (SceneObject& object : objects) {
    const std::uint32_t id = object.footprint.object_id;
    Result<Solid> solid = ModelObject(object, shapings, views, options, all.facades);
    if (solid.ok()) {
      object.footprint = solid.value().footprint;
      solids.push_back(std::move(solid).value());
    } else if (object.is_matched) {
      all.problems.push_back("building " + std::to_string(id) + ": no model: " + solid.error().message);
      all.decisions.push_back(Undecided(id, "no model: " + solid.error().message, vehicle));
    }
  }

  const bool is_found =
      std::any_of(objects.begin(), objects.end(), [](const auto& object) { return object.is_matched; });
  if (is_found) RefineMatch(objects, all.matches.front(), reference, options.match);

  const std::vector<Sight> sights = CollectSights(observations, views, objects);
  for (const Sight& sight : sights) all.views[sight.capture_id] = sight.view;
  solids = FindFacePictures(std::move(solids), all.facades, sights);
  all.scene = BuildScene(revision, std::move(objects), std::move(solids), sights, options.scene);
  all.scene.map_origin_m = map_origin_m;
  for (const SceneObject& object : all.scene.objects) {
    const std::uint32_t id = object.footprint.object_id;
    const bool is_modelled =
        std::any_of(all.scene.solids.begin(), all.scene.solids.end(),
                    [id](const Solid& solid) { return solid.footprint.object_id == id; });
    if (!object.is_matched || !is_modelled) continue;
    for (ClearanceDecision& decision : Decide(all.scene, id, sights, vehicle, options)) {
      all.decisions.push_back(std::move(decision));
    }
  }
  for (ClearanceDecision& decision : all.decisions) decision.scene_revision = revision;
  return all;
}

}  // namespace soffit
