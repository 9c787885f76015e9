#include "service/edge/live/fair_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>

namespace soffit {
namespace {

constexpr FairPool::Client kEager{1};
constexpr FairPool::Client kModest{2};

/// A pool of one thread that is held up until told to go on.
class HeldPool {
 public:
  HeldPool(std::size_t max_waiting, std::size_t max_clients) : pool(1, max_waiting, max_clients) {
    std::promise<void> began;
    pool.TrySubmit({}, [&began, go = go_.get_future().share()] {
      began.set_value();
      go.wait();
    });
    began.get_future().wait();
  }
  void GoOn() { go_.set_value(); }

 private:
  std::promise<void> go_;

 public:
  FairPool pool;
};

TEST(FairPool, ServesAModestClientBeforeTheRestOfAnEagerOne) {
  int served = 0;
  std::promise<int> served_before;
  HeldPool held(100, 10);
  for (int i = 0; i < 50; ++i) held.pool.TrySubmit(kEager, [&] { ++served; });
  held.pool.TrySubmit(kModest, [&] { served_before.set_value(served); });
  held.GoOn();
  EXPECT_EQ(served_before.get_future().get(), 1);
}

TEST(FairPool, TakesNoMoreThanItsLimits) {
  HeldPool held(2, 2);
  EXPECT_TRUE(held.pool.TrySubmit(kEager, [] {}));
  EXPECT_TRUE(held.pool.TrySubmit(kEager, [] {}));
  EXPECT_FALSE(held.pool.TrySubmit(kEager, [] {}));
  EXPECT_TRUE(held.pool.TrySubmit(kModest, [] {}));
  EXPECT_FALSE(held.pool.TrySubmit({3}, [] {}));
  held.GoOn();
}

}  // namespace
}  // namespace soffit
