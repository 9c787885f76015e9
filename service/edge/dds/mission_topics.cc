#include "service/edge/dds/request_id.h"
#include "service/edge/dds/service_topics.h"

namespace soffit {
namespace {

constexpr std::size_t kMaxReferenceBytes = std::size_t{16} << 20;
constexpr NewestItems kNewestProblems{{32}};

}  // namespace

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::MissionRequest>& m, ValueOf<Io, MissionRequest>& v) {
  io("id", m.id(), v.id);
  io("kind", m.kind(), v.kind, Last{wire::REQUEST_ABORT});
  io("vehicle_id", m.vehicle_id(), v.vehicle_id);
  io("mission_id", m.mission_id(), v.mission_id);
  io("reference_name", m.reference_name(), v.reference_name);
  io.Require(m.reference().size() <= kMaxReferenceBytes, "the reference has more than 16 MiB");
  io("reference", m.reference(), v.reference);
  io("area_center_in_map_m", m.area_center_in_map_m(), v.area_center_in_map_m);
  io("area_radius_m", m.area_radius_m(), v.area_radius_m, AtLeast{0.0});
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::MissionReply>& m, ValueOf<Io, MissionReply>& v) {
  io("id", m.id(), v.id);
  io("is_accepted", m.is_accepted(), v.is_accepted);
  io("mission_id", m.mission_id(), v.mission_id);
  io("message", m.message(), v.message);
}

template <class Io>
void Fields(Io& io, MessageOf<Io, wire::MissionStatus>& m, ValueOf<Io, MissionReport>& v) {
  io("vehicle_id", m.vehicle_id(), v.vehicle_id);
  io("mission_id", m.mission_id(), v.mission_id);
  io("revision", m.revision(), v.revision);
  io("started_utc_ns", m.started_utc_ns(), v.started_utc_ns);
  io("stamp_utc_ns", m.stamp_utc_ns(), v.stamp_utc_ns);
  io("state", m.state(), v.status.state, Last{wire::MISSION_ENDED});
  io("step", m.step(), v.status.step, Last{wire::STEP_DONE});
  io("outcome", m.outcome(), v.status.outcome, Last{wire::OUTCOME_FAILED});
  io("step_progress_ratio", m.step_progress_ratio(), v.status.step_progress_ratio, AtLeast{0.0});
  io("progress_ratio", m.progress_ratio(), v.status.progress_ratio, AtLeast{0.0});
  io("message", m.message(), v.status.message);
  io("problems", m.problems(), v.status.problems, kNewestProblems);
  io("object_id", m.object_id(), v.status.object_id);
  io("pictures_received", m.pictures_received(), v.pictures_received);
  io("pictures_used", m.pictures_used(), v.pictures_used);
  io("picture_to_decision_s", m.picture_to_decision_s(), v.picture_to_decision_s, AtLeast{0.0});
  io("picture_to_decision_max_s", m.picture_to_decision_max_s(), v.picture_to_decision_max_s, AtLeast{0.0});
}

wire::MissionRequest MissionRequestTopic::ToWire(const MissionRequest& value) {
  return WriteMessage<wire::MissionRequest>(value);
}
Result<MissionRequest> MissionRequestTopic::FromWire(const wire::MissionRequest& message) {
  return ReadMessage<MissionRequest>(message);
}

wire::MissionReply MissionReplyTopic::ToWire(const MissionReply& value) {
  return WriteMessage<wire::MissionReply>(value);
}
Result<MissionReply> MissionReplyTopic::FromWire(const wire::MissionReply& message) {
  return ReadMessage<MissionReply>(message);
}

wire::MissionStatus MissionStatusTopic::ToWire(const MissionReport& value) {
  return WriteMessage<wire::MissionStatus>(value);
}
Result<MissionReport> MissionStatusTopic::FromWire(const wire::MissionStatus& message) {
  return ReadMessage<MissionReport>(message);
}

}  // namespace soffit
