#include "service/edge/live/scene_answers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "service/query/surface.h"
#include "service/query/way.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

constexpr std::size_t kListedRevisions = 256;
constexpr double kMaxSearchCells = 4e6;
constexpr double kLargest_m = 10.0;  // Width and height of a vehicle that a way is looked for.
constexpr double kMaxWay_m = 1000.0;
constexpr double kForever_m = std::numeric_limits<double>::infinity();

/// One question on its way to its answer.
struct Question {
  const SceneQuery& query;
  const SceneHistory& history;
  const SceneSnapshot& snapshot;
  const PipelineOptions& options;
  const IsLate& is_late;
  SceneReply reply;

  const Scene& scene() const { return snapshot.understanding->scene; }
  const octomap::OcTree& octree() const { return *scene().octree; }
  double range_m() const { return query.range_m > 0.0 ? query.range_m : kForever_m; }
  VehicleEnvelope vehicle() const { return IsOfMission() ? snapshot.vehicle : query.vehicle; }
  bool IsOfMission() const {
    const VehicleEnvelope& v = query.vehicle;
    return v.radius_m == 0.0 && v.height_m == 0.0 && v.safety_margin_m == 0.0;
  }

  SceneReply Refuse(AnswerStatus status, const std::string& why) {
    reply.status = status;
    reply.message = why;
    return std::move(reply);
  }
  SceneReply TakeReply() { return std::move(reply); }
};

// ---- Occupancy ----

SceneReply AnswerPoint(Question q) {
  const Cell cell = CellAt(q.octree(), q.query.from_in_map_m, q.query.resolution_m);
  q.reply.occupancy = cell.occupancy;
  q.reply.cells = {cell};
  return q.TakeReply();
}

SceneReply AnswerBox(Question q) {
  const Eigen::AlignedBox3d box_m(q.query.from_in_map_m.cwiseMin(q.query.to_in_map_m),
                                  q.query.from_in_map_m.cwiseMax(q.query.to_in_map_m));
  if (!(box_m.sizes().minCoeff() > 0.0)) {
    return q.Refuse(AnswerStatus::kBadRequest, "the box is empty: its corners must differ on every axis");
  }
  if (!std::isfinite(box_m.volume()))
    return q.Refuse(AnswerStatus::kBadRequest, "the box is larger than any map");
  if (q.query.resolution_m > 0.0) {
    const double cells = CountCells(box_m, q.query.resolution_m);
    if (!(cells <= static_cast<double>(kMaxReplyGridCells))) {
      return q.Refuse(AnswerStatus::kTooLarge, Say("the box has more than ", kMaxReplyGridCells,
                                                   " cells of that resolution: ask for a part of it"));
    }
    q.reply.grid = GridOf(q.octree(), box_m, q.query.resolution_m);
  }
  q.reply.shares = SharesOf(q.octree(), box_m);
  q.reply.occupancy = q.reply.shares.Worst();
  return q.TakeReply();
}

SceneReply AnswerRay(Question q) {
  const Eigen::Vector3d way_m = q.query.to_in_map_m - q.query.from_in_map_m;
  const double length_m = way_m.norm();
  if (!(length_m > 0.0) || !std::isfinite(length_m))
    return q.Refuse(AnswerStatus::kBadRequest, "the ray has no direction");
  const Eigen::Vector3d direction = way_m / length_m;
  const double range_m = q.query.range_m > 0.0 ? q.query.range_m : length_m;
  const Ray ray = CastRay(q.octree(), q.query.from_in_map_m, direction, range_m);
  q.reply.ray = ray.end;
  q.reply.distance_m = ray.distance_m;
  q.reply.point_in_map_m = q.query.from_in_map_m + ray.distance_m * direction;
  if (ray.end == RayEnd::kHit || ray.end == RayEnd::kUnknown) q.reply.cells = {ray.cell};
  q.reply.occupancy = ray.end == RayEnd::kHit    ? Occupancy::kOccupied
                      : ray.end == RayEnd::kFree ? Occupancy::kFree
                                                 : Occupancy::kUnknown;
  return q.TakeReply();
}

