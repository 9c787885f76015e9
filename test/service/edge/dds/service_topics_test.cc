#include "service/edge/dds/service_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace soffit {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

DecisionReport SomeDecision() {
  DecisionReport report;
  report.mission_id = 5;
  report.decided_utc_ns = 10;
  report.valid_until_utc_ns = 20;
  ClearanceDecision& decision = report.decision;
  decision.decision_id = 77;
  decision.vehicle_id = 1;
  decision.object_id = 2;
  decision.side = 3;
  decision.verdict = Verdict::kClear;
  decision.reason = "clear by 0.10 m";
  decision.vehicle = {0.35, 0.3, 0.25};
  decision.corridor.emplace();
  decision.corridor->object_id = 2;
  decision.corridor->entry_in_map_m = {1, 2, 3};
  decision.corridor->bends_in_map_m = {{1, 4, 3}, {2, 6, 3}};
  decision.corridor->free_width_m = 1.7;
  decision.corridor->left_m = 0.8;
  decision.margin_up_m = -0.1;
  decision.binding = Bound::kGround;
  decision.distances = {0.31, 0.22, 0.13};
  decision.evidence = {4, 5};
  decision.scene_revision = 9;
  return report;
}

TEST(ClearanceDecisionTopic, KeepsEverythingThroughTheWire) {
  const DecisionReport sent = SomeDecision();
  const auto received = ClearanceDecisionTopic::FromWire(ClearanceDecisionTopic::ToWire(sent));
  ASSERT_TRUE(received.ok()) << received.error().message;
  const ClearanceDecision& got = received.value().decision;
  EXPECT_EQ(received.value().valid_until_utc_ns, 20);
  EXPECT_EQ(got.decision_id, 77u);
  EXPECT_EQ(got.side, 3);
  EXPECT_EQ(got.verdict, Verdict::kClear);
  EXPECT_EQ(got.reason, "clear by 0.10 m");
  ASSERT_TRUE(got.corridor.has_value());
  EXPECT_EQ(got.corridor->entry_in_map_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(got.corridor->object_id, 2u);
  EXPECT_EQ(got.corridor->bends_in_map_m, sent.decision.corridor->bends_in_map_m);
  EXPECT_EQ(got.corridor->left_m, 0.8);
  EXPECT_EQ(got.margin_up_m, -0.1);
  EXPECT_EQ(got.binding, Bound::kGround);
  EXPECT_EQ(got.distances.to_occupied_m, 0.31);
  EXPECT_EQ(got.distances.to_unknown_m, 0.22);
  EXPECT_EQ(got.distances.to_surface_m, 0.13);
  EXPECT_EQ(got.evidence, sent.decision.evidence);
  EXPECT_FALSE(got.wanted.has_value());
}

TEST(ClearanceDecisionTopic, IsBelowOneKilobyteAsARule) {
  DecisionReport sent = SomeDecision();
  sent.decision.reason =
      "too close to call: 0.05 m to spare in width, 0.31 m in height, least margin -0.02 m (left)";
  sent.decision.evidence.resize(30);
  sent.decision.wanted.emplace();
  sent.decision.wanted->reason = "along the corridor, to see whether it is free";
  const wire::ClearanceDecision message = ClearanceDecisionTopic::ToWire(sent);
  EXPECT_LT(wire::ClearanceDecision::getCdrSerializedSize(message), 1024U);
}

TEST(ClearanceDecisionTopic, AnEmptyMessageIsInsufficientData) {
  const auto received = ClearanceDecisionTopic::FromWire(wire::ClearanceDecision());
  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received.value().decision.verdict, Verdict::kInsufficientData);
}

TEST(ClearanceDecisionTopic, RefusesClearWithoutACorridor) {
  wire::ClearanceDecision message = ClearanceDecisionTopic::ToWire(SomeDecision());
  message.has_corridor(false);
  const auto received = ClearanceDecisionTopic::FromWire(message);
  ASSERT_FALSE(received.ok());
  EXPECT_THAT(received.error().message, HasSubstr("without a corridor"));
}

TEST(BuildingModelTopic, KeepsTheMeshAndRefusesTrianglesWithoutCorners) {
  BuildingModelReport sent;
  sent.origin = {1, 2, 3};
  sent.object_id = 4;
  sent.mesh.vertices_in_map_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sent.mesh.triangles = {{0, 1, 2}};
  sent.openings = {{1, {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}}, true, 0.0, 0.01}};
  wire::BuildingModel message = BuildingModelTopic::ToWire(sent);
  const auto received = BuildingModelTopic::FromWire(message);
  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received.value().mesh.triangles, sent.mesh.triangles);
  EXPECT_TRUE(received.value().openings.at(0).is_through);
  message.triangles()[0].c(3);
  EXPECT_FALSE(BuildingModelTopic::FromWire(message).ok());
}

