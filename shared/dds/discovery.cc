#include "shared/dds/discovery.h"

#include <sstream>

namespace soffit::dds_internal {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

const char* ToString(dds::DurabilityQosPolicyKind_t kind) {
  switch (kind) {
    case dds::VOLATILE_DURABILITY_QOS:
      return "volatile";
    case dds::TRANSIENT_LOCAL_DURABILITY_QOS:
      return "transient local";
    case dds::TRANSIENT_DURABILITY_QOS:
      return "transient";
    case dds::PERSISTENT_DURABILITY_QOS:
      break;
  }
  return "persistent";
}

const char* ToString(dds::ReliabilityQosPolicyKind kind) {
  return kind == dds::RELIABLE_RELIABILITY_QOS ? "reliable" : "best effort";
}

std::string Seconds(const eprosima::fastrtps::Duration_t& duration) {
  if (duration == eprosima::fastrtps::c_TimeInfinite) return "none";
  std::ostringstream text;
  text << static_cast<double>(duration.to_ns()) * 1e-9 << " s";
  return text.str();
}

std::string Differ(const char* policy, const std::string& asked, const std::string& offered) {
  return std::string(policy) + " (" + asked + " is asked for, " + offered + " is offered)";
}

}  // namespace

std::string DescribeMisfit(const MatchingQos& offered, const MatchingQos& asked) {
  std::vector<std::string> misfits;
  if (asked.reliability > offered.reliability)
    misfits.push_back(Differ("reliability", ToString(asked.reliability), ToString(offered.reliability)));
  if (asked.durability > offered.durability)
    misfits.push_back(Differ("durability", ToString(asked.durability), ToString(offered.durability)));
  if (asked.deadline < offered.deadline)
    misfits.push_back(Differ("deadline", Seconds(asked.deadline), Seconds(offered.deadline)));
  if (asked.lease < offered.lease || asked.liveliness > offered.liveliness)
    misfits.push_back(Differ("liveliness", "a lease of " + Seconds(asked.lease), Seconds(offered.lease)));
  if (asked.ownership != offered.ownership) misfits.emplace_back("ownership (one is shared, one exclusive)");
  std::string all;
  for (const std::string& misfit : misfits) all += (all.empty() ? "" : ", ") + misfit;
  return all;
}

std::vector<std::string> Discovery::FindMisfitReaders(const std::string& topic,
                                                      const MatchingQos& offered) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> found;
  for (const auto& [guid, reader] : endpoints_) {
    if (reader.is_writer || reader.topic != topic) continue;
    const std::string misfit = DescribeMisfit(offered, reader.qos);
    if (!misfit.empty()) found.push_back("the reader of " + NameOf(guid) + " does not fit: " + misfit);
  }
  return found;
}

std::vector<std::string> Discovery::FindMisfitWriters(const std::string& topic,
                                                      const MatchingQos& asked) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> found;
  for (const auto& [guid, writer] : endpoints_) {
    if (!writer.is_writer || writer.topic != topic) continue;
    const std::string misfit = DescribeMisfit(writer.qos, asked);
    if (!misfit.empty()) found.push_back("the writer of " + NameOf(guid) + " does not fit: " + misfit);
  }
  return found;
}

std::vector<RemoteEndpoint> Discovery::List() const {
  const std::lock_guard lock(mutex_);
  std::vector<RemoteEndpoint> all;
  for (const auto& [guid, known] : endpoints_) {
    all.push_back({known.topic, known.type, NameOf(guid), known.is_writer,
                   known.qos.reliability == dds::RELIABLE_RELIABILITY_QOS,
                   known.qos.durability >= dds::TRANSIENT_LOCAL_DURABILITY_QOS});
  }
  return all;
}

/// A participant without a name is told by its GUID.
std::string Discovery::NameOf(const Guid& endpoint) const {
  const auto known = participants_.find(endpoint.guidPrefix);
  if (known != participants_.end() && !known->second.empty()) return "'" + known->second + "'";
  std::ostringstream text;
  text << endpoint.guidPrefix;
  return text.str();
}

void Discovery::on_participant_discovery(Participant*, rtps::ParticipantDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  const auto& prefix = info.info.m_guid.guidPrefix;
  if (info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
      info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT) {
    participants_.erase(prefix);
    std::erase_if(endpoints_, [&](const auto& entry) { return entry.first.guidPrefix == prefix; });
  } else {
    participants_[prefix] = info.info.m_participantName.to_string();
  }
}

void Discovery::on_subscriber_discovery(Participant*, rtps::ReaderDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
    endpoints_.erase(info.info.guid());
  } else {
    endpoints_.insert_or_assign(
        info.info.guid(), Known{info.info.topicName().to_string(), info.info.typeName().to_string(), false,
                                MatchingQosOf(info.info.m_qos)});
  }
}

void Discovery::on_publisher_discovery(Participant*, rtps::WriterDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
    endpoints_.erase(info.info.guid());
  } else {
    endpoints_.insert_or_assign(
        info.info.guid(), Known{info.info.topicName().to_string(), info.info.typeName().to_string(), true,
                                MatchingQosOf(info.info.m_qos)});
  }
}

}  // namespace soffit::dds_internal
