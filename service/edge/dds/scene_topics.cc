#include <algorithm>

#include "service/edge/dds/request_id.h"
#include "service/edge/dds/service_topics.h"
#include "shared/wire/basic.h"

namespace soffit {
namespace {

constexpr std::size_t kMaxNeighbours = 16;
constexpr std::size_t kMaxDecisions = 64;

template <class To, class From>
To EnumAs(From value) {
  return static_cast<To>(static_cast<int>(value));
}

void CheckFinite(const wire::Polygon& polygon, Check& check) {
  const auto check_ring = [&](const wire::Ring& ring) {
    for (const wire::Vector2& corner : ring.corners_m()) {
      check.Require(std::isfinite(corner.x()) && std::isfinite(corner.y()),
                    "a corner of the footprint is not finite");
    }
  };
  check_ring(polygon.outer());
  for (const wire::Ring& hole : polygon.holes()) check_ring(hole);
}

wire::Opening OpeningToWire(const SolidOpening& opening) {
  wire::Opening out;
  out.wall(opening.wall);
  out.polygon_in_map_m(ToWire(opening.polygon_in_map_m));
  out.is_through(opening.is_through);
  out.depth_m(opening.depth_m);
  out.std_m(opening.std_m);
  return out;
}

wire::Viewpoint ViewpointToWire(const Viewpoint& view) {
  wire::Viewpoint out;
  out.purpose(ToWire(view.purpose));
  out.position_in_map_m(ToWire(view.position_in_map_m));
  out.yaw_rad(view.yaw_rad);
  out.pitch_rad(view.pitch_rad);
  out.reason(view.reason);
  return out;
}

wire::Corridor CorridorToWire(const Corridor& corridor) {
  wire::Corridor out;
  out.entry_wall(corridor.entry_wall);
  out.exit_wall(corridor.exit_wall);
  out.entry_in_map_m(ToWire(corridor.entry_in_map_m));
  out.exit_in_map_m(ToWire(corridor.exit_in_map_m));
  out.free_width_m(corridor.free_width_m);
  out.free_height_m(corridor.free_height_m);
  out.floor_m(corridor.floor_m);
  out.std_m(corridor.std_m);
  out.limited_by(corridor.limited_by);
  return out;
}

Corridor CorridorFromWire(const wire::Corridor& message, std::uint32_t object_id) {
  Corridor corridor;
  corridor.object_id = object_id;
  corridor.entry_wall = message.entry_wall();
  corridor.exit_wall = message.exit_wall();
  corridor.entry_in_map_m = FromWire(message.entry_in_map_m());
  corridor.exit_in_map_m = FromWire(message.exit_in_map_m());
  corridor.free_width_m = message.free_width_m();
  corridor.free_height_m = message.free_height_m();
  corridor.floor_m = message.floor_m();
  corridor.std_m = message.std_m();
  corridor.limited_by = message.limited_by().to_string();
  return corridor;
}

void CheckCorridor(const wire::Corridor& corridor, Check& check) {
  check.Finite(corridor.entry_in_map_m(), "corridor.entry_in_map_m");
  check.Finite(corridor.exit_in_map_m(), "corridor.exit_in_map_m");
  check.AtLeast(0.0, corridor.free_width_m(), "corridor.free_width_m");
  check.AtLeast(0.0, corridor.free_height_m(), "corridor.free_height_m");
  check.Finite(corridor.floor_m(), "corridor.floor_m");
  check.AtLeast(0.0, corridor.std_m(), "corridor.std_m");
}

}  // namespace

wire::SceneObject SceneObjectTopic::ToWire(const SceneObjectReport& value) {
  const Footprint& footprint = value.object.footprint;
  wire::SceneObject out;
  out.vehicle_id(value.origin.vehicle_id);
  out.object_id(footprint.object_id);
  out.mission_id(value.origin.mission_id);
  out.scene_revision(value.origin.scene_revision);
  out.color(footprint.color);
  out.footprint(soffit::ToWire(footprint.polygon_in_map_m));
  out.corner_std_m(footprint.corner_std_m);
  out.height_m(footprint.height_m);
  out.height_std_m(footprint.height_std_m);
  out.is_cut(footprint.is_cut);
  const auto& neighbours = value.object.neighbours;
  out.neighbours().assign(neighbours.begin(), neighbours.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                                       neighbours.size(), kMaxNeighbours)));
  out.is_matched(value.object.is_matched);
  if (value.object.is_matched) {
    out.match_scale_m_per_px(value.object.match.scale);
    out.match_rotation_cw_rad(value.object.match.rotation_cw_rad);
    out.match_score(value.object.match.score);
  }
  return out;
}

