#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <string>

#include "shared/dds/participant.h"
#include "shared/dds/topic.h"

namespace soffit::dds_internal {

inline constexpr const char* kFlowControllerName = "soffit_large_data";

/// An error when an interface or peer is no address.
Result<eprosima::fastdds::dds::DomainParticipantQos> MakeParticipantQos(const std::string& name,
                                                                        const DdsOptions& options);
eprosima::fastdds::dds::DataWriterQos MakeWriterQos(TopicKind kind, bool has_flow_control);
eprosima::fastdds::dds::DataReaderQos MakeReaderQos(TopicKind kind);

}  // namespace soffit::dds_internal
