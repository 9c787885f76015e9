#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "service/edge/store/store.h"

namespace soffit {

/// Writes to a store, in order, on a thread of its own, so that nobody waits for a disk or a database that is
/// slow, full or away.
///
/// What is waiting is written in one transaction. While the store cannot be written it is tried again each
/// second, and what is to be kept waits. A task that fails though the store can be written is left out, which
/// is told until something else was kept.
class Keeper {
 public:
  using Task = std::function<void(Store&)>;                        ///< Throws when it cannot be done.
  using OnTrouble = std::function<void(const std::string& what)>;  ///< On the keeper's thread.

  /// @param on_trouble  Told what is wrong when that changes; empty: nothing any more.
  Keeper(std::string place, OnTrouble on_trouble);
  ~Keeper();  ///< Writes what is waiting, if that can be done at once.
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  /// When too much is waiting, the oldest is left out.
  void Keep(Task task);

  /// True when all that was given so far is kept. False after `longest`; or at once while the store cannot be
  /// written, or has not caught up since that happened last.
  bool Wait(std::chrono::milliseconds longest);

 private:
  void Work();
  void Write(std::deque<Task> batch);
  bool TryToWrite(const std::deque<Task>& batch);
  void PutBack(std::deque<Task> batch);
  void Tell(const std::string& trouble);

  std::string place_;
  OnTrouble on_trouble_;
  std::optional<Store> store_;  ///< Used by the thread alone, as is the next.
  std::string problem_;         ///< Of the last attempt.
  std::string trouble_;         ///< As it was told last.

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Task> waiting_;
  bool is_writing_ = false;
  bool is_late_ = false;  ///< Somebody waited in vain; nobody does until everything is kept.
  bool has_trouble_ = false;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace soffit
