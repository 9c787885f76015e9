#pragma once

#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "shared/dds/participant.h"

namespace soffit::dds_internal {

/// What one side offers or the other asks for, of that which keeps them from matching.
struct MatchingQos {
  eprosima::fastdds::dds::ReliabilityQosPolicyKind reliability;
  eprosima::fastdds::dds::DurabilityQosPolicyKind_t durability;
  eprosima::fastdds::dds::LivelinessQosPolicyKind liveliness;
  eprosima::fastdds::dds::OwnershipQosPolicyKind ownership;
  eprosima::fastrtps::Duration_t lease;
  eprosima::fastrtps::Duration_t deadline;
};

/// From the quality of service of an own or of a discovered endpoint.
template <class Qos>
MatchingQos MatchingQosOf(const Qos& qos) {
  if constexpr (requires { qos.m_reliability; }) {
    return {qos.m_reliability.kind, qos.m_durability.kind,           qos.m_liveliness.kind,
            qos.m_ownership.kind,   qos.m_liveliness.lease_duration, qos.m_deadline.period};
  } else {
    return {qos.reliability().kind, qos.durability().kind,           qos.liveliness().kind,
            qos.ownership().kind,   qos.liveliness().lease_duration, qos.deadline().period};
  }
}

/// In words, what a reader asks for that a writer does not offer; empty when they match.
std::string DescribeMisfit(const MatchingQos& offered, const MatchingQos& asked);

/// What other participants of the domain have, as their announcements tell. Thread-safe.
class Discovery : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// Each reader of `topic` that a writer with `offered` cannot serve, by the name of its program, and why.
  std::vector<std::string> FindMisfitReaders(const std::string& topic, const MatchingQos& offered) const;
  std::vector<std::string> FindMisfitWriters(const std::string& topic, const MatchingQos& asked) const;

  std::vector<RemoteEndpoint> List() const;

 private:
  using Participant = eprosima::fastdds::dds::DomainParticipant;
  using Guid = eprosima::fastrtps::rtps::GUID_t;
  struct Known {
    std::string topic;
    std::string type;
    bool is_writer;
    MatchingQos qos;
  };

  void on_participant_discovery(Participant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_subscriber_discovery(Participant* participant,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void on_publisher_discovery(Participant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  std::string NameOf(const Guid& endpoint) const;

  mutable std::mutex mutex_;
  std::map<eprosima::fastrtps::rtps::GuidPrefix_t, std::string> participants_;
  std::map<Guid, Known> endpoints_;
};

}  // namespace soffit::dds_internal
