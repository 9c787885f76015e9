#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>

namespace soffit {

/// One thread that does what other threads ask for, one thing after another, so that what it works on needs
/// no lock.
class EventLoop {
 public:
  using Task = std::function<void()>;

  /// From any thread.
  void Post(Task task);
  void Stop();

  /// Runs tasks, and `on_tick` once per `period`, until Stop(). Tasks that are left then are dropped.
  void Run(std::chrono::milliseconds period, const Task& on_tick);

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> tasks_;
  bool is_stopped_ = false;
};

}  // namespace soffit
