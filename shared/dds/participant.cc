#include "shared/dds/participant.h"

#include <charconv>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/log/StdoutErrConsumer.hpp>
#include <mutex>
#include <string_view>

#include "shared/dds/bus.h"
#include "shared/dds/qos.h"

namespace soffit {
namespace {

/// Standard output belongs to the programs, so the library's own messages go to standard error.
void KeepLibraryOffStandardOutput() {
  static std::once_flag once;
  std::call_once(once, [] {
    using eprosima::fastdds::dds::Log;
    auto consumer = std::make_unique<eprosima::fastdds::dds::StdoutErrConsumer>();
    consumer->stderr_threshold(Log::Kind::Info);
    Log::ClearConsumers();
    Log::RegisterConsumer(std::move(consumer));
  });
}

/// -1, which no option allows, when `text` is no whole number.
int ReadDomainId(const std::string_view text) {
  int id = -1;
  const auto end = text.data() + text.size();
  return std::from_chars(text.data(), end, id).ptr == end ? id : -1;
}

}  // namespace

DdsOptions DefaultRadioOptions() {
  DdsOptions options;
  options.domain_id = 41;
  options.udp_only = true;
  options.profile = "wifi";
  return options;
}

DdsOptions DefaultLocalOptions() {
  DdsOptions options;
  const char* ros_domain = std::getenv("ROS_DOMAIN_ID");
  options.domain_id = ros_domain != nullptr ? ReadDomainId(ros_domain) : 42;
  return options;
}

std::vector<RemoteEndpoint> Participant::Discovered() const { return bus_->discovery().List(); }

FragmentCounts Participant::CountFragments() const {
  return {bus_->fragments().sent(), bus_->fragments().sent_again()};
}

Result<Participant> Participant::Join(const std::string& name, const DdsOptions& options,
                                      ProblemHandler on_problem) {
  if (const std::string problem = FindOptionProblem(options); !problem.empty())
    return InvalidInput("DDS: " + problem);
  const Result<LinkProfile> profile = FindLinkProfile(options);
  if (!profile.ok()) return profile.error();
  const auto fragments = std::make_shared<dds_internal::FragmentCounter>();
  const auto qos = dds_internal::MakeParticipantQos(name, options, profile.value(), fragments);
  if (!qos.ok()) return qos.error();
  KeepLibraryOffStandardOutput();
  auto discovery = std::make_unique<dds_internal::Discovery>();
  auto* participant = eprosima::fastdds::dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<std::uint32_t>(options.domain_id), qos.value(), discovery.get(),
      eprosima::fastdds::dds::StatusMask::none());
  if (participant == nullptr) {
    return Error{Error::Code::kUnavailable,
                 "cannot join DDS domain " + std::to_string(options.domain_id) +
                     ": check that the interfaces of the configuration exist (soffit doctor)"};
  }
  return Participant(std::make_shared<dds_internal::Bus>(participant, std::move(discovery), profile.value(),
                                                         fragments, std::move(on_problem)));
}

}  // namespace soffit
