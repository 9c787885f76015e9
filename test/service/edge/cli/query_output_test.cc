#include "service/edge/cli/query_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace soffit {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

SceneReply SomeClearance() {
  DecisionReport report;
  report.decision.object_id = 3;
  report.decision.side = 1;
  report.decision.decision_id = 9;
  report.decision.verdict = Verdict::kBlocked;
  report.decision.reason = "too low by 0.05 m";
  Corridor& corridor = report.decision.corridor.emplace();
  corridor.entry_in_map_m = {1, 2, 3};
  corridor.bends_in_map_m = {{4, 5, 3}};
  corridor.exit_in_map_m = {6, 5, 3};
  report.decision.margin_up_m = -0.05;
  report.decision.binding = Bound::kRoof;
  report.decision.distances = {0.3, 0.2, 0.1};
  SceneReply reply;
  reply.decisions = {report};
  return reply;
}

TEST(AnswerToJson, TellsBendsMarginsAndDistancesOfADecision) {
  const json decision = AnswerToJson(SceneQueryKind::kClearance, SomeClearance())["clearance"][0];
  EXPECT_EQ(decision["decision"], "BLOCKED");
  EXPECT_EQ(decision["decision_id"], 9);
  EXPECT_EQ(decision["bends"], json::parse("[[4.0, 5.0, 3.0]]"));
  EXPECT_EQ(decision["binding"], "roof");
  EXPECT_EQ(decision["margins_m"]["up"], -0.05);
  EXPECT_EQ(decision["distances_m"]["unknown"], 0.2);
}

TEST(DescribeAnswer, SaysTheSameOfADecisionToPeople) {
  const std::string text = DescribeAnswer(SceneQueryKind::kClearance, SomeClearance());
  EXPECT_THAT(text, HasSubstr("Building 3, side 1: BLOCKED: too low by 0.05 m\n"));
  EXPECT_THAT(text, HasSubstr("from (1.00, 2.00, 3.00) to (6.00, 5.00, 3.00)"));
  EXPECT_THAT(text,
              HasSubstr("least at the roof; to occupied 0.30 m, to unknown 0.20 m, to the model 0.10 m"));
  EXPECT_THAT(text, HasSubstr("1 bend"));
}

}  // namespace
}  // namespace soffit
