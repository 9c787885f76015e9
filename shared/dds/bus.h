#pragma once

// What readers and writers have in common: the Fast DDS entities and the one thread that serves them.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <fastdds/dds/core/condition/GuardCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "shared/dds/discovery.h"
#include "shared/dds/fragment_counter.h"
#include "shared/dds/link_profile.h"
#include "shared/dds/participant.h"
#include "shared/dds/topic.h"

namespace soffit::dds_internal {

/// Serves the status changes of one reader or writer, on the thread of the bus.
class Endpoint {
 public:
  virtual ~Endpoint() = default;
  virtual void Serve() = 0;

  int matched() const { return matched_; }
  bool WaitForMatch(std::chrono::milliseconds timeout);

 protected:
  void SetMatched(int count);

 private:
  std::atomic<int> matched_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
};

class Bus {
 public:
  Bus(eprosima::fastdds::dds::DomainParticipant* participant, std::unique_ptr<Discovery> discovery,
      const LinkProfile& profile, std::shared_ptr<const FragmentCounter> fragments,
      Participant::ProblemHandler on_problem);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Throws std::runtime_error when the library refuses.
  eprosima::fastdds::dds::DataWriter* MakeWriter(const std::string& topic,
                                                 eprosima::fastdds::dds::TypeSupport type, TopicKind kind);
  eprosima::fastdds::dds::DataReader* MakeReader(const std::string& topic,
                                                 eprosima::fastdds::dds::TypeSupport type, TopicKind kind);
  void Remove(eprosima::fastdds::dds::DataWriter* writer);
  void Remove(eprosima::fastdds::dds::DataReader* reader);

  /// From now on `endpoint` is served whenever `condition` triggers. After Withdraw() it is not, and no call
  /// is running.
  void Attach(eprosima::fastdds::dds::StatusCondition& condition, Endpoint& endpoint);
  void Withdraw(eprosima::fastdds::dds::StatusCondition& condition);

  void Report(const std::string& problem) const;
  /// Reports, once each, the peers that do not fit this writer or reader.
  void ReportMisfits(const eprosima::fastdds::dds::DataWriter& writer);
  void ReportMisfits(const eprosima::fastdds::dds::DataReader& reader);

  const Discovery& discovery() const { return *discovery_; }
  const FragmentCounter& fragments() const { return *fragments_; }

 private:
  eprosima::fastdds::dds::Topic* FindOrMakeTopic(const std::string& name,
                                                 eprosima::fastdds::dds::TypeSupport& type);
  void ServeUntilStopped();
  void ReportOnce(const std::string& topic, const std::vector<std::string>& misfits);

  std::unique_ptr<Discovery> discovery_;  ///< Listens to the participant as long as that lives.
  eprosima::fastdds::dds::DomainParticipant* participant_;
  eprosima::fastdds::dds::Publisher* publisher_ = nullptr;
  eprosima::fastdds::dds::Subscriber* subscriber_ = nullptr;
  LinkProfile profile_;
  std::shared_ptr<const FragmentCounter> fragments_;
  Participant::ProblemHandler on_problem_;
  eprosima::fastdds::dds::WaitSet wait_set_;
  eprosima::fastdds::dds::GuardCondition stop_;
  std::mutex making_mutex_;
  std::mutex serving_mutex_;
  std::map<const eprosima::fastdds::dds::Condition*, Endpoint*> endpoints_;
  std::set<std::string> reported_misfits_;  ///< Used by `thread_` alone.
  std::thread thread_;
};

/// A generated type support that takes malformed bytes for what they are, whatever its deserializer throws.
template <class Support>
class GuardedSupport : public Support {
 public:
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override try {
    return Support::deserialize(payload, data);
  } catch (...) {
    return false;
  }
};

}  // namespace soffit::dds_internal
