#include <algorithm>

#include "service/edge/dds/request_id.h"
#include "service/edge/dds/scene_fields.h"
#include "service/edge/dds/service_topics.h"

namespace soffit {
namespace {

constexpr double kMaxTimeout_s = 60.0;

}  // namespace

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::SceneQuery>& m, ValueOf<Io, SceneQuery>& v) {
  io("id", m.id(), v.id);
  io("kind", m.kind(), v.kind, Last{wire::QUERY_REVISIONS});
  io("vehicle_id", m.vehicle_id(), v.vehicle_id);
  io("scene_revision", m.scene_revision(), v.scene_revision);
  io("timeout_s", m.timeout_s(), v.timeout_s, AtLeast{0.0}, AtMost{kMaxTimeout_s});
  io("from_in_map_m", m.from_in_map_m(), v.from_in_map_m);
  io("to_in_map_m", m.to_in_map_m(), v.to_in_map_m);
  io("range_m", m.range_m(), v.range_m, AtLeast{0.0});
  io("resolution_m", m.resolution_m(), v.resolution_m, AtLeast{0.0});
  io("object_id", m.object_id(), v.object_id);
  io("reference_name", m.reference_name(), v.reference_name);
  io("vehicle", m.vehicle(), v.vehicle);
  io("since_revision", m.since_revision(), v.since_revision);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Cell>& m, ValueOf<Io, Cell>& v) {
  io("center_in_map_m", m.center_in_map_m(), v.center_in_map_m);
  io("size_m", m.size_m(), v.size_m, AtLeast{0.0});
  io("occupancy", m.occupancy(), v.occupancy, Last{wire::OCCUPANCY_OCCUPIED});
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::CellGrid>& m, ValueOf<Io, CellGrid>& v) {
  io("low_in_map_m", m.low_in_map_m(), v.low_in_map_m);
  io("resolution_m", m.resolution_m(), v.resolution_m, AtLeast{0.0});
  io("size_x", m.size_x(), v.size.x());
  io("size_y", m.size_y(), v.size.y());
  io("size_z", m.size_z(), v.size.z());
  io("occupancy", m.occupancy(), v.occupancy);
  const double cells = 1.0 * m.size_x() * m.size_y() * m.size_z();
  io.Require(cells == static_cast<double>(m.occupancy().size()), "has another number of cells than its size");
  const auto is_known = [](std::uint8_t cell) { return cell <= wire::OCCUPANCY_OCCUPIED; };
  io.Require(std::all_of(m.occupancy().begin(), m.occupancy().end(), is_known),
             "has a cell of no known kind");
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Nearest>& m, ValueOf<Io, Nearest>& v) {
  io("is_found", m.is_found(), v.is_found);
  io("distance_m", m.distance_m(), v.distance_m);
  io("point_in_map_m", m.point_in_map_m(), v.point_in_map_m);
  io("object_id", m.object_id(), v.object_id);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Layer>& m, ValueOf<Io, Layer>& v) {
  io("bottom_m", m.bottom_m(), v.bottom_m);
  io("top_m", m.top_m(), v.top_m);
  io("occupancy", m.occupancy(), v.occupancy, Last{wire::OCCUPANCY_OCCUPIED});
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Change>& m, ValueOf<Io, Change>& v) {
  io("kind", m.kind(), v.kind, Last{wire::CHANGE_REMOVED});
  io("thing", m.thing(), v.thing, Last{wire::THING_DECISION});
  io("object_id", m.object_id(), v.object_id);
  io("side", m.side(), v.side);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Revision>& m, ValueOf<Io, Revision>& v) {
  io("mission_id", m.mission_id(), v.mission_id);
  io("scene_revision", m.scene_revision(), v.scene_revision);
  io("stamp_utc_ns", m.stamp_utc_ns(), v.stamp_utc_ns);
  io("objects", m.objects(), v.objects);
  io("models", m.models(), v.models);
  io("decisions", m.decisions(), v.decisions);
  io("octree_nodes", m.octree_nodes(), v.octree_nodes);
  io("is_kept", m.is_kept(), v.is_kept);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::SceneReply>& m, ValueOf<Io, SceneReply>& v) {
  io("id", m.id(), v.id);
  io("status", m.status(), v.status, Last{wire::ANSWER_FAILED});
  io("message", m.message(), v.message);
  io("vehicle_id", m.vehicle_id(), v.origin.vehicle_id);
  io("mission_id", m.mission_id(), v.origin.mission_id);
  io("scene_revision", m.scene_revision(), v.origin.scene_revision);
  io("stamp_utc_ns", m.stamp_utc_ns(), v.stamp_utc_ns);
  io("resolution_m", m.resolution_m(), v.resolution_m, AtLeast{0.0});

  io("occupancy", m.occupancy(), v.occupancy, Last{wire::OCCUPANCY_OCCUPIED});
  io("free_ratio", m.free_ratio(), v.shares.free_ratio, AtLeast{0.0});
  io("occupied_ratio", m.occupied_ratio(), v.shares.occupied_ratio, AtLeast{0.0});
  io("unknown_ratio", m.unknown_ratio(), v.shares.unknown_ratio, AtLeast{0.0});
  io("grid", m.grid(), v.grid);
  io("cells", m.cells(), v.cells, MaxItems{kMaxReplyCells});
  io("has_more", m.has_more(), v.has_more);

  io("ray", m.ray(), v.ray, Last{wire::RAY_OUT_OF_RANGE});
  io("distance_m", m.distance_m(), v.distance_m);
  io("point_in_map_m", m.point_in_map_m(), v.point_in_map_m);

  io("nearest_occupied", m.nearest_occupied(), v.nearest_occupied);
  io("nearest_unknown", m.nearest_unknown(), v.nearest_unknown);
  io("surface", m.surface(), v.surface);

  io("layers", m.layers(), v.layers, MaxItems{1024});
  io.Optional("height_m", m.has_height(), m.height_m(), v.height_m);

  io("objects", m.objects(), v.objects, MaxItems{kMaxReplyObjects});
  io("distances_m", m.distances_m(), v.distances_m, MaxItems{kMaxReplyObjects});
  io.Optional("model", m.model(), v.model);

  io("decisions", m.decisions(), v.decisions, MaxItems{64});
  io("verdict", m.verdict(), v.verdict, Last{wire::VERDICT_CLEAR});
  io("path_in_map_m", m.path_in_map_m(), v.path_in_map_m, MaxItems{kMaxReplyPoints});

  io("changes", m.changes(), v.changes, MaxItems{kMaxReplyChanges});
  io("changed_cells", m.changed_cells(), v.changed_cells);
  const bool has_box = m.changed_cells() > 0;
  if (Io::kReads ? has_box : !v.changed_in_map_m.isEmpty()) {
    io("changed_from_in_map_m", m.changed_from_in_map_m(), v.changed_in_map_m.min());
    io("changed_to_in_map_m", m.changed_to_in_map_m(), v.changed_in_map_m.max());
  }

  io("revisions", m.revisions(), v.revisions, NewestItems{{256}});
}

