#include "shared/dds/fragment_counter.h"

#include <fastdds/rtps/transport/ChainingTransport.h>

#include <algorithm>
#include <array>
#include <concepts>

namespace soffit::dds_internal {
namespace {

namespace rtps = eprosima::fastdds::rtps;
namespace core = eprosima::fastrtps::rtps;

constexpr std::array<std::uint8_t, 4> kMagic = {'R', 'T', 'P', 'S'};
constexpr std::size_t kHeaderSize = 20;
constexpr std::size_t kSubmessageHeaderSize = 4;
constexpr std::uint8_t kDataFrag = 0x16;
constexpr std::size_t kDataFragSize = 36;  // With its header, up to the size of the sample.
constexpr std::size_t kKeptSamples = 16;
constexpr std::uint32_t kMaxFragments = 1 << 20;

template <std::unsigned_integral T>
T Read(std::span<const std::uint8_t> bytes, std::size_t at, bool is_little_endian) {
  T value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value = static_cast<T>(value << 8 | bytes[at + (is_little_endian ? sizeof(T) - 1 - i : i)]);
  }
  return value;
}

struct CountingDescriptor : rtps::ChainingTransportDescriptor {
  CountingDescriptor(std::shared_ptr<TransportDescriptorInterface> below,
                     std::shared_ptr<FragmentCounter> its_counter)
      : ChainingTransportDescriptor(std::move(below)), counter(std::move(its_counter)) {}
  rtps::TransportInterface* create_transport() const override;

  std::shared_ptr<FragmentCounter> counter;
};

class CountingTransport : public rtps::ChainingTransport {
 public:
  explicit CountingTransport(const CountingDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(core::SenderResource* sender, const core::octet* bytes, std::uint32_t size,
            core::LocatorsIterator* first, core::LocatorsIterator* last,
            const std::chrono::steady_clock::time_point& timeout) override {
    // Each message is given to all sockets; the first is the one for all that is not multicast.
    core::SenderResource* nobody = nullptr;
    unicast_.compare_exchange_strong(nobody, sender);
    if (unicast_ == sender) descriptor_.counter->Note({bytes, size});
    return sender->send(bytes, size, first, last, timeout);
  }

  void receive(rtps::TransportReceiverInterface* receiver, const core::octet* bytes, std::uint32_t size,
               const core::Locator_t& local, const core::Locator_t& remote) override {
    receiver->OnDataReceived(bytes, size, local, remote);
  }

 private:
  CountingDescriptor descriptor_;
  std::atomic<core::SenderResource*> unicast_ = nullptr;
};

rtps::TransportInterface* CountingDescriptor::create_transport() const {
  return new CountingTransport(*this);
}

}  // namespace

void FragmentCounter::Note(std::span<const std::uint8_t> message) {
  if (message.size() < kHeaderSize || !std::ranges::equal(message.first(kMagic.size()), kMagic)) return;
  std::size_t at = kHeaderSize;
  while (at + kSubmessageHeaderSize <= message.size()) {
    const bool is_little_endian = (message[at + 1] & 1) != 0;
    const std::size_t length = Read<std::uint16_t>(message, at + 2, is_little_endian);
    if (message[at] == kDataFrag && at + kDataFragSize <= message.size()) {
      const auto part = message.subspan(at, kDataFragSize);
      const auto writer = Read<std::uint32_t>(part, 12, false);
      const std::uint64_t number = std::uint64_t{Read<std::uint32_t>(part, 16, is_little_endian)} << 32 |
                                   Read<std::uint32_t>(part, 20, is_little_endian);
      const auto first = Read<std::uint32_t>(part, 24, is_little_endian);
      const auto count = Read<std::uint16_t>(part, 28, is_little_endian);
      if (first == 0 || first > kMaxFragments) return;
      const std::lock_guard lock(mutex_);
      std::vector<bool>& is_sent = is_sent_[{writer, number}];
      is_sent.resize(std::max<std::size_t>(is_sent.size(), first + count));
      for (std::uint32_t i = first; i < first + count; ++i) {
        sent_again_ += is_sent[i] ? 1 : 0;
        is_sent[i] = true;
      }
      sent_ += count;
      if (is_sent_.size() > kKeptSamples) is_sent_.erase(is_sent_.begin());
    }
    if (length == 0) return;  // The last one, up to the end.
    at += kSubmessageHeaderSize + length;
  }
}

std::shared_ptr<rtps::TransportDescriptorInterface> CountFragments(
    std::shared_ptr<rtps::TransportDescriptorInterface> below, std::shared_ptr<FragmentCounter> counter) {
  return std::make_shared<CountingDescriptor>(std::move(below), std::move(counter));
}

}  // namespace soffit::dds_internal