Result<SceneObjectReport> SceneObjectTopic::FromWire(const wire::SceneObject& message) {
  Check check;
  CheckFinite(message.footprint(), check);
  for (const double std_m : message.corner_std_m()) check.AtLeast(0.0, std_m, "corner_std_m");
  check.AtLeast(0.0, message.height_m(), "height_m");
  check.AtLeast(0.0, message.height_std_m(), "height_std_m");
  check.Require(message.neighbours().size() <= kMaxNeighbours, "more than 16 neighbours");
  check.Finite(message.match_scale_m_per_px(), "match_scale_m_per_px");
  check.Finite(message.match_rotation_cw_rad(), "match_rotation_cw_rad");
  check.Finite(message.match_score(), "match_score");
  if (!check.problem().empty()) return InvalidInput(check.problem());

  SceneObjectReport value;
  value.origin = {message.vehicle_id(), message.mission_id(), message.scene_revision()};
  Footprint& footprint = value.object.footprint;
  footprint.object_id = message.object_id();
  footprint.color = message.color().to_string();
  footprint.polygon_in_map_m = soffit::FromWire(message.footprint());
  footprint.corner_std_m = message.corner_std_m();
  footprint.height_m = message.height_m();
  footprint.height_std_m = message.height_std_m();
  footprint.is_cut = message.is_cut();
  value.object.neighbours = message.neighbours();
  value.object.is_matched = message.is_matched();
  value.object.match.scale = message.match_scale_m_per_px();
  value.object.match.rotation_cw_rad = message.match_rotation_cw_rad();
  value.object.match.score = message.match_score();
  return value;
}

wire::BuildingModel BuildingModelTopic::ToWire(const BuildingModelReport& value) {
  wire::BuildingModel out;
  out.vehicle_id(value.origin.vehicle_id);
  out.object_id(value.object_id);
  out.mission_id(value.origin.mission_id);
  out.scene_revision(value.origin.scene_revision);
  out.vertices_in_map_m(soffit::ToWire(value.mesh.vertices_in_map_m));
  out.triangles().reserve(value.mesh.triangles.size());
  for (const auto& corners : value.mesh.triangles) {
    wire::Triangle triangle;
    triangle.a(static_cast<std::uint32_t>(corners[0]));
    triangle.b(static_cast<std::uint32_t>(corners[1]));
    triangle.c(static_cast<std::uint32_t>(corners[2]));
    out.triangles().push_back(triangle);
  }
  out.volume_m3(value.volume_m3);
  for (const SolidOpening& opening : value.openings) out.openings().push_back(OpeningToWire(opening));
  return out;
}

Result<BuildingModelReport> BuildingModelTopic::FromWire(const wire::BuildingModel& message) {
  Check check;
  for (const wire::Vector3& vertex : message.vertices_in_map_m()) check.Finite(vertex, "vertices_in_map_m");
  const std::size_t vertices = message.vertices_in_map_m().size();
  for (const wire::Triangle& t : message.triangles()) {
    check.Require(t.a() < vertices && t.b() < vertices && t.c() < vertices,
                  "a triangle names a vertex that is not there");
  }
  check.Finite(message.volume_m3(), "volume_m3");
  for (const wire::Opening& opening : message.openings()) {
    for (const wire::Vector3& corner : opening.polygon_in_map_m())
      check.Finite(corner, "openings.polygon_in_map_m");
    check.AtLeast(0.0, opening.depth_m(), "openings.depth_m");
    check.AtLeast(0.0, opening.std_m(), "openings.std_m");
  }
  if (!check.problem().empty()) return InvalidInput(check.problem());

  BuildingModelReport value;
  value.origin = {message.vehicle_id(), message.mission_id(), message.scene_revision()};
  value.object_id = message.object_id();
  value.mesh.vertices_in_map_m = soffit::FromWire(message.vertices_in_map_m());
  for (const wire::Triangle& t : message.triangles()) {
    value.mesh.triangles.push_back(
        {static_cast<int>(t.a()), static_cast<int>(t.b()), static_cast<int>(t.c())});
  }
  value.volume_m3 = message.volume_m3();
  for (const wire::Opening& o : message.openings()) {
    value.openings.push_back(
        {o.wall(), soffit::FromWire(o.polygon_in_map_m()), o.is_through(), o.depth_m(), o.std_m()});
  }
  return value;
}

