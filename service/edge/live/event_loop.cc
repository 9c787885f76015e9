#include "service/edge/live/event_loop.h"

#include <utility>

namespace soffit {

void EventLoop::Post(Task task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  changed_.notify_one();
}

void EventLoop::Stop() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  changed_.notify_one();
}

void EventLoop::Run(std::chrono::milliseconds period, const Task& on_tick) {
  using Clock = std::chrono::steady_clock;
  auto next_tick = Clock::now();
  std::unique_lock lock(mutex_);
  while (!is_stopped_) {
    changed_.wait_until(lock, next_tick, [this] { return is_stopped_ || !tasks_.empty(); });
    std::deque<Task> todo = std::exchange(tasks_, {});
    lock.unlock();
    for (const Task& task : todo) task();
    if (Clock::now() >= next_tick) {
      on_tick();
      next_tick = Clock::now() + period;
    }
    lock.lock();
  }
}

}  // namespace soffit
