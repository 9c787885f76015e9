#include "shared/dds/qos.h"

#include <arpa/inet.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <fastdds/rtps/flowcontrol/FlowControllerDescriptor.hpp>

namespace soffit::dds_internal {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastdds::rtps;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;

constexpr int kMaxParticipantsOfAHost = 16;
constexpr int kMaxKeys = 4096;

bool IsIpv4(const std::string& text) {
  in_addr address{};
  return inet_pton(AF_INET, text.c_str(), &address) == 1;
}

Result<Locator_t> FindPeer(const std::string& host) {
  std::string address = host;
  if (!IsIpv4(host)) {
    const auto found = IPLocator::resolveNameDNS(host).first;
    if (found.empty())
      return InvalidInput("DDS peer '" + host + "' is neither an IPv4 address nor a known host name");
    address = *found.begin();
  }
  Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  IPLocator::setIPv4(locator, address);
  return locator;
}

bool IsReliable(TopicKind kind) { return kind != TopicKind::kState; }

int HistoryDepth(TopicKind kind) {
  switch (kind) {
    case TopicKind::kPicture:
      return 3;
    case TopicKind::kCommand:
      return 16;
    case TopicKind::kQuery:
      return 32;
    case TopicKind::kStream:
      return 100;
    case TopicKind::kState:
    case TopicKind::kLatched:
      break;
  }
  return 1;
}

template <class Qos>
void SetCommon(TopicKind kind, Qos& qos) {
  qos.reliability().kind =
      IsReliable(kind) ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      kind == TopicKind::kLatched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = HistoryDepth(kind);
  qos.resource_limits().max_instances = kMaxKeys;
  qos.resource_limits().max_samples_per_instance = HistoryDepth(kind);
  qos.resource_limits().max_samples = kMaxKeys * HistoryDepth(kind);
  qos.resource_limits().allocated_samples = 1;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
  if (kind == TopicKind::kState) {
    qos.deadline().period = Duration_t(kStateDeadline_s);
    qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
    qos.liveliness().lease_duration = Duration_t(kStateLease_s);
  }
}

}  // namespace

Result<dds::DomainParticipantQos> MakeParticipantQos(const std::string& name, const DdsOptions& options,
                                                     const LinkProfile& profile,
                                                     const std::shared_ptr<FragmentCounter>& fragments) {
  dds::DomainParticipantQos qos;
  qos.name(name);
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = Duration_t(3.0);
  discovery.leaseDuration_announcementperiod = Duration_t(0.5);
  discovery.initial_announcements.count = 10;
  discovery.initial_announcements.period = Duration_t(0.1);
  for (const std::string& peer : options.peers) {
    const auto locator = FindPeer(peer);
    if (!locator.ok()) return locator.error();
    qos.wire_protocol().builtin.initialPeersList.push_back(locator.value());
  }
  if (options.udp_only) {
    const auto udp = std::make_shared<rtps::UDPv4TransportDescriptor>();
    udp->sendBufferSize = 1 << 20;
    udp->receiveBufferSize = 4 << 20;
    udp->maxInitialPeersRange = kMaxParticipantsOfAHost;
    for (const std::string& interface : options.interfaces) {
      if (!IsIpv4(interface)) return InvalidInput("DDS interface '" + interface + "' is not an IPv4 address");
      udp->interfaceWhiteList.push_back(interface);
    }
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(CountFragments(udp, fragments));
  }
  if (profile.flow_bytes > 0) {
    const auto flow = std::make_shared<rtps::FlowControllerDescriptor>();
    flow->name = kFlowControllerName;
    flow->max_bytes_per_period = profile.flow_bytes;
    flow->period_ms = static_cast<std::uint64_t>(profile.flow_period_ms);
    qos.flow_controllers().push_back(flow);
  }
  return qos;
}

dds::DataWriterQos MakeWriterQos(TopicKind kind, const LinkProfile& profile) {
  dds::DataWriterQos qos;
  SetCommon(kind, qos);
  const bool is_large = kind == TopicKind::kPicture || kind == TopicKind::kLatched;
  // The library's 3 s are the time that the repair of a lost tail would take.
  qos.reliable_writer_qos().times.heartbeatPeriod =
      Duration_t(is_large ? profile.large_heartbeat_s : profile.heartbeat_s);
  if (kind == TopicKind::kCommand) qos.lifespan().duration = Duration_t(kCommandLifespan_s);
  if (kind == TopicKind::kPicture) {  // KEEP_LAST would give up a half-sent picture for the next one.
    qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
    qos.resource_limits().max_samples = 2;
    qos.resource_limits().max_instances = 1;
    qos.resource_limits().max_samples_per_instance = 2;
    qos.reliability().max_blocking_time = Duration_t(0.05);
  }
  if (is_large) {
    qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;
    if (profile.flow_bytes > 0) qos.publish_mode().flow_controller_name = kFlowControllerName;
  }
  return qos;
}

dds::DataReaderQos MakeReaderQos(TopicKind kind) {
  dds::DataReaderQos qos;
  SetCommon(kind, qos);
  return qos;
}

}  // namespace soffit::dds_internal
