#include "service/edge/live/scene_answers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "test/support/arch_scene.h"

namespace soffit {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const IsLate kNever = [] { return false; };

std::shared_ptr<SceneSnapshot> ArchSnapshot(std::uint64_t revision) {
  auto understanding = std::make_shared<Understanding>(test::ArchUnderstanding());
  understanding->scene.revision = revision;
  auto snapshot = std::make_shared<SceneSnapshot>();
  snapshot->origin = {1, 77, revision};
  snapshot->stamp_utc_ns = 5;
  snapshot->understanding = understanding;
  DecisionReport report;
  report.decision = understanding->decisions[0];
  snapshot->decisions = {report};
  snapshot->vehicle = {0.35, 0.30, 0.25};
  snapshot->reference_name = "arch.png";
  return snapshot;
}

SceneHistory ArchHistory() { return Extend({}, ArchSnapshot(7)); }

SceneQuery Ask(SceneQueryKind kind) {
  SceneQuery query;
  query.id = {{9}, 3};
  query.kind = kind;
  query.vehicle_id = 1;
  return query;
}

SceneReply Answer(const SceneQuery& query, const SceneHistory& history = ArchHistory()) {
  return AnswerQuery(query, history, {}, kNever);
}

// ---- What every answer keeps to ----

TEST(AnswerQuery, NamesTheQuestionTheMissionAndTheRevision) {
  const SceneReply reply = Answer(Ask(SceneQueryKind::kPoint));
  EXPECT_EQ(reply.status, AnswerStatus::kOk);
  EXPECT_EQ(reply.id, (RequestId{{9}, 3}));
  EXPECT_EQ(reply.origin.mission_id, 77u);
  EXPECT_EQ(reply.origin.scene_revision, 7u);
  EXPECT_EQ(reply.resolution_m, 0.1);
}

TEST(AnswerQuery, SaysWhatIsWrong) {
  EXPECT_EQ(Answer(Ask(SceneQueryKind::kNone)).status, AnswerStatus::kBadRequest);
  EXPECT_EQ(Answer(Ask(SceneQueryKind::kPoint), {}).status, AnswerStatus::kNoScene);
  SceneQuery malformed = Ask(SceneQueryKind::kPoint);
  malformed.problem = "to_in_map_m.x is not a finite number";
  EXPECT_EQ(Answer(malformed).status, AnswerStatus::kBadRequest);
  EXPECT_EQ(Answer(malformed).message, malformed.problem);
  EXPECT_EQ(AnswerQuery(Ask(SceneQueryKind::kPoint), ArchHistory(), {}, [] { return true; }).status,
            AnswerStatus::kTooLate);
}

TEST(AnswerQuery, AnswersForAnEarlierRevisionAsLongAsItIsKept) {
  SceneHistory history = ArchHistory();
  for (std::uint64_t revision = 8; revision < 20; ++revision)
    history = Extend(history, ArchSnapshot(revision));
  SceneQuery query = Ask(SceneQueryKind::kPoint);
  query.scene_revision = 15;
  EXPECT_EQ(Answer(query, history).origin.scene_revision, 15u);
  query.scene_revision = 7;
  EXPECT_EQ(Answer(query, history).status, AnswerStatus::kNoRevision);
  EXPECT_THAT(Answer(query, history).message, HasSubstr("12 to 19"));
  query.kind = SceneQueryKind::kRevisions;
  query.scene_revision = 0;
  const auto revisions = Answer(query, history).revisions;
  ASSERT_THAT(revisions, SizeIs(13));
  EXPECT_FALSE(revisions.front().is_kept);
  EXPECT_TRUE(revisions.back().is_kept);
  EXPECT_EQ(revisions.back().objects, 2u);
}

TEST(Extend, ForgetsAnotherMission) {
  auto other = ArchSnapshot(1);
  other->origin.mission_id = 78;
  const SceneHistory history = Extend(ArchHistory(), other);
  EXPECT_THAT(history.kept, SizeIs(1));
  auto begun = std::make_shared<SceneSnapshot>();
  begun->origin = {1, 79, 0};
  EXPECT_THAT(Extend(history, begun).kept, IsEmpty());
}

// ---- Occupancy ----

TEST(AnswerBox, RefusesWhatIsEmptyAbsurdOrTooLarge) {
  SceneQuery query = Ask(SceneQueryKind::kBox);
  EXPECT_EQ(Answer(query).status, AnswerStatus::kBadRequest);
  query.from_in_map_m = Eigen::Vector3d::Constant(-1e200);
  query.to_in_map_m = Eigen::Vector3d::Constant(1e200);
  EXPECT_EQ(Answer(query).status, AnswerStatus::kBadRequest);
  query.from_in_map_m = Eigen::Vector3d::Constant(-1e5);
  query.to_in_map_m = Eigen::Vector3d::Constant(1e5);
  EXPECT_EQ(Answer(query).status, AnswerStatus::kOk);
  query.resolution_m = 0.1;
  EXPECT_EQ(Answer(query).status, AnswerStatus::kTooLarge);
}

TEST(AnswerBox, GivesTheCellsOfTheResolutionAskedFor) {
  SceneQuery query = Ask(SceneQueryKind::kBox);
  query.from_in_map_m = {1.2, -2.0, 0.0};
  query.to_in_map_m = {2.8, 3.0, 2.0};
  query.resolution_m = 0.4;
  const SceneReply reply = Answer(query);
  EXPECT_EQ(reply.occupancy, Occupancy::kUnknown);
  EXPECT_EQ(reply.grid.size, Eigen::Vector3i(4, 13, 5));
  EXPECT_NEAR(reply.shares.free_ratio, 0.75, 1e-3);
}

TEST(AnswerRay, TellsFreeUnknownAndOutOfRangeApart) {
  SceneQuery query = Ask(SceneQueryKind::kRay);
  EXPECT_EQ(Answer(query).status, AnswerStatus::kBadRequest) << "no direction";
  query.from_in_map_m = {2.0, -1.0, 0.7};
  query.to_in_map_m = {2.0, 2.0, 0.7};
  EXPECT_EQ(Answer(query).ray, RayEnd::kFree);
  EXPECT_EQ(Answer(query).distance_m, 3.0);
  query.range_m = 100.0;
  EXPECT_EQ(Answer(query).ray, RayEnd::kOutOfRange);
  query.to_in_map_m = {-2.0, -1.0, 0.7};
  EXPECT_EQ(Answer(query).ray, RayEnd::kUnknown);
}

TEST(AnswerNearest, KnowsObstacleUnknownAndSurface) {
  SceneQuery query = Ask(SceneQueryKind::kNearest);
  query.from_in_map_m = {2.0, 0.75, 0.7};
  const SceneReply reply = Answer(query);
  EXPECT_TRUE(reply.nearest_occupied.is_found);
  EXPECT_NEAR(reply.nearest_unknown.distance_m, 0.7, 0.11);
  EXPECT_NEAR(reply.surface.distance_m, 0.7, 1e-9);
  EXPECT_EQ(reply.surface.object_id, 1u);
}

// ---- Objects ----

TEST(AnswerObjects, FindsByIdReferenceAndDistance) {
  SceneQuery query = Ask(SceneQueryKind::kObjects);
  query.from_in_map_m = {7.0, 0.0, 0.0};
  EXPECT_THAT(Answer(query).distances_m, ElementsAre(2.0, 3.0)) << "nearest first";
  query.range_m = 2.5;
  EXPECT_THAT(Answer(query).objects, SizeIs(1));
  query.range_m = 0.0;
  query.reference_name = "arch.png";
  ASSERT_THAT(Answer(query).objects, SizeIs(1));
  EXPECT_TRUE(Answer(query).objects[0].object.is_matched);
  query.reference_name = "tower.png";
  EXPECT_EQ(Answer(query).status, AnswerStatus::kNotFound);
  query.reference_name = "";
  query.object_id = 1;
  EXPECT_TRUE(Answer(query).model.has_value());
  query.object_id = 99;
  EXPECT_EQ(Answer(query).status, AnswerStatus::kNotFound);
}

TEST(AnswerColumn, KnowsHeightLayersAndWhoseItIs) {
  SceneQuery query = Ask(SceneQueryKind::kColumn);
  query.from_in_map_m = {2.0, 0.75, 0.0};
  const SceneReply reply = Answer(query);
  EXPECT_NEAR(reply.height_m.value(), 2.3, 1e-9);
  ASSERT_THAT(reply.layers, SizeIs(1));
  EXPECT_EQ(reply.layers[0].occupancy, Occupancy::kFree);
  ASSERT_THAT(reply.objects, SizeIs(1));
  EXPECT_EQ(reply.objects[0].object.footprint.object_id, 1u);
  query.from_in_map_m = {500.0, 0.0, 0.0};
  EXPECT_FALSE(Answer(query).height_m.has_value());
}

// ---- Ways ----

TEST(AnswerClearance, IsTheMissionsForItsVehicleAndAnewForAnother) {
  SceneQuery query = Ask(SceneQueryKind::kClearance);
  query.object_id = 1;
  ASSERT_THAT(Answer(query).decisions, SizeIs(1));
  EXPECT_EQ(Answer(query).decisions[0].decision.reason, "clear by 0.20 m");
  query.vehicle = {2.0, 2.0, 0.5};
  for (const DecisionReport& report : Answer(query).decisions) {
    EXPECT_NE(report.decision.verdict, Verdict::kClear);
    EXPECT_EQ(report.decision.decision_id, 0u) << "no leave to fly";
  }
  query.vehicle = {1e6, 1e6, 0.0};
  for (const DecisionReport& report : Answer(query).decisions)
    EXPECT_NE(report.decision.verdict, Verdict::kClear);
  query.vehicle = {-1.0, 1.0, 0.0};
  EXPECT_EQ(Answer(query).status, AnswerStatus::kBadRequest);
  query.vehicle = {};
  query.object_id = 99;
  EXPECT_EQ(Answer(query).status, AnswerStatus::kNotFound);
}

TEST(AnswerWay, RefusesAVehicleThatIsAbsurdlyLarge) {
  for (const SceneQueryKind kind : {SceneQueryKind::kWay, SceneQueryKind::kPath}) {
    SceneQuery query = Ask(kind);
    query.vehicle = {1e6, 1.0, 0.1};
    query.from_in_map_m = {2.0, -1.0, 0.7};
    query.to_in_map_m = {2.0, 2.0, 0.7};
    EXPECT_EQ(Answer(query).status, AnswerStatus::kBadRequest);
    EXPECT_THAT(Answer(query).message, HasSubstr("10.00 m"));
  }
}

TEST(AnswerWay, IsNotClearWhereNothingIsKnown) {
  SceneQuery query = Ask(SceneQueryKind::kWay);
  query.vehicle = {0.2, 0.2, 0.1};
  query.from_in_map_m = {2.0, -1.0, 0.7};
  query.to_in_map_m = {2.0, 2.0, 0.7};
  EXPECT_EQ(Answer(query).verdict, Verdict::kClear) << Answer(query).message;
  query.to_in_map_m = {2.0, 12.0, 0.7};
  EXPECT_EQ(Answer(query).verdict, Verdict::kInsufficientData);
  EXPECT_THAT(Answer(query).cells, testing::Not(IsEmpty()));
  query.kind = SceneQueryKind::kPath;
  EXPECT_EQ(Answer(query).verdict, Verdict::kInsufficientData);
  query.to_in_map_m = {1e7, 0.0, 0.0};
  EXPECT_EQ(Answer(query).status, AnswerStatus::kTooLarge);
}

// ---- Changes ----

TEST(AnswerChanges, ListsWhatIsAnotherAndNothingElse) {
  auto later = ArchSnapshot(8);
  auto understanding = std::make_shared<Understanding>(*later->understanding);
  understanding->scene.objects.pop_back();
  understanding->scene.objects[0].footprint.height_m += 0.1;
  auto tree = std::make_shared<octomap::OcTree>(*understanding->scene.octree);
  tree->updateNode(octomap::point3d(9.05F, 9.05F, 1.05F), true);
  understanding->scene.octree = tree;
  later->understanding = understanding;
  const SceneHistory history = Extend(ArchHistory(), later);
  SceneQuery query = Ask(SceneQueryKind::kChanges);
  query.since_revision = 7;
  const SceneReply reply = Answer(query, history);
  EXPECT_THAT(reply.changes, ElementsAre(Change{ChangeKind::kChanged, ChangedThing::kObject, 1, -1},
                                         Change{ChangeKind::kRemoved, ChangedThing::kObject, 2, -1}));
  EXPECT_EQ(reply.changed_cells, 1u);
  EXPECT_NEAR(reply.changed_in_map_m.center().x(), 9.05, 1e-5);
  query.since_revision = 8;
  EXPECT_THAT(Answer(query, history).changes, IsEmpty());
  query.since_revision = 0;
  EXPECT_THAT(Answer(query, history).changes, SizeIs(3)) << "everything is new";
  query.since_revision = 3;
  EXPECT_EQ(Answer(query, history).status, AnswerStatus::kNoRevision);
}

}  // namespace
}  // namespace soffit
