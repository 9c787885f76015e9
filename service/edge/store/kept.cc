#include "service/edge/store/kept.h"

#include "service/edge/store/record.h"

namespace soffit {

// ---- Vehicles and pictures ----

template <class Io>
void Record(Io& io, RecordOf<Io, VehicleEnvelope>& v) {
  io("radius_m", v.radius_m);
  io("height_m", v.height_m);
  io("safety_margin_m", v.safety_margin_m);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Intrinsics>& v) {
  io("width_px", v.width_px);
  io("height_px", v.height_px);
  io("fx_px", v.fx_px);
  io("fy_px", v.fy_px);
  io("cx_px", v.cx_px);
  io("cy_px", v.cy_px);
  io("distortion", v.distortion);
}

template <class Io>
void Record(Io& io, RecordOf<Io, GeodeticOrigin>& v) {
  io("latitude_deg", v.latitude_deg);
  io("longitude_deg", v.longitude_deg);
  io("altitude_amsl_m", v.altitude_amsl_m);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Pose<Map, Camera>>& v) {
  io("rotation", v.rotation);
  io("translation_m", v.translation_m);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Capture>& v) {
  io("vehicle_id", v.vehicle_id);
  io("mission_id", v.mission_id);
  io("capture_id", v.capture_id);
  io("name", v.name);
  io("purpose", v.purpose, UpTo{Purpose::kCorridor});
  io("exposure_utc_ns", v.exposure_utc_ns);
  io("intrinsics", v.intrinsics);
  io("map_from_camera", v.map_from_camera);
  io("has_trusted_pose", v.has_trusted_pose);
  io("position_std_m", v.position_std_m);
  io("orientation_std_rad", v.orientation_std_rad);
}

/// What a vehicle is, not what it does.
template <class Io>
void Record(Io& io, RecordOf<Io, VehicleState>& v) {
  io("vehicle_id", v.vehicle_id);
  io("agent_epoch", v.agent_epoch);
  io("name", v.name);
  io("autopilot", v.autopilot);
  io("origin", v.origin);
  io("envelope", v.envelope);
  io("camera", v.camera);
  io("max_speed_mps", v.max_speed_mps);
}

// ---- Scenes ----

template <class Io>
void Record(Io& io, RecordOf<Io, Polygon>& v) {
  io("outer", v.outer);
  io("holes", v.holes);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Level>& v) {
  io("height_m", v.height_m);
  io("inset_m", v.inset_m);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Footprint>& v) {
  io("object_id", v.object_id);
  io("color", v.color);
  io("polygon_in_map_m", v.polygon_in_map_m);
  io("corner_std_m", v.corner_std_m);
  io("height_m", v.height_m);
  io("height_std_m", v.height_std_m);
  io("levels", v.levels);
  io("is_cut", v.is_cut);
  io("captures", v.captures);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Match>& v) {
  io("shapes", v.shapes);
  io("scale", v.scale);
  io("rotation_cw_rad", v.rotation_cw_rad);
  io("equivalent_rotations_cw_rad", v.equivalent_rotations_cw_rad);
  io("translation", v.translation);
  io("score", v.score);
  io("is_ambiguous", v.is_ambiguous);
}

template <class Io>
void Record(Io& io, RecordOf<Io, SceneObject>& v) {
  io("footprint", v.footprint);
  io("is_matched", v.is_matched);
  io("match", v.match);
  io("neighbours", v.neighbours);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Mesh>& v) {
  io("vertices_in_map_m", v.vertices_in_map_m);
  io("triangles", v.triangles);
}

template <class Io>
void Record(Io& io, RecordOf<Io, SolidOpening>& v) {
  io("wall", v.wall);
  io("polygon_in_map_m", v.polygon_in_map_m);
  io("is_through", v.is_through);
  io("depth_m", v.depth_m);
  io("std_m", v.std_m);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Passage>& v) {
  io("entry_wall", v.entry_wall);
  io("exit_wall", v.exit_wall);
  io("entry_opening", v.entry_opening);
  io("exit_opening", v.exit_opening);
  io("sections_in_map_m", v.sections_in_map_m);
  io("std_m", v.std_m);
}

template <class Io>
void Record(Io& io, RecordOf<Io, FacePicture>& v) {
  io("capture_id", v.capture_id);
  io("outline_px", v.outline_px);
  io("shown_ratio", v.shown_ratio);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Face>& v) {
  io("kind", v.kind, UpTo{FaceKind::kBack});
  io("wall", v.wall);
  io("opening", v.opening);
  io("triangles", v.triangles);
  io("picture", v.picture);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Solid>& v) {
  io("footprint", v.footprint);
  io("mesh", v.mesh);
  io("volume_m3", v.volume_m3);
  io("openings", v.openings);
  io("passages", v.passages);
  io("faces", v.faces);
  io("unseen_walls", v.unseen_walls);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Obstacle>& v) {
  io("base_in_map_m", v.base_in_map_m);
  io("radius_m", v.radius_m);
  io("height_m", v.height_m);
  io("is_top_seen", v.is_top_seen);
  io("std_m", v.std_m);
  io("captures", v.captures);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Scene>& v) {
  io("revision", v.revision);
  io("objects", v.objects);
  io("solids", v.solids);
  io("obstacles", v.obstacles);
  io("clutter", v.clutter);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Viewpoint>& v) {
  io("purpose", v.purpose, UpTo{Purpose::kCorridor});
  io("position_in_map_m", v.position_in_map_m);
  io("yaw_rad", v.yaw_rad);
  io("pitch_rad", v.pitch_rad);
  io("object_id", v.object_id);
  io("side", v.side);
  io("reason", v.reason);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Corridor>& v) {
  io("object_id", v.object_id);
  io("entry_wall", v.entry_wall);
  io("exit_wall", v.exit_wall);
  io("entry_in_map_m", v.entry_in_map_m);
  io("exit_in_map_m", v.exit_in_map_m);
  io("bends_in_map_m", v.bends_in_map_m);
  io("free_width_m", v.free_width_m);
  io("free_height_m", v.free_height_m);
  io("left_m", v.left_m);
  io("floor_m", v.floor_m);
  io("std_m", v.std_m);
  io("place_std_m", v.place_std_m);
  io("limited_by", v.limited_by);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Distances>& v) {
  io("to_occupied_m", v.to_occupied_m);
  io("to_unknown_m", v.to_unknown_m);
  io("to_surface_m", v.to_surface_m);
}

template <class Io>
void Record(Io& io, RecordOf<Io, ClearanceDecision>& v) {
  io("decision_id", v.decision_id);
  io("vehicle_id", v.vehicle_id);
  io("object_id", v.object_id);
  io("side", v.side);
  io("verdict", v.verdict, UpTo{Verdict::kClear});
  io("reason", v.reason);
  io("corridor", v.corridor);
  io("vehicle", v.vehicle);
  io("margin_left_m", v.margin_left_m);
  io("margin_right_m", v.margin_right_m);
  io("margin_up_m", v.margin_up_m);
  io("margin_down_m", v.margin_down_m);
  io("binding", v.binding, UpTo{Bound::kGround});
  io("distances", v.distances);
  io("seen_ratio", v.seen_ratio);
  io("evidence", v.evidence);
  io("wanted", v.wanted);
  io("scene_revision", v.scene_revision);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Understanding>& v) {
  io("scene", v.scene);
  io("matches", v.matches);
  io("decisions", v.decisions);
  io("problems", v.problems);
}

template <class Io>
void Record(Io& io, RecordOf<Io, DecisionReport>& v) {
  io("mission_id", v.mission_id);
  io("decided_utc_ns", v.decided_utc_ns);
  io("valid_until_utc_ns", v.valid_until_utc_ns);
  io("decision", v.decision);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Origin>& v) {
  io("vehicle_id", v.vehicle_id);
  io("mission_id", v.mission_id);
  io("scene_revision", v.scene_revision);
}

// ---- Missions ----

template <class Io>
void Record(Io& io, RecordOf<Io, RequestId>& v) {
  io("client", v.client);
  io("sequence", v.sequence);
}

template <class Io>
void Record(Io& io, RecordOf<Io, MissionOrder>& v) {
  io("vehicle_id", v.vehicle_id);
  io("mission_id", v.mission_id);
  io("area_center_in_map_m", v.area_center_in_map_m);
  io("area_radius_m", v.area_radius_m);
}

template <class Io>
void Record(Io& io, RecordOf<Io, MissionStatus>& v) {
  io("state", v.state, UpTo{MissionState::kEnded});
  io("step", v.step, UpTo{MissionStep::kDone});
  io("outcome", v.outcome, UpTo{MissionOutcome::kFailed});
  io("message", v.message);
  io("problems", v.problems);
  io("object_id", v.object_id);
}

template <class Io>
void Record(Io& io, RecordOf<Io, CorridorPermit>& v) {
  io("decision_id", v.decision_id);
  io("object_id", v.object_id);
  io("scene_revision", v.scene_revision);
  io("valid_until_utc_ns", v.valid_until_utc_ns);
  io("envelope", v.envelope);
  io("free_width_m", v.free_width_m);
  io("free_height_m", v.free_height_m);
}

template <class Io>
void Record(Io& io, RecordOf<Io, FlightCommand>& v) {
  io("vehicle_id", v.vehicle_id);
  io("mission_id", v.mission_id);
  io("sequence", v.sequence);
  io("issued_utc_ns", v.issued_utc_ns);
  io("valid_until_utc_ns", v.valid_until_utc_ns);
  io("kind", v.kind, UpTo{CommandKind::kAbort});
  io("path_in_map_m", v.path_in_map_m);
  io("yaw_rad", v.yaw_rad);
  io("speed_mps", v.speed_mps);
  io("camera_pitch_rad", v.camera_pitch_rad);
  io("purpose", v.purpose, UpTo{Purpose::kCorridor});
  io("capture_id", v.capture_id);
  io("permit", v.permit);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Errand>& v) {
  io("command", v.command);
  io("is_answered", v.is_answered);
  io("is_ended", v.is_ended);
  io("sent_utc_ns", v.sent_utc_ns);
  io("since_utc_ns", v.since_utc_ns);
  io("start_distance_m", v.start_distance_m);
  io("longest_s", v.longest_s);
}

template <class Io>
void Record(Io& io, RecordOf<Io, PictureResult>& v) {
  io("capture_id", v.capture_id);
  io("problem", v.problem);
}

template <class Io>
void Record(Io& io, RecordOf<Io, Mission>& v) {
  io("order", v.order);
  io("status", v.status);
  io("vehicle", v.vehicle);
  io("errand", v.errand);
  io("is_waiting_for_findings", v.is_waiting_for_findings);
  io("retry_utc_ns", v.retry_utc_ns);
  io("failures", v.failures);
  io("has_overrun", v.has_overrun);
  io("last_sequence", v.last_sequence);
  io("last_capture_id", v.last_capture_id);
  io("pictures", v.pictures);
  io("findings_utc_ns", v.findings_utc_ns);
  io("settled", v.settled);
  io("settled_reasons", v.settled_reasons);
  io("is_any_unsettled", v.is_any_unsettled);
  io("views", v.views);
  io("views_planned", v.views_planned);
  io("viewed", v.viewed);
  io("looked_around_id", v.looked_around_id);
  io("more_views_used", v.more_views_used);
  io("looked_along", v.looked_along);
  io("leave", v.leave);
  io("is_at_entry", v.is_at_entry);
  io("is_in_corridor", v.is_in_corridor);
  io("outcome", v.outcome, UpTo{MissionOutcome::kFailed});
  io("reason", v.reason);
}

template <class Io>
void Record(Io& io, RecordOf<Io, StepTime>& v) {
  io("step", v.step, UpTo{MissionStep::kDone});
  io("began_s", v.began_s);
}

template <class Io>
void Record(Io& io, RecordOf<Io, PictureTimes>& v) {
  io("capture_id", v.capture_id);
  io("file", v.file);
  io("purpose", v.purpose, UpTo{Purpose::kCorridor});
  io("arrived_s", v.arrived_s);
  io("observed_s", v.observed_s);
  io("decided_s", v.decided_s);
  io("problem", v.problem);
}

/// What the mission itself does not tell.
template <class Io>
void Record(Io& io, RecordOf<Io, MissionReport>& v) {
  io("revision", v.revision);
  io("picture_to_decision_s", v.picture_to_decision_s);
  io("picture_to_decision_max_s", v.picture_to_decision_max_s);
}

template <class Io>
void Record(Io& io, RecordOf<Io, MissionLog>& v) {
  io("report", v.report);
  io("steps", v.steps);
  io("pictures", v.pictures);
}

template <class Io>
void Record(Io& io, RecordOf<Io, KeptMission>& v) {
  io("mission", v.mission);
  io("findings_revision", v.findings_revision);
  io("request_id", v.request_id);
  io("reference_name", v.reference_name);
  io("reference_file", v.reference_file);
  io("started_utc_ns", v.started_utc_ns);
  io("log", v.log);
}

/// A snapshot with what its pointer points to.
template <class Snapshot, class Content>
struct WholeScene {
  Snapshot& snapshot;
  Content& understanding;
};

template <class Io, class Snapshot, class Content>
void Record(Io& io, const WholeScene<Snapshot, Content>& v) {
  io("origin", v.snapshot.origin);
  io("stamp_utc_ns", v.snapshot.stamp_utc_ns);
  io("understanding", v.understanding);
  io("decisions", v.snapshot.decisions);
  io("vehicle", v.snapshot.vehicle);
  io("reference_name", v.snapshot.reference_name);
}

MissionRecord WriteMission(const KeptMission& kept) {
  const MissionOrder& order = kept.mission.order;
  const MissionStatus& status = kept.mission.status;
  return {order.mission_id,         order.vehicle_id,       kept.started_utc_ns,
          kept.reference_name,      ToString(status.state), ToString(status.step),
          ToString(status.outcome), status.message,         WriteRecord(kept)};
}

std::string WriteScene(const SceneSnapshot& snapshot) {
  return WriteRecord(WholeScene<const SceneSnapshot, const Understanding>{snapshot, *snapshot.understanding});
}

std::string WriteCapture(const Capture& capture) { return WriteRecord(capture); }

Result<KeptMission> ReadMission(const std::string& text) { return ReadRecord<KeptMission>(text); }

Result<SceneSnapshot> ReadScene(const std::string& text, std::shared_ptr<const octomap::OcTree> octree) {
  SceneSnapshot snapshot;
  auto understanding = std::make_shared<Understanding>();
  const Status status =
      ReadRecordInto(text, WholeScene<SceneSnapshot, Understanding>{snapshot, *understanding});
  if (!status.ok()) return status.error();
  understanding->scene.octree = std::move(octree);
  snapshot.understanding = std::move(understanding);
  return snapshot;
}

Result<Capture> ReadCapture(const std::string& text) { return ReadRecord<Capture>(text); }

Revision DescribeRevision(const SceneSnapshot& snapshot) {
  const Scene& scene = snapshot.understanding->scene;
  return {snapshot.origin.mission_id,
          snapshot.origin.scene_revision,
          snapshot.stamp_utc_ns,
          static_cast<std::uint32_t>(scene.objects.size()),
          static_cast<std::uint32_t>(scene.solids.size()),
          static_cast<std::uint32_t>(snapshot.decisions.size()),
          scene.octree->size(),
          true};
}

}  // namespace soffit