wire::ClearanceDecision ClearanceDecisionTopic::ToWire(const DecisionReport& value) {
  const ClearanceDecision& decision = value.decision;
  wire::ClearanceDecision out;
  out.vehicle_id(decision.vehicle_id);
  out.object_id(decision.object_id);
  out.side(decision.side);
  out.decision_id(decision.decision_id);
  out.mission_id(value.mission_id);
  out.scene_revision(decision.scene_revision);
  out.decided_utc_ns(value.decided_utc_ns);
  out.valid_until_utc_ns(value.valid_until_utc_ns);
  out.verdict(EnumAs<wire::Verdict>(decision.verdict));
  out.reason(decision.reason);
  out.has_corridor(decision.corridor.has_value());
  if (decision.corridor) out.corridor(CorridorToWire(*decision.corridor));
  out.vehicle(soffit::ToWire(decision.vehicle));
  out.margin_left_m(decision.margin_left_m);
  out.margin_right_m(decision.margin_right_m);
  out.margin_up_m(decision.margin_up_m);
  out.margin_down_m(decision.margin_down_m);
  out.seen_ratio(decision.seen_ratio);
  out.evidence_capture_ids(decision.evidence);
  out.has_wanted_view(decision.wanted.has_value());
  if (decision.wanted) out.wanted_view(ViewpointToWire(*decision.wanted));
  return out;
}

Result<DecisionReport> ClearanceDecisionTopic::FromWire(const wire::ClearanceDecision& message) {
  Check check;
  check.Known(message.verdict(), wire::VERDICT_CLEAR, "verdict");
  check.Require(message.verdict() != wire::VERDICT_CLEAR || message.has_corridor(),
                "CLEAR without a corridor");
  CheckCorridor(message.corridor(), check);
  for (const double margin_m :
       {message.margin_left_m(), message.margin_right_m(), message.margin_up_m(), message.margin_down_m()}) {
    check.Finite(margin_m, "a margin");
  }
  check.AtLeast(0.0, message.seen_ratio(), "seen_ratio");
  check.Known(message.wanted_view().purpose(), wire::PURPOSE_CORRIDOR, "wanted_view.purpose");
  check.Finite(message.wanted_view().position_in_map_m(), "wanted_view.position_in_map_m");
  check.Finite(message.wanted_view().yaw_rad(), "wanted_view.yaw_rad");
  check.Finite(message.wanted_view().pitch_rad(), "wanted_view.pitch_rad");
  if (!check.problem().empty()) return InvalidInput(check.problem());

  DecisionReport value;
  value.mission_id = message.mission_id();
  value.decided_utc_ns = message.decided_utc_ns();
  value.valid_until_utc_ns = message.valid_until_utc_ns();
  ClearanceDecision& decision = value.decision;
  decision.decision_id = message.decision_id();
  decision.vehicle_id = message.vehicle_id();
  decision.object_id = message.object_id();
  decision.side = message.side();
  decision.verdict = EnumAs<Verdict>(message.verdict());
  decision.reason = message.reason().to_string();
  if (message.has_corridor()) decision.corridor = CorridorFromWire(message.corridor(), message.object_id());
  decision.vehicle = soffit::FromWire(message.vehicle());
  decision.margin_left_m = message.margin_left_m();
  decision.margin_right_m = message.margin_right_m();
  decision.margin_up_m = message.margin_up_m();
  decision.margin_down_m = message.margin_down_m();
  decision.seen_ratio = message.seen_ratio();
  decision.evidence = message.evidence_capture_ids();
  if (message.has_wanted_view()) {
    const wire::Viewpoint& view = message.wanted_view();
    decision.wanted = Viewpoint{EnumAs<Purpose>(view.purpose()),
                                soffit::FromWire(view.position_in_map_m()),
                                view.yaw_rad(),
                                view.pitch_rad(),
                                message.object_id(),
                                -1,
                                view.reason().to_string()};
  }
  decision.scene_revision = message.scene_revision();
  return value;
}

