#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace soffit::dds_internal {

/// Counts the fragments of large samples that a participant sends, and those that it had sent before: the
/// library does not tell. Thread-safe.
class FragmentCounter {
 public:
  /// Notes the DATA_FRAG submessages (OMG DDSI-RTPS 2.3, 9.4.5.4) of one message that goes out. Anything may
  /// be given; what is no such message is not counted.
  void Note(std::span<const std::uint8_t> message);

  std::uint64_t sent() const { return sent_; }
  std::uint64_t sent_again() const { return sent_again_; }

 private:
  using SampleId = std::pair<std::uint32_t, std::uint64_t>;  ///< Writer, number.

  std::mutex mutex_;
  std::map<SampleId, std::vector<bool>> is_sent_;  ///< By fragment.
  std::atomic<std::uint64_t> sent_ = 0;
  std::atomic<std::uint64_t> sent_again_ = 0;
};

/// A transport through `below` that shows `counter` what is sent.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> CountFragments(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> below,
    std::shared_ptr<FragmentCounter> counter);

}  // namespace soffit::dds_internal