TEST(SceneObjectTopic, KeepsFootprintHolesAndNeighbours) {
  SceneObjectReport sent;
  sent.origin = {1, 2, 3};
  sent.object.footprint.object_id = 4;
  sent.object.footprint.polygon_in_map_m = {{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{{1, 1}, {1, 2}, {2, 2}}}};
  sent.object.neighbours = {7, 8};
  wire::SceneObject message = SceneObjectTopic::ToWire(sent);
  const auto received = SceneObjectTopic::FromWire(message);
  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received.value().object.footprint.polygon_in_map_m.holes,
            sent.object.footprint.polygon_in_map_m.holes);
  EXPECT_EQ(received.value().object.neighbours, sent.object.neighbours);
  message.footprint().holes()[0].corners_m()[1].x(kNan);
  EXPECT_FALSE(SceneObjectTopic::FromWire(message).ok());
}

TEST(MissionStatusTopic, KeepsTheNewestProblems) {
  MissionReport sent;
  sent.status.state = MissionState::kEnded;
  sent.status.outcome = MissionOutcome::kBlocked;
  sent.status.message = "too low by 0.20 m";
  for (int i = 0; i < 40; ++i) sent.status.problems.push_back("problem " + std::to_string(i));
  const auto received = MissionStatusTopic::FromWire(MissionStatusTopic::ToWire(sent));
  ASSERT_TRUE(received.ok()) << received.error().message;
  EXPECT_EQ(received.value().status.outcome, MissionOutcome::kBlocked);
  EXPECT_EQ(received.value().status.problems.size(), 32u);
  EXPECT_EQ(received.value().status.problems.back(), "problem 39");
}

TEST(MissionRequestTopic, RefusesAnAreaThatIsNowhere) {
  MissionRequest request;
  request.kind = MissionRequestKind::kStart;
  request.id = {{1, 2, 3}, 4};
  const auto received = MissionRequestTopic::FromWire(MissionRequestTopic::ToWire(request));
  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received.value().id, request.id);
  request.area_center_in_map_m.x() = kNan;
  EXPECT_FALSE(MissionRequestTopic::FromWire(MissionRequestTopic::ToWire(request)).ok());
}

TEST(SceneQueryTopic, GivesAMalformedQuestionItsIdSoThatItCanBeAnswered) {
  SceneQuery query;
  query.id = {{1, 2, 3}, 4};
  query.kind = SceneQueryKind::kRay;
  query.to_in_map_m.y() = kNan;
  const auto received = SceneQueryTopic::FromWire(SceneQueryTopic::ToWire(query));
  ASSERT_TRUE(received.ok());
  EXPECT_EQ(received.value().id, query.id);
  EXPECT_EQ(received.value().problem, "to_in_map_m.y is not a finite number");
  query.to_in_map_m.y() = 1.0;
  EXPECT_EQ(SceneQueryTopic::FromWire(SceneQueryTopic::ToWire(query)).value().problem, "");
  query.timeout_s = 1e9;
  EXPECT_THAT(SceneQueryTopic::FromWire(SceneQueryTopic::ToWire(query)).value().problem,
              HasSubstr("timeout_s"));
}

TEST(SceneReplyTopic, KeepsEveryPartThroughTheWire) {
  SceneReply sent;
  sent.status = AnswerStatus::kOk;
  sent.origin = {1, 2, 3};
  sent.grid.size = {2, 1, 1};
  sent.grid.occupancy = {1, 2};
  sent.cells = {{{1, 2, 3}, 0.1, Occupancy::kOccupied}};
  sent.ray = RayEnd::kOutOfRange;
  sent.surface = {true, -0.5, {4, 5, 6}, 7};
  sent.layers = {{0.0, 1.0, Occupancy::kFree}};
  sent.height_m = 2.5;
  sent.changes = {{ChangeKind::kRemoved, ChangedThing::kDecision, 4, 2}};
  sent.changed_cells = 9;
  sent.changed_in_map_m = {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 2, 3)};
  sent.revisions = {{1, 2, 3, 4, 5, 6, 7, true}};
  const auto received = SceneReplyTopic::FromWire(SceneReplyTopic::ToWire(sent));
  ASSERT_TRUE(received.ok()) << received.error().message;
  const SceneReply& got = received.value();
  EXPECT_EQ(got.grid.size, sent.grid.size);
  EXPECT_EQ(got.grid.occupancy, sent.grid.occupancy);
  EXPECT_EQ(got.cells.at(0).occupancy, Occupancy::kOccupied);
  EXPECT_EQ(got.ray, RayEnd::kOutOfRange);
  EXPECT_EQ(got.surface.distance_m, -0.5);
  EXPECT_EQ(got.layers.at(0).occupancy, Occupancy::kFree);
  EXPECT_EQ(got.height_m, 2.5);
  EXPECT_EQ(got.changes, sent.changes);
  EXPECT_TRUE(got.changed_in_map_m.isApprox(sent.changed_in_map_m));
  EXPECT_EQ(got.revisions.at(0).octree_nodes, 7u);
}

TEST(SceneReplyTopic, OfNothingIsReadable) {
  EXPECT_TRUE(SceneReplyTopic::FromWire(SceneReplyTopic::ToWire(SceneReply())).ok());
}

TEST(SceneReplyTopic, RefusesAGridWithoutItsCells) {
  SceneReply sent;
  sent.grid.size = {100, 100, 100};
  EXPECT_FALSE(SceneReplyTopic::FromWire(SceneReplyTopic::ToWire(sent)).ok());
}

}  // namespace
}  // namespace soffit
