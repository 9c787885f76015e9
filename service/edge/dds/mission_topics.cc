#include <algorithm>

#include "service/edge/dds/request_id.h"
#include "service/edge/dds/service_topics.h"
#include "shared/wire/basic.h"

namespace soffit {
namespace {

constexpr std::size_t kMaxReferenceBytes = std::size_t{16} << 20;
constexpr std::size_t kMaxProblems = 32;

}  // namespace

wire::MissionRequest MissionRequestTopic::ToWire(const MissionRequest& value) {
  wire::MissionRequest out;
  out.id(RequestIdToWire(value.id));
  out.kind(static_cast<wire::MissionRequestKind>(value.kind));
  out.vehicle_id(value.vehicle_id);
  out.mission_id(value.mission_id);
  out.reference_name(value.reference_name);
  out.reference(value.reference);
  out.area_center_in_map_m(soffit::ToWire(value.area_center_in_map_m));
  out.area_radius_m(value.area_radius_m);
  return out;
}

Result<MissionRequest> MissionRequestTopic::FromWire(const wire::MissionRequest& message) {
  Check check;
  check.Known(message.kind(), wire::REQUEST_ABORT, "kind");
  check.Require(message.reference().size() <= kMaxReferenceBytes, "the reference has more than 16 MiB");
  check.Finite(message.area_center_in_map_m().x(), "area_center_in_map_m.x");
  check.Finite(message.area_center_in_map_m().y(), "area_center_in_map_m.y");
  check.AtLeast(0.0, message.area_radius_m(), "area_radius_m");
  if (!check.problem().empty()) return InvalidInput(check.problem());
  return MissionRequest{RequestIdFromWire(message.id()),
                        static_cast<MissionRequestKind>(message.kind()),
                        message.vehicle_id(),
                        message.mission_id(),
                        message.reference_name().to_string(),
                        message.reference(),
                        soffit::FromWire(message.area_center_in_map_m()),
                        message.area_radius_m()};
}

wire::MissionReply MissionReplyTopic::ToWire(const MissionReply& value) {
  wire::MissionReply out;
  out.id(RequestIdToWire(value.id));
  out.is_accepted(value.is_accepted);
  out.mission_id(value.mission_id);
  out.message(value.message);
  return out;
}

Result<MissionReply> MissionReplyTopic::FromWire(const wire::MissionReply& message) {
  return MissionReply{RequestIdFromWire(message.id()), message.is_accepted(), message.mission_id(),
                      message.message().to_string()};
}

wire::MissionStatus MissionStatusTopic::ToWire(const MissionReport& value) {
  wire::MissionStatus out;
  out.vehicle_id(value.vehicle_id);
  out.mission_id(value.mission_id);
  out.revision(value.revision);
  out.started_utc_ns(value.started_utc_ns);
  out.stamp_utc_ns(value.stamp_utc_ns);
  out.state(static_cast<wire::MissionState>(value.status.state));
  out.step(static_cast<wire::MissionStep>(value.status.step));
  out.outcome(static_cast<wire::MissionOutcome>(value.status.outcome));
  out.step_progress_ratio(value.status.step_progress_ratio);
  out.progress_ratio(value.status.progress_ratio);
  out.message(value.status.message);
  const auto& problems = value.status.problems;
  const auto skipped = static_cast<std::ptrdiff_t>(problems.size() - std::min(problems.size(), kMaxProblems));
  out.problems().assign(problems.begin() + skipped, problems.end());
  out.object_id(value.status.object_id);
  out.pictures_received(value.pictures_received);
  out.pictures_used(value.pictures_used);
  out.picture_to_decision_s(value.picture_to_decision_s);
  out.picture_to_decision_max_s(value.picture_to_decision_max_s);
  return out;
}

Result<MissionReport> MissionStatusTopic::FromWire(const wire::MissionStatus& message) {
  Check check;
  check.Known(message.state(), wire::MISSION_ENDED, "state");
  check.Known(message.step(), wire::STEP_DONE, "step");
  check.Known(message.outcome(), wire::OUTCOME_FAILED, "outcome");
  check.AtLeast(0.0, message.step_progress_ratio(), "step_progress_ratio");
  check.AtLeast(0.0, message.progress_ratio(), "progress_ratio");
  check.Require(message.problems().size() <= kMaxProblems, "more than 32 problems");
  check.AtLeast(0.0, message.picture_to_decision_s(), "picture_to_decision_s");
  check.AtLeast(0.0, message.picture_to_decision_max_s(), "picture_to_decision_max_s");
  if (!check.problem().empty()) return InvalidInput(check.problem());

  MissionReport value;
  value.vehicle_id = message.vehicle_id();
  value.mission_id = message.mission_id();
  value.revision = message.revision();
  value.started_utc_ns = message.started_utc_ns();
  value.stamp_utc_ns = message.stamp_utc_ns();
  value.status.state = static_cast<MissionState>(message.state());
  value.status.step = static_cast<MissionStep>(message.step());
  value.status.outcome = static_cast<MissionOutcome>(message.outcome());
  value.status.step_progress_ratio = message.step_progress_ratio();
  value.status.progress_ratio = message.progress_ratio();
  value.status.message = message.message().to_string();
  for (const auto& problem : message.problems()) value.status.problems.push_back(problem.to_string());
  value.status.object_id = message.object_id();
  value.pictures_received = message.pictures_received();
  value.pictures_used = message.pictures_used();
  value.picture_to_decision_s = message.picture_to_decision_s();
  value.picture_to_decision_max_s = message.picture_to_decision_max_s();
  return value;
}

}  // namespace soffit
