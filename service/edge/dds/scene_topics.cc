#include "service/edge/dds/scene_fields.h"
#include "service/edge/dds/service_topics.h"

namespace soffit {
wire::SceneObject SceneObjectTopic::ToWire(const SceneObjectReport& value) {
  return WriteMessage<wire::SceneObject>(value);
}
Result<SceneObjectReport> SceneObjectTopic::FromWire(const wire::SceneObject& message) {
  return ReadMessage<SceneObjectReport>(message);
}

wire::BuildingModel BuildingModelTopic::ToWire(const BuildingModelReport& value) {
  return WriteMessage<wire::BuildingModel>(value);
}
Result<BuildingModelReport> BuildingModelTopic::FromWire(const wire::BuildingModel& message) {
  return ReadMessage<BuildingModelReport>(message);
}

wire::ClearanceDecision ClearanceDecisionTopic::ToWire(const DecisionReport& value) {
  return WriteMessage<wire::ClearanceDecision>(value);
}
Result<DecisionReport> ClearanceDecisionTopic::FromWire(const wire::ClearanceDecision& message) {
  return ReadMessage<DecisionReport>(message);
}

}  // namespace soffit
