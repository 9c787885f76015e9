#pragma once

#include "service/edge/dds/messages.h"
#include "shared/dds/topic.h"
#include "shared/result/result.h"
#include "soffitPubSubTypes.h"

namespace soffit {

// The topics of the local domain, as Reader and Writer take them; the same rules as in shared/wire/topics.h.

struct MissionRequestTopic {
  using Value = MissionRequest;
  using Support = wire::MissionRequestPubSubType;
  static constexpr const char* kName = "soffit/mission_request/v1";
  static constexpr TopicKind kKind = TopicKind::kQuery;
  static wire::MissionRequest ToWire(const MissionRequest& value);
  static Result<MissionRequest> FromWire(const wire::MissionRequest& message);
};

struct MissionReplyTopic {
  using Value = MissionReply;
  using Support = wire::MissionReplyPubSubType;
  static constexpr const char* kName = "soffit/mission_reply/v1";
  static constexpr TopicKind kKind = TopicKind::kQuery;
  static wire::MissionReply ToWire(const MissionReply& value);
  static Result<MissionReply> FromWire(const wire::MissionReply& message);
};

struct MissionStatusTopic {
  using Value = MissionReport;
  using Support = wire::MissionStatusPubSubType;
  static constexpr const char* kName = "soffit/mission_status/v1";
  static constexpr TopicKind kKind = TopicKind::kLatched;
  static wire::MissionStatus ToWire(const MissionReport& value);
  static Result<MissionReport> FromWire(const wire::MissionStatus& message);
};

struct SceneObjectTopic {
  using Value = SceneObjectReport;
  using Support = wire::SceneObjectPubSubType;
  static constexpr const char* kName = "soffit/scene_object/v1";
  static constexpr TopicKind kKind = TopicKind::kLatched;
  static wire::SceneObject ToWire(const SceneObjectReport& value);
  static Result<SceneObjectReport> FromWire(const wire::SceneObject& message);
};

struct BuildingModelTopic {
  using Value = BuildingModelReport;
  using Support = wire::BuildingModelPubSubType;
  static constexpr const char* kName = "soffit/building_model/v1";
  static constexpr TopicKind kKind = TopicKind::kLatched;
  static wire::BuildingModel ToWire(const BuildingModelReport& value);
  static Result<BuildingModelReport> FromWire(const wire::BuildingModel& message);
};

struct ClearanceDecisionTopic {
  using Value = DecisionReport;
  using Support = wire::ClearanceDecisionPubSubType;
  static constexpr const char* kName = "soffit/clearance_decision/v2";
  static constexpr TopicKind kKind = TopicKind::kLatched;
  static wire::ClearanceDecision ToWire(const DecisionReport& value);
  static Result<DecisionReport> FromWire(const wire::ClearanceDecision& message);
};

struct SceneQueryTopic {
  using Value = SceneQuery;
  using Support = wire::SceneQueryPubSubType;
  static constexpr const char* kName = "soffit/scene_query/v3";
  static constexpr TopicKind kKind = TopicKind::kQuery;
  static wire::SceneQuery ToWire(const SceneQuery& value);
  /// Never an error: see SceneQuery::problem.
  static Result<SceneQuery> FromWire(const wire::SceneQuery& message);
};

struct SceneReplyTopic {
  using Value = SceneReply;
  using Support = wire::SceneReplyPubSubType;
  static constexpr const char* kName = "soffit/scene_reply/v3";
  static constexpr TopicKind kKind = TopicKind::kQuery;
  static wire::SceneReply ToWire(const SceneReply& value);
  static Result<SceneReply> FromWire(const wire::SceneReply& message);
};

}  // namespace soffit