Nearest ToNearest(const std::optional<CellDistance>& found) {
  if (!found) return {};
  return {true, found->distance_m, found->point_in_map_m, 0};
}

SceneReply AnswerNearest(Question q) {
  const Eigen::Vector3d& from_m = q.query.from_in_map_m;
  q.reply.nearest_occupied =
      ToNearest(FindNearest(q.octree(), from_m, Occupancy::kOccupied, q.range_m(), q.is_late));
  q.reply.nearest_unknown =
      ToNearest(FindNearest(q.octree(), from_m, Occupancy::kUnknown, q.range_m(), q.is_late));
  if (const auto surface = DistanceToModels(q.scene(), from_m, q.range_m())) {
    q.reply.surface = {true, surface->signed_m, surface->point_in_map_m, surface->object_id};
  }
  return q.TakeReply();
}

// ---- Objects ----

double LevelDistance(const Footprint& footprint, const Eigen::Vector2d& place_m) {
  const Polygon& polygon = footprint.polygon_in_map_m;
  if (Contains(polygon, place_m)) return 0.0;
  double distance_m = DistanceToRing(place_m, polygon.outer);
  for (const Ring& hole : polygon.holes) distance_m = std::min(distance_m, DistanceToRing(place_m, hole));
  return distance_m;
}

/// Those within `range_m` that `is_wanted`, nearest first.
template <class IsWanted>
void ListObjects(Question& q, double range_m, const IsWanted& is_wanted) {
  std::multimap<double, const SceneObject*> found;
  for (const SceneObject& object : q.scene().objects) {
    if (!is_wanted(object)) continue;
    const double distance_m = LevelDistance(object.footprint, q.query.from_in_map_m.head<2>());
    if (distance_m <= range_m) found.emplace(distance_m, &object);
  }
  for (const auto& [distance_m, object] : found) {
    if (q.reply.objects.size() == kMaxReplyObjects) {
      q.reply.has_more = true;
      return;
    }
    q.reply.objects.push_back({q.snapshot.origin, *object});
    q.reply.distances_m.push_back(distance_m);
  }
}

SceneReply AnswerColumn(Question q) {
  const Eigen::Vector2d place_m = q.query.from_in_map_m.head<2>();
  q.reply.layers = LayersAt(q.octree(), place_m);
  q.reply.height_m = ModelHeightAt(q.scene(), place_m);
  for (const Layer& layer : q.reply.layers) {
    if (layer.occupancy != Occupancy::kOccupied) continue;
    q.reply.height_m = std::max(layer.top_m, q.reply.height_m.value_or(layer.top_m));
  }
  ListObjects(q, 0.0, [](const SceneObject&) { return true; });
  return q.TakeReply();
}

SceneReply AnswerObjects(Question q) {
  const SceneQuery& query = q.query;
  if (!query.reference_name.empty() && query.reference_name != q.snapshot.reference_name) {
    return q.Refuse(AnswerStatus::kNotFound, "this mission looks for '" + q.snapshot.reference_name +
                                                 "', not for '" + query.reference_name + "'");
  }
  ListObjects(q, q.range_m(), [&](const SceneObject& object) {
    return (query.object_id == 0 || object.footprint.object_id == query.object_id) &&
           (query.reference_name.empty() || object.is_matched);
  });
  if (query.object_id == 0) return q.TakeReply();
  if (q.reply.objects.empty())
    return q.Refuse(AnswerStatus::kNotFound, Say("there is no object ", query.object_id, " there"));
  for (const Solid& solid : q.scene().solids) {
    if (solid.footprint.object_id == query.object_id) q.reply.model = ReportModel(q.snapshot.origin, solid);
  }
  return q.TakeReply();
}

// ---- Ways ----