wire::SceneQuery SceneQueryTopic::ToWire(const SceneQuery& value) {
  return WriteMessage<wire::SceneQuery>(value);
}

Result<SceneQuery> SceneQueryTopic::FromWire(const wire::SceneQuery& message) {
  const Result<SceneQuery> read = ReadMessage<SceneQuery>(message);
  if (read.ok()) return read;
  SceneQuery unreadable;
  unreadable.id = {message.id().client(), message.id().sequence_number()};
  unreadable.problem = read.error().message;
  return unreadable;
}

wire::SceneReply SceneReplyTopic::ToWire(const SceneReply& value) {
  return WriteMessage<wire::SceneReply>(value);
}
Result<SceneReply> SceneReplyTopic::FromWire(const wire::SceneReply& message) {
  return ReadMessage<SceneReply>(message);
}

const char* ToString(AnswerStatus status) {
  switch (status) {
    case AnswerStatus::kOk:
      return "ok";
    case AnswerStatus::kBadRequest:
      return "bad request";
    case AnswerStatus::kNoScene:
      return "no scene";
    case AnswerStatus::kNoRevision:
      return "no such revision";
    case AnswerStatus::kNotFound:
      return "not found";
    case AnswerStatus::kTooLarge:
      return "too large";
    case AnswerStatus::kTooLate:
      return "too late";
    case AnswerStatus::kFailed:
      return "failed";
    case AnswerStatus::kNone:
      break;
  }
  return "not answered";
}

const char* ToString(ChangeKind kind) {
  switch (kind) {
    case ChangeKind::kAdded:
      return "added";
    case ChangeKind::kChanged:
      return "changed";
    case ChangeKind::kRemoved:
      return "removed";
    case ChangeKind::kNone:
      break;
  }
  return "not changed";
}

const char* ToString(ChangedThing thing) {
  switch (thing) {
    case ChangedThing::kModel:
      return "model";
    case ChangedThing::kDecision:
      return "decision";
    case ChangedThing::kObject:
      break;
  }
  return "object";
}

}  // namespace soffit
