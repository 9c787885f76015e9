#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

namespace soffit {

/// Threads that serve clients in turn, so that one who asks a thousand times delays nobody else by more than
/// one task. Tasks must not throw.
class FairPool {
 public:
  using Client = std::array<std::uint8_t, 16>;
  using Task = std::function<void()>;

  FairPool(int threads, std::size_t max_waiting_of_a_client, std::size_t max_clients);
  ~FairPool();  ///< Drops what is waiting.
  FairPool(const FairPool&) = delete;
  FairPool& operator=(const FairPool&) = delete;

  /// False, and nothing happens, when too many tasks of `client`, or too many clients, are waiting.
  bool TrySubmit(const Client& client, Task task);

 private:
  void Work();

  std::size_t max_waiting_of_a_client_;
  std::size_t max_clients_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<Client, std::deque<Task>> waiting_;  ///< No client is here without a task.
  std::deque<Client> turns_;                    ///< The clients of `waiting_`, next one first.
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace soffit