SceneReply AnswerClearance(Question q) {
  const std::uint32_t object_id = q.query.object_id;
  const auto& objects = q.scene().objects;
  if (std::none_of(objects.begin(), objects.end(),
                   [&](const SceneObject& object) { return object.footprint.object_id == object_id; })) {
    return q.Refuse(AnswerStatus::kNotFound, Say("there is no object ", object_id));
  }
  if (q.IsOfMission()) {
    for (const DecisionReport& report : q.snapshot.decisions) {
      if (report.decision.object_id == object_id) q.reply.decisions.push_back(report);
    }
    if (!q.reply.decisions.empty()) return q.TakeReply();
  }
  const VehicleEnvelope vehicle = q.vehicle();
  const auto corridors = PlanCorridors(q.scene(), object_id, vehicle, q.options.corridor);
  for (const ClearanceDecision& decision :
       JudgeClearance(q.scene(), object_id, corridors, {}, vehicle, q.options.clearance)) {
    DecisionReport report;
    report.mission_id = q.snapshot.origin.mission_id;
    report.decided_utc_ns = q.snapshot.stamp_utc_ns;
    report.decision = decision;
    report.decision.vehicle_id = q.snapshot.origin.vehicle_id;
    report.decision.scene_revision = q.snapshot.origin.scene_revision;
    q.reply.decisions.push_back(report);
  }
  return q.TakeReply();
}

SceneReply AnswerWay(Question q) {
  const double length_m = (q.query.to_in_map_m - q.query.from_in_map_m).norm();
  if (!(length_m <= kMaxWay_m))
    return q.Refuse(AnswerStatus::kTooLarge, Say("a way may have ", kMaxWay_m, " m"));
  const Way way =
      q.query.kind == SceneQueryKind::kWay
          ? CheckWay(q.scene(), {q.query.from_in_map_m, q.query.to_in_map_m}, q.vehicle(), q.is_late)
          : FindWay(q.scene(), q.query.from_in_map_m, q.query.to_in_map_m, q.vehicle(), kMaxSearchCells,
                    q.is_late);
  q.reply.verdict = way.verdict;
  q.reply.message = way.reason;
  q.reply.distance_m = way.length_m;
  q.reply.cells = way.in_the_way;
  q.reply.has_more = way.in_the_way.size() == kMaxReplyCells;
  if (way.points_in_map_m.size() > kMaxReplyPoints)
    return q.Refuse(AnswerStatus::kTooLarge, "the way has too many turns: ask for a part of it");
  q.reply.path_in_map_m = way.points_in_map_m;
  return q.TakeReply();
}

// ---- Changes ----

bool IsAlike(const SceneObject& a, const SceneObject& b) {
  return a.footprint.color == b.footprint.color &&
         a.footprint.polygon_in_map_m.outer == b.footprint.polygon_in_map_m.outer &&
         a.footprint.polygon_in_map_m.holes == b.footprint.polygon_in_map_m.holes &&
         a.footprint.height_m == b.footprint.height_m && a.footprint.is_cut == b.footprint.is_cut &&
         a.is_matched == b.is_matched && a.neighbours == b.neighbours;
}

bool IsAlike(const Solid& a, const Solid& b) {
  const auto has_same_mouth = [](const SolidOpening& x, const SolidOpening& y) {
    return x.wall == y.wall && x.polygon_in_map_m == y.polygon_in_map_m && x.is_through == y.is_through;
  };
  return a.mesh.vertices_in_map_m == b.mesh.vertices_in_map_m && a.mesh.triangles == b.mesh.triangles &&
         std::equal(a.openings.begin(), a.openings.end(), b.openings.begin(), b.openings.end(),
                    has_same_mouth);
}

bool IsAlike(const DecisionReport& a, const DecisionReport& b) {
  const ClearanceDecision& x = a.decision;
  const ClearanceDecision& y = b.decision;
  if (x.corridor.has_value() != y.corridor.has_value()) return false;
  const bool has_same_way = !x.corridor || (x.corridor->entry_in_map_m == y.corridor->entry_in_map_m &&
                                            x.corridor->exit_in_map_m == y.corridor->exit_in_map_m);
  return x.verdict == y.verdict && x.reason == y.reason && has_same_way;
}

