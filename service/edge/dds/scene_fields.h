#pragma once

#include <algorithm>
#include <array>

#include "service/edge/dds/messages.h"
#include "shared/wire/fields.h"

// What the scene's topics, and the answers to questions about it, are made of.

namespace soffit {

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::SceneObject>& m, ValueOf<Io, SceneObjectReport>& v) {
  io("vehicle_id", m.vehicle_id(), v.origin.vehicle_id);
  io("object_id", m.object_id(), v.object.footprint.object_id);
  io("mission_id", m.mission_id(), v.origin.mission_id);
  io("scene_revision", m.scene_revision(), v.origin.scene_revision);
  io("color", m.color(), v.object.footprint.color);
  io("footprint", m.footprint(), v.object.footprint.polygon_in_map_m);
  io("corner_std_m", m.corner_std_m(), v.object.footprint.corner_std_m, AtLeast{0.0});
  io("height_m", m.height_m(), v.object.footprint.height_m, AtLeast{0.0});
  io("height_std_m", m.height_std_m(), v.object.footprint.height_std_m, AtLeast{0.0});
  io("is_cut", m.is_cut(), v.object.footprint.is_cut);
  io("neighbours", m.neighbours(), v.object.neighbours, MaxItems{16});
  io("is_matched", m.is_matched(), v.object.is_matched);
  io("match_scale_m_per_px", m.match_scale_m_per_px(), v.object.match.scale);
  io("match_rotation_cw_rad", m.match_rotation_cw_rad(), v.object.match.rotation_cw_rad);
  io("match_score", m.match_score(), v.object.match.score);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Triangle>& m, ValueOf<Io, std::array<int, 3>>& v) {
  io("a", m.a(), v[0]);
  io("b", m.b(), v[1]);
  io("c", m.c(), v[2]);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Opening>& m, ValueOf<Io, SolidOpening>& v) {
  io("wall", m.wall(), v.wall);
  io("polygon_in_map_m", m.polygon_in_map_m(), v.polygon_in_map_m);
  io("is_through", m.is_through(), v.is_through);
  io("depth_m", m.depth_m(), v.depth_m, AtLeast{0.0});
  io("std_m", m.std_m(), v.std_m, AtLeast{0.0});
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::BuildingModel>& m, ValueOf<Io, BuildingModelReport>& v) {
  io("vehicle_id", m.vehicle_id(), v.origin.vehicle_id);
  io("object_id", m.object_id(), v.object_id);
  io("mission_id", m.mission_id(), v.origin.mission_id);
  io("scene_revision", m.scene_revision(), v.origin.scene_revision);
  io("vertices_in_map_m", m.vertices_in_map_m(), v.mesh.vertices_in_map_m);
  io("triangles", m.triangles(), v.mesh.triangles);
  const auto is_there = [&](const wire::Triangle& t) {
    return std::max({t.a(), t.b(), t.c()}) < m.vertices_in_map_m().size();
  };
  io.Require(std::all_of(m.triangles().begin(), m.triangles().end(), is_there),
             "a triangle names a vertex that is not there");
  io("volume_m3", m.volume_m3(), v.volume_m3);
  io("openings", m.openings(), v.openings);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Viewpoint>& m, ValueOf<Io, Viewpoint>& v) {
  io("purpose", m.purpose(), v.purpose, Last{wire::PURPOSE_CORRIDOR});
  io("position_in_map_m", m.position_in_map_m(), v.position_in_map_m);
  io("yaw_rad", m.yaw_rad(), v.yaw_rad);
  io("pitch_rad", m.pitch_rad(), v.pitch_rad);
  io("reason", m.reason(), v.reason);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::Corridor>& m, ValueOf<Io, Corridor>& v) {
  io("entry_wall", m.entry_wall(), v.entry_wall);
  io("exit_wall", m.exit_wall(), v.exit_wall);
  io("entry_in_map_m", m.entry_in_map_m(), v.entry_in_map_m);
  io("exit_in_map_m", m.exit_in_map_m(), v.exit_in_map_m);
  io("bends_in_map_m", m.bends_in_map_m(), v.bends_in_map_m);
  io("free_width_m", m.free_width_m(), v.free_width_m, AtLeast{0.0});
  io("free_height_m", m.free_height_m(), v.free_height_m, AtLeast{0.0});
  io("left_m", m.left_m(), v.left_m);
  io("floor_m", m.floor_m(), v.floor_m);
  io("std_m", m.std_m(), v.std_m, AtLeast{0.0});
  io("limited_by", m.limited_by(), v.limited_by);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::ClearanceDecision>& m, ValueOf<Io, DecisionReport>& report) {
  auto& v = report.decision;
  io("vehicle_id", m.vehicle_id(), v.vehicle_id);
  io("object_id", m.object_id(), v.object_id);
  io("side", m.side(), v.side);
  io("decision_id", m.decision_id(), v.decision_id);
  io("mission_id", m.mission_id(), report.mission_id);
  io("scene_revision", m.scene_revision(), v.scene_revision);
  io("decided_utc_ns", m.decided_utc_ns(), report.decided_utc_ns);
  io("valid_until_utc_ns", m.valid_until_utc_ns(), report.valid_until_utc_ns);
  io("verdict", m.verdict(), v.verdict, Last{wire::VERDICT_CLEAR});
  io("reason", m.reason(), v.reason);
  io.Optional("corridor", m.has_corridor(), m.corridor(), v.corridor);
  io.Require(v.verdict != Verdict::kClear || v.corridor, "CLEAR without a corridor");
  io("vehicle", m.vehicle(), v.vehicle);
  io("margin_left_m", m.margin_left_m(), v.margin_left_m);
  io("margin_right_m", m.margin_right_m(), v.margin_right_m);
  io("margin_up_m", m.margin_up_m(), v.margin_up_m);
  io("margin_down_m", m.margin_down_m(), v.margin_down_m);
  io("binding", m.binding(), v.binding, Last{wire::BOUND_GROUND});
  io("distance_to_occupied_m", m.distance_to_occupied_m(), v.distances.to_occupied_m, AtLeast{0.0});
  io("distance_to_unknown_m", m.distance_to_unknown_m(), v.distances.to_unknown_m, AtLeast{0.0});
  io("distance_to_surface_m", m.distance_to_surface_m(), v.distances.to_surface_m, AtLeast{0.0});
  io("seen_ratio", m.seen_ratio(), v.seen_ratio, AtLeast{0.0});
  io("evidence_capture_ids", m.evidence_capture_ids(), v.evidence);
  io.Optional("wanted_view", m.has_wanted_view(), m.wanted_view(), v.wanted);
  if constexpr (Io::kReads) {
    if (v.corridor) v.corridor->object_id = v.object_id;
    if (v.wanted) v.wanted->object_id = v.object_id;
  }
}

}  // namespace soffit
