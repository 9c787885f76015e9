#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace soffit {

/// Threads that work off a bounded queue, in the order of submission. Tasks must not throw.
class ThreadPool {
 public:
  using Task = std::function<void()>;

  ThreadPool(int threads, std::size_t max_queued);
  ~ThreadPool();  ///< Finishes what is queued.
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// False, and nothing happens, when `max_queued` tasks are waiting.
  bool TrySubmit(Task task);

 private:
  void Work();

  std::size_t max_queued_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> tasks_;
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace soffit