std::pair<std::uint32_t, int> KeyOf(const SceneObject& object) { return {object.footprint.object_id, -1}; }
std::pair<std::uint32_t, int> KeyOf(const Solid& solid) { return {solid.footprint.object_id, -1}; }
std::pair<std::uint32_t, int> KeyOf(const DecisionReport& report) {
  return {report.decision.object_id, report.decision.side};
}

template <class T>
void AddChanges(ChangedThing thing, const std::vector<T>& before, const std::vector<T>& after,
                std::vector<Change>& changes) {
  std::map<std::pair<std::uint32_t, int>, const T*> known;
  for (const T& item : before) known[KeyOf(item)] = &item;
  for (const T& item : after) {
    const auto key = KeyOf(item);
    const auto earlier = known.find(key);
    if (earlier == known.end()) {
      changes.push_back({ChangeKind::kAdded, thing, key.first, key.second});
      continue;
    }
    if (!IsAlike(*earlier->second, item))
      changes.push_back({ChangeKind::kChanged, thing, key.first, key.second});
    known.erase(earlier);
  }
  for (const auto& [key, item] : known)
    changes.push_back({ChangeKind::kRemoved, thing, key.first, key.second});
}

std::shared_ptr<const SceneSnapshot> FindRevision(const SceneHistory& history, std::uint64_t revision) {
  const auto found = std::find_if(history.kept.begin(), history.kept.end(), [&](const auto& snapshot) {
    return snapshot->origin.scene_revision == revision;
  });
  return found != history.kept.end() ? *found : nullptr;
}

std::string DescribeKept(const SceneHistory& history, std::uint64_t wanted) {
  return Say("revision ", wanted, " is not kept: there are ", history.kept.front()->origin.scene_revision,
             " to ", history.kept.back()->origin.scene_revision);
}

SceneReply AnswerChanges(Question q) {
  static const SceneSnapshot kNothing;
  static const Scene kEmpty;
  const std::uint64_t since = q.query.since_revision;
  const auto earlier = FindRevision(q.history, since);
  if (since != 0 && !earlier)
    return q.Refuse(AnswerStatus::kNoRevision, DescribeKept(q.history, since) + "; 0 asks for everything");
  const SceneSnapshot& before = earlier ? *earlier : kNothing;
  const Scene& scene = earlier ? earlier->understanding->scene : kEmpty;
  AddChanges(ChangedThing::kObject, scene.objects, q.scene().objects, q.reply.changes);
  AddChanges(ChangedThing::kModel, scene.solids, q.scene().solids, q.reply.changes);
  AddChanges(ChangedThing::kDecision, before.decisions, q.snapshot.decisions, q.reply.changes);
  const octomap::OcTree nothing(q.octree().getResolution());
  const CellChanges cells = CompareOctrees(earlier ? *scene.octree : nothing, q.octree(), kMaxReplyCells);
  q.reply.changed_cells = cells.count;
  q.reply.changed_in_map_m = cells.box_in_map_m;
  q.reply.cells = cells.cells;
  q.reply.has_more = cells.has_more || q.reply.changes.size() > kMaxReplyChanges;
  return q.TakeReply();
}

SceneReply AnswerRevisions(Question q) {
  q.reply.revisions = q.history.revisions;
  return q.TakeReply();
}

