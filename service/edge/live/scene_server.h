#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <utility>

#include "service/edge/dds/service_topics.h"
#include "service/edge/live/fair_pool.h"
#include "service/edge/live/scene_answers.h"
#include "service/edge/live/thread_pool.h"
#include "service/edge/ros/ros_topics.h"
#include "shared/dds/reader.h"
#include "shared/dds/writer.h"

namespace soffit {

/// The scenes of all missions on the local domain: Soffit's topics, ROS 2's, and the answers to questions.
/// Nothing here waits for DDS, a question or a conversion: those have threads of their own, and work on
/// snapshots. Thread-safe.
class SceneServer {
 public:
  SceneServer(const Participant& local, const PipelineOptions& options);

  /// From now on this is the newest scene of its vehicle. One that is overtaken before it was sent is not
  /// sent.
  void Publish(std::shared_ptr<const SceneSnapshot> snapshot);

  /// The same of a mission that was found again, with its newest revisions; there is at least one.
  void Restore(SceneHistory history);

  RosTopics& ros() { return ros_; }

 private:
  struct Sent {
    std::set<std::uint32_t> objects;
    std::set<std::uint32_t> models;
    std::set<std::pair<std::uint32_t, int>> decisions;
  };

  void OnQuery(const SceneQuery& query);
  void Schedule(std::uint32_t vehicle_id, std::shared_ptr<const SceneSnapshot> newest,
                std::shared_ptr<const SceneHistory> history);
  SceneReply Answer(const SceneQuery& query, std::chrono::steady_clock::time_point asked) const;
  void SendNewest(std::uint32_t vehicle_id);
  void SendTopics(const SceneSnapshot& snapshot);

  PipelineOptions options_;
  Writer<SceneObjectTopic> objects_;
  Writer<BuildingModelTopic> models_;
  Writer<ClearanceDecisionTopic> decisions_;
  Writer<SceneReplyTopic> replies_;
  RosTopics ros_;
  mutable std::mutex mutex_;
  std::map<std::uint32_t, std::shared_ptr<const SceneSnapshot>> newest_;
  std::map<std::uint32_t, std::shared_ptr<const SceneHistory>> histories_;
  std::set<std::uint32_t> unsent_;      ///< Vehicles whose newest snapshot has still to be sent.
  std::map<std::uint32_t, Sent> sent_;  ///< Used by `sender_` alone.
  ThreadPool sender_;
  FairPool answerers_;
  Reader<SceneQueryTopic> queries_;
};

}  // namespace soffit
