#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <string>

#include "shared/dds/fragment_counter.h"
#include "shared/dds/link_profile.h"
#include "shared/dds/participant.h"
#include "shared/dds/topic.h"

namespace soffit::dds_internal {

inline constexpr const char* kFlowControllerName = "soffit_large_data";

/// An error when an interface or peer is no address. With `udp_only`, `fragments` are counted.
Result<eprosima::fastdds::dds::DomainParticipantQos> MakeParticipantQos(
    const std::string& name, const DdsOptions& options, const LinkProfile& profile,
    const std::shared_ptr<FragmentCounter>& fragments);
eprosima::fastdds::dds::DataWriterQos MakeWriterQos(TopicKind kind, const LinkProfile& profile);
eprosima::fastdds::dds::DataReaderQos MakeReaderQos(TopicKind kind);

}  // namespace soffit::dds_internal
