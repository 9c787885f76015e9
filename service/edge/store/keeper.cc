#include "service/edge/store/keeper.h"

#include <stdexcept>
#include <utility>

namespace soffit {
namespace {

using namespace std::chrono_literals;

constexpr auto kRetry = 1s;
constexpr std::size_t kMaxWaiting = 4096;

}  // namespace

Keeper::Keeper(std::string place, OnTrouble on_trouble)
    : place_(std::move(place)), on_trouble_(std::move(on_trouble)), thread_([this] { Work(); }) {}

Keeper::~Keeper() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Keeper::Keep(Task task) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= kMaxWaiting) waiting_.pop_front();
    waiting_.push_back(std::move(task));
  }
  changed_.notify_all();
}

bool Keeper::Wait(std::chrono::milliseconds longest) {
  std::unique_lock lock(mutex_);
  const auto is_kept = [this] { return waiting_.empty() && !is_writing_; };
  is_late_ =
      !changed_.wait_for(lock, longest, [&] { return is_kept() || has_trouble_ || is_late_; }) || is_late_;
  return is_kept();
}

void Keeper::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_stopping_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    is_writing_ = true;
    std::deque<Task> batch = std::exchange(waiting_, {});
    lock.unlock();
    Write(std::move(batch));
    lock.lock();
    is_writing_ = false;
    is_late_ = is_late_ && !waiting_.empty();
    changed_.notify_all();
    if (!has_trouble_) continue;
    if (is_stopping_) return;
    changed_.wait_for(lock, kRetry, [this] { return is_stopping_; });
  }
}

void Keeper::Write(std::deque<Task> batch) {
  if (TryToWrite(batch)) return Tell("");
  std::string trouble;
  for (; !batch.empty(); batch.pop_front()) {
    if (TryToWrite({batch.front()})) continue;
    trouble = "something could not be kept: " + problem_;
    const bool is_tasks_fault = TryToWrite({[](Store& store) { store.Touch(); }});
    if (is_tasks_fault) continue;
    PutBack(std::move(batch));
    return Tell(problem_);
  }
  Tell(trouble);
}

bool Keeper::TryToWrite(const std::deque<Task>& batch) {
  if (!store_) {
    Result<Store> opened = Store::Open(place_, false);
    if (!opened.ok()) {
      problem_ = opened.error().message;
      return false;
    }
    store_ = std::move(opened).value();
  }
  try {
    store_->Begin();
    for (const Task& task : batch) task(*store_);
    store_->Commit();
    return true;
  } catch (const std::exception& failure) {
    problem_ = failure.what();
    store_->Rollback();
    store_.reset();  // After an error of the disk or the connection nothing that it holds is to be trusted.
    return false;
  }
}

void Keeper::PutBack(std::deque<Task> batch) {
  const std::lock_guard lock(mutex_);
  for (Task& task : waiting_) batch.push_back(std::move(task));
  waiting_ = std::move(batch);
}

void Keeper::Tell(const std::string& trouble) {
  if (trouble == trouble_) return;
  trouble_ = trouble;
  on_trouble_(trouble);
  {
    const std::lock_guard lock(mutex_);
    has_trouble_ = !trouble.empty();
  }
  changed_.notify_all();
}

}  // namespace soffit
