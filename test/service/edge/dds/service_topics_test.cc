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
  decision.corridor->free_width_m = 1.7;
  decision.margin_up_m = -0.1;
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
  EXPECT_EQ(got.margin_up_m, -0.1);
  EXPECT_EQ(got.evidence, sent.decision.evidence);
  EXPECT_FALSE(got.wanted.has_value());
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

}  // namespace
}  // namespace soffit
