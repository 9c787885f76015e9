#include "service/pipeline/pipeline.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace soffit {
namespace {

bool IsFromAbove(Purpose purpose) { return purpose == Purpose::kOverview || purpose == Purpose::kTop; }

std::vector<Footprint> MakeVectorMap(const std::vector<Observation>& observations) {
  std::vector<Footprint> map;
  for (const Observation& seen : observations) map = MergeFootprints(map, seen.footprints);
  return map;
}

/// Only whole shapes can be recognized; `Match::shapes` of the answer index `map`.
std::vector<Match> Recognize(const std::vector<Footprint>& map, const Reference& reference, const MatchOptions& options) {
  std::vector<std::size_t> whole;
  std::vector<TracedShape> shapes;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (map[i].is_cut) continue;
    whole.push_back(i);
    shapes.push_back({map[i].polygon_in_map_m});
  }
  std::vector<Match> matches = FindMatches(shapes, reference, options);
  for (Match& match : matches) {
    for (std::size_t& shape : match.shapes) shape = whole[shape];
  }
  return matches;
}

ClearanceDecision NotModelled(std::uint32_t object_id, const std::string& problem, const VehicleEnvelope& vehicle,
                              std::uint64_t revision) {
  ClearanceDecision decision;
  decision.object_id = object_id;
  decision.reason = "no model: " + problem;
  decision.vehicle = vehicle;
  decision.scene_revision = revision;
  return decision;
}

std::string NameOf(const Footprint& object) { return "building " + std::to_string(object.object_id); }

/// A stage that throws has a bug or met a library's failure: what it was working on stays unknown.
template <class Work>
std::string ProblemOf(Work&& work) {
  try {
    return work();
  } catch (const std::exception& failure) {
    return failure.what();
  }
}

}  // namespace

Result<Observation> Observe(const Capture& capture, const PipelineOptions& options) try {
  Result<Image> image = DecodeImage(capture, options.image);
  if (!image.ok()) return image.error();
  Observation seen;
  seen.image = std::move(image).value();
  seen.mask = SegmentBuildings(seen.image, options.mask);
  seen.outlines = TraceOutlines(seen.mask, seen.image.seen, options.outline);
  if (IsFromAbove(capture.purpose)) {
    seen.footprints = TraceFootprints(seen.image, seen.outlines, options.footprint);
  } else {
    seen.sight = LabelSight(seen.image, seen.mask, options.facade);
  }
  return seen;
} catch (const std::exception& failure) {
  return Error{Error::Code::kInternal, capture.name + ": " + failure.what()};
}

Understanding Understand(const std::vector<Observation>& observations, const Reference& reference,
                         const VehicleEnvelope& vehicle, std::uint64_t revision, const PipelineOptions& options) {
  Understanding all;
  std::vector<Image> images;
  std::vector<Mask> masks;
  std::vector<Sight> sights;
  for (const Observation& seen : observations) {
    if (IsFromAbove(seen.image.purpose)) continue;
    images.push_back(seen.image);
    masks.push_back(seen.mask);
    sights.push_back(seen.sight);
  }

  const std::vector<Footprint> map = MakeVectorMap(observations);
  all.matches = Recognize(map, reference, options.match);
  const bool is_found = !all.matches.empty() && !all.matches.front().is_ambiguous;
  if (all.matches.empty()) all.problems.push_back("the wanted building is not among those that were seen");
  if (!all.matches.empty() && !is_found) {
    all.problems.push_back("the wanted building was found in " + std::to_string(all.matches.size()) +
                           " places that fit about as well: give a reference with its neighbours");
  }

  std::vector<SceneObject> objects;
  std::vector<Solid> solids;
  for (std::size_t i = 0; i < map.size(); ++i) {
    SceneObject object{map[i], false, {}, FindNeighbours(map[i], map, options.scene.neighbours)};
    if (is_found) {
      const Match& match = all.matches.front();
      object.is_matched = std::count(match.shapes.begin(), match.shapes.end(), i) > 0;
      if (object.is_matched) object.match = match;
    }
    if (object.is_matched) {
      std::string problem = ProblemOf([&]() -> std::string {
        std::vector<Facade> facades = ReadFacades(map[i], images, masks, sights, options.facade);
        const Result<Solid> solid = RaiseSolid(map[i], facades, options.solid);
        all.facades.insert(all.facades.end(), facades.begin(), facades.end());
        if (!solid.ok()) return solid.error().message;
        object.footprint = solid.value().footprint;
        solids.push_back(solid.value());
        return "";
      });
      if (!problem.empty()) {
        all.problems.push_back(NameOf(map[i]) + ": " + problem);
        all.decisions.push_back(NotModelled(map[i].object_id, problem, vehicle, revision));
      }
    }
    objects.push_back(std::move(object));
  }

  all.scene = BuildScene(revision, std::move(objects), std::move(solids), sights, options.scene);
  for (const Solid& solid : all.scene.solids) {
    const std::uint32_t id = solid.footprint.object_id;
    const std::vector<Corridor> corridors = PlanCorridors(all.scene, id, vehicle, options.corridor);
    for (ClearanceDecision& decision : JudgeClearance(all.scene, id, corridors, sights, vehicle, options.clearance)) {
      all.decisions.push_back(std::move(decision));
    }
  }
  return all;
}

}  // namespace soffit
