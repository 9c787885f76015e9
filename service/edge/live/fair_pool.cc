#include "service/edge/live/fair_pool.h"

#include <utility>

namespace soffit {

FairPool::FairPool(int threads, std::size_t max_waiting_of_a_client, std::size_t max_clients)
    : max_waiting_of_a_client_(max_waiting_of_a_client), max_clients_(max_clients) {
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Work(); });
}

FairPool::~FairPool() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool FairPool::TrySubmit(const Client& client, Task task) {
  {
    const std::lock_guard lock(mutex_);
    const auto known = waiting_.find(client);
    if (known == waiting_.end()) {
      if (waiting_.size() >= max_clients_) return false;
      turns_.push_back(client);
      waiting_[client].push_back(std::move(task));
    } else {
      if (known->second.size() >= max_waiting_of_a_client_) return false;
      known->second.push_back(std::move(task));
    }
  }
  changed_.notify_one();
  return true;
}

void FairPool::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_stopping_ || !turns_.empty(); });
    if (is_stopping_) return;
    const Client client = turns_.front();
    turns_.pop_front();
    const auto its = waiting_.find(client);
    const Task task = std::move(its->second.front());
    its->second.pop_front();
    if (its->second.empty()) {
      waiting_.erase(its);
    } else {
      turns_.push_back(client);
    }
    lock.unlock();
    task();
    lock.lock();
  }
}

}  // namespace soffit