SceneReply Answer(Question q) {
  switch (q.query.kind) {
    case SceneQueryKind::kPoint:
      return AnswerPoint(std::move(q));
    case SceneQueryKind::kBox:
      return AnswerBox(std::move(q));
    case SceneQueryKind::kRay:
      return AnswerRay(std::move(q));
    case SceneQueryKind::kNearest:
      return AnswerNearest(std::move(q));
    case SceneQueryKind::kColumn:
      return AnswerColumn(std::move(q));
    case SceneQueryKind::kObjects:
      return AnswerObjects(std::move(q));
    case SceneQueryKind::kClearance:
    case SceneQueryKind::kWay:
    case SceneQueryKind::kPath:
      if (!IsValid(q.vehicle())) {
        return q.Refuse(AnswerStatus::kBadRequest,
                        "the vehicle needs a radius and a height, and no negative margin");
      }
      if (q.query.kind == SceneQueryKind::kClearance) return AnswerClearance(std::move(q));
      if (std::max(q.vehicle().NeededWidth_m(), q.vehicle().NeededHeight_m()) > kLargest_m) {
        return q.Refuse(AnswerStatus::kBadRequest, Say("with its margin the vehicle is wider or higher than ",
                                                       kLargest_m, " m: ask for a smaller one"));
      }
      return AnswerWay(std::move(q));
    case SceneQueryKind::kChanges:
      return AnswerChanges(std::move(q));
    case SceneQueryKind::kRevisions:
      return AnswerRevisions(std::move(q));
    case SceneQueryKind::kNone:
      break;
  }
  return q.Refuse(AnswerStatus::kBadRequest, "the query has no kind");
}

}  // namespace

SceneHistory MakeHistory(std::vector<Revision> revisions,
                         std::vector<std::shared_ptr<const SceneSnapshot>> kept) {
  SceneHistory history{std::move(kept), std::move(revisions)};
  if (history.kept.size() > kKeptRevisions) history.kept.erase(history.kept.begin());
  if (history.revisions.size() > kListedRevisions)
    history.revisions.erase(history.revisions.begin(), history.revisions.end() - kListedRevisions);
  for (Revision& revision : history.revisions)
    revision.is_kept = FindRevision(history, revision.scene_revision) != nullptr;
  return history;
}

SceneHistory Extend(const SceneHistory& history, std::shared_ptr<const SceneSnapshot> snapshot) {
  SceneHistory extended;
  const bool is_same_mission =
      !history.kept.empty() && history.kept.front()->origin.mission_id == snapshot->origin.mission_id;
  if (is_same_mission) extended = history;
  if (snapshot->understanding == nullptr) return extended;
  extended.revisions.push_back(DescribeRevision(*snapshot));
  extended.kept.push_back(std::move(snapshot));
  return MakeHistory(std::move(extended.revisions), std::move(extended.kept));
}

BuildingModelReport ReportModel(const Origin& origin, const Solid& solid) {
  return {origin, solid.footprint.object_id, solid.mesh, solid.volume_m3, solid.openings};
}

SceneReply AnswerQuery(const SceneQuery& query, const SceneHistory& history, const PipelineOptions& options,
                       const IsLate& is_late) {
  SceneReply reply;
  reply.id = query.id;
  const auto refuse = [&](AnswerStatus status, const std::string& why) {
    reply.status = status;
    reply.message = why;
    return reply;
  };
  if (!query.problem.empty()) return refuse(AnswerStatus::kBadRequest, query.problem);
  reply.origin.vehicle_id = query.vehicle_id;
  if (history.kept.empty())
    return refuse(AnswerStatus::kNoScene, Say("no scene is known for vehicle ", query.vehicle_id));
  const auto snapshot =
      query.scene_revision == 0 ? history.kept.back() : FindRevision(history, query.scene_revision);
  if (!snapshot) return refuse(AnswerStatus::kNoRevision, DescribeKept(history, query.scene_revision));
  reply.status = AnswerStatus::kOk;
  reply.origin = snapshot->origin;
  reply.stamp_utc_ns = snapshot->stamp_utc_ns;
  reply.resolution_m = snapshot->understanding->scene.octree->getResolution();
  const auto too_late = [&] { return refuse(AnswerStatus::kTooLate, "the timeout of the query passed"); };
  if (is_late()) return too_late();
  SceneReply answer = Answer({query, history, *snapshot, options, is_late, reply});
  return is_late() ? too_late() : answer;
}

}  // namespace soffit
