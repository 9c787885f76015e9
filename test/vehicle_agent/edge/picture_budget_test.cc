#include "vehicle_agent/edge/picture_budget.h"

#include <gtest/gtest.h>

namespace soffit {
namespace {

LinkProfile Link(int bytes_per_ms) {
  LinkProfile link;
  link.flow_bytes = bytes_per_ms;
  link.picture_time_s = 2.0;
  return link;
}

TEST(PictureBudget, StartsFromWhatTheProfilePromises) {
  EXPECT_EQ(PictureBudget(Link(1000)).Bytes(), 2'000'000u);
}

TEST(PictureBudget, HasOnlyTheLimitOfTheWireWithoutAFlow) {
  PictureBudget budget(Link(0));
  budget.NoteArrival(1000, 1.0);
  EXPECT_EQ(budget.Bytes(), 64u << 20);
}

TEST(PictureBudget, FollowsWhatTheLinkDoes) {
  PictureBudget budget(Link(1000));
  for (int i = 0; i < 10; ++i) budget.NoteArrival(100'000, 1.0);
  EXPECT_NEAR(static_cast<double>(budget.Bytes()), 200'000.0, 4000.0);
  for (int i = 0; i < 10; ++i) budget.NoteArrival(200'000, 0.5);
  EXPECT_NEAR(static_cast<double>(budget.Bytes()), 800'000.0, 4000.0);
}

TEST(PictureBudget, SettlesWhereALateAnswerIsPartOfTheTime) {
  constexpr double kRate_Bps = 100'000.0;
  constexpr double kLatency_s = 0.5;
  PictureBudget budget(Link(1000));
  for (int i = 0; i < 50; ++i) {
    const std::size_t sent = budget.Bytes();
    budget.NoteArrival(sent, static_cast<double>(sent) / kRate_Bps + kLatency_s);
  }
  EXPECT_NEAR(static_cast<double>(budget.Bytes()), kRate_Bps * (2.0 - kLatency_s), 2000.0);
}

TEST(PictureBudget, HalvesWhenAPictureDoesNotArrive) {
  PictureBudget budget(Link(1000));
  budget.NoteLoss();
  EXPECT_EQ(budget.Bytes(), 1'000'000u);
}

}  // namespace
}  // namespace soffit