wire::SceneQuery SceneQueryTopic::ToWire(const SceneQuery& value) {
  wire::SceneQuery out;
  out.id(RequestIdToWire(value.id));
  out.kind(EnumAs<wire::QueryKind>(value.kind));
  out.vehicle_id(value.vehicle_id);
  out.object_id(value.object_id);
  out.min_in_map_m(soffit::ToWire(value.min_in_map_m));
  out.max_in_map_m(soffit::ToWire(value.max_in_map_m));
  return out;
}

Result<SceneQuery> SceneQueryTopic::FromWire(const wire::SceneQuery& message) {
  Check check;
  check.Known(message.kind(), wire::QUERY_CLEARANCE, "kind");
  check.Finite(message.min_in_map_m(), "min_in_map_m");
  check.Finite(message.max_in_map_m(), "max_in_map_m");
  if (!check.problem().empty()) return InvalidInput(check.problem());
  return SceneQuery{RequestIdFromWire(message.id()),
                    EnumAs<SceneQueryKind>(message.kind()),
                    message.vehicle_id(),
                    message.object_id(),
                    soffit::FromWire(message.min_in_map_m()),
                    soffit::FromWire(message.max_in_map_m())};
}

wire::SceneReply SceneReplyTopic::ToWire(const SceneReply& value) {
  wire::SceneReply out;
  out.id(RequestIdToWire(value.id));
  out.is_answered(value.is_answered);
  out.message(value.message);
  out.scene_revision(value.scene_revision);
  out.occupancy(EnumAs<wire::Occupancy>(value.occupancy));
  out.free_ratio(value.free_ratio);
  out.occupied_ratio(value.occupied_ratio);
  out.unknown_ratio(value.unknown_ratio);
  if (value.object) out.object().push_back(SceneObjectTopic::ToWire(*value.object));
  if (value.model) out.model().push_back(BuildingModelTopic::ToWire(*value.model));
  for (const DecisionReport& decision : value.decisions) {
    if (out.decisions().size() < kMaxDecisions)
      out.decisions().push_back(ClearanceDecisionTopic::ToWire(decision));
  }
  return out;
}

Result<SceneReply> SceneReplyTopic::FromWire(const wire::SceneReply& message) {
  Check check;
  check.Known(message.occupancy(), wire::OCCUPANCY_OCCUPIED, "occupancy");
  check.AtLeast(0.0, message.free_ratio(), "free_ratio");
  check.AtLeast(0.0, message.occupied_ratio(), "occupied_ratio");
  check.AtLeast(0.0, message.unknown_ratio(), "unknown_ratio");
  check.Require(message.object().size() <= 1 && message.model().size() <= 1, "more than one object or model");
  check.Require(message.decisions().size() <= kMaxDecisions, "more than 64 decisions");
  if (!check.problem().empty()) return InvalidInput(check.problem());

  SceneReply value;
  value.id = RequestIdFromWire(message.id());
  value.is_answered = message.is_answered();
  value.message = message.message().to_string();
  value.scene_revision = message.scene_revision();
  value.occupancy = EnumAs<Occupancy>(message.occupancy());
  value.free_ratio = message.free_ratio();
  value.occupied_ratio = message.occupied_ratio();
  value.unknown_ratio = message.unknown_ratio();
  for (const wire::SceneObject& object : message.object()) {
    auto read = SceneObjectTopic::FromWire(object);
    if (!read.ok()) return read.error();
    value.object = std::move(read).value();
  }
  for (const wire::BuildingModel& model : message.model()) {
    auto read = BuildingModelTopic::FromWire(model);
    if (!read.ok()) return read.error();
    value.model = std::move(read).value();
  }
  for (const wire::ClearanceDecision& decision : message.decisions()) {
    auto read = ClearanceDecisionTopic::FromWire(decision);
    if (!read.ok()) return read.error();
    value.decisions.push_back(std::move(read).value());
  }
  return value;
}

const char* ToString(Occupancy occupancy) {
  switch (occupancy) {
    case Occupancy::kFree:
      return "free";
    case Occupancy::kOccupied:
      return "occupied";
    case Occupancy::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace soffit
