#include "shared/dds/bus.h"

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <stdexcept>

#include "shared/dds/qos.h"

namespace soffit::dds_internal {

namespace dds = eprosima::fastdds::dds;
using ReturnCode = eprosima::fastrtps::types::ReturnCode_t;

bool Endpoint::WaitForMatch(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [this] { return matched_ > 0; });
}

void Endpoint::SetMatched(int count) {
  {
    const std::lock_guard lock(mutex_);
    matched_ = count;
  }
  changed_.notify_all();
}

Bus::Bus(dds::DomainParticipant* participant, std::unique_ptr<Discovery> discovery,
         const LinkProfile& profile, std::shared_ptr<const FragmentCounter> fragments,
         Participant::ProblemHandler on_problem)
    : discovery_(std::move(discovery)),
      participant_(participant),
      profile_(profile),
      fragments_(std::move(fragments)),
      on_problem_(std::move(on_problem)) {
  publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  wait_set_.attach_condition(stop_);
  thread_ = std::thread([this] { ServeUntilStopped(); });
}

Bus::~Bus() {
  stop_.set_trigger_value(true);
  thread_.join();
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

dds::Topic* Bus::FindOrMakeTopic(const std::string& name, dds::TypeSupport& type) {
  if (auto* known = participant_->lookup_topicdescription(name)) return dynamic_cast<dds::Topic*>(known);
  type.register_type(participant_);
  auto* topic = participant_->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw std::runtime_error("DDS refuses to make the topic " + name);
  return topic;
}

dds::DataWriter* Bus::MakeWriter(const std::string& topic, dds::TypeSupport type, TopicKind kind) {
  const std::lock_guard lock(making_mutex_);
  auto* writer = publisher_->create_datawriter(FindOrMakeTopic(topic, type), MakeWriterQos(kind, profile_));
  if (writer == nullptr) throw std::runtime_error("DDS refuses to make a writer of " + topic);
  return writer;
}

dds::DataReader* Bus::MakeReader(const std::string& topic, dds::TypeSupport type, TopicKind kind) {
  const std::lock_guard lock(making_mutex_);
  auto* reader = subscriber_->create_datareader(FindOrMakeTopic(topic, type), MakeReaderQos(kind));
  if (reader == nullptr) throw std::runtime_error("DDS refuses to make a reader of " + topic);
  return reader;
}

void Bus::Remove(dds::DataWriter* writer) { publisher_->delete_datawriter(writer); }
void Bus::Remove(dds::DataReader* reader) { subscriber_->delete_datareader(reader); }

void Bus::Attach(dds::StatusCondition& condition, Endpoint& endpoint) {
  const std::lock_guard lock(serving_mutex_);
  endpoints_[&condition] = &endpoint;
  wait_set_.attach_condition(condition);
}

void Bus::Withdraw(dds::StatusCondition& condition) {
  const std::lock_guard lock(serving_mutex_);
  wait_set_.detach_condition(condition);
  endpoints_.erase(&condition);
}

void Bus::Report(const std::string& problem) const {
  if (on_problem_) on_problem_(problem);
}

void Bus::ReportMisfits(const dds::DataWriter& writer) {
  const std::string& topic = writer.get_topic()->get_name();
  ReportOnce(topic, discovery_->FindMisfitReaders(topic, MatchingQosOf(writer.get_qos())));
}

void Bus::ReportMisfits(const dds::DataReader& reader) {
  const std::string& topic = reader.get_topicdescription()->get_name();
  ReportOnce(topic, discovery_->FindMisfitWriters(topic, MatchingQosOf(reader.get_qos())));
}

void Bus::ReportOnce(const std::string& topic, const std::vector<std::string>& misfits) {
  for (const std::string& misfit : misfits) {
    const std::string problem = topic + ": " + misfit;
    if (reported_misfits_.insert(problem).second) Report(problem);
  }
}

void Bus::ServeUntilStopped() {
  dds::ConditionSeq triggered;
  while (!stop_.get_trigger_value()) {
    if (wait_set_.wait(triggered, eprosima::fastrtps::c_TimeInfinite) != ReturnCode::RETCODE_OK) continue;
    for (const dds::Condition* condition : triggered) {
      const std::lock_guard lock(serving_mutex_);
      const auto endpoint = endpoints_.find(condition);
      if (endpoint == endpoints_.end()) continue;
      try {
        endpoint->second->Serve();
      } catch (const std::exception& error) {
        Report(std::string("a message could not be handled: ") + error.what());
      }
    }
  }
}

}  // namespace soffit::dds_internal
