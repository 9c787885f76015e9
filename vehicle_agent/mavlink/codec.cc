#include "vehicle_agent/mavlink/codec.h"

#include <algorithm>
#include <utility>

namespace soffit::mavlink {
namespace {

constexpr std::uint8_t kMagicV1 = 0xfe;
constexpr std::uint8_t kMagicV2 = 0xfd;
constexpr std::size_t kHeaderLengthV1 = 6;
constexpr std::size_t kHeaderLengthV2 = 10;
constexpr std::size_t kChecksumLength = 2;
constexpr std::size_t kSignatureLength = 13;
constexpr std::uint8_t kSignedFlag = 0x01;

template <class... Messages>
constexpr auto MakeCatalogue(std::type_identity<std::tuple<Messages...>>) {
  static_assert((IsInWireOrder<Messages>() && ...));
  return std::array{InfoOf<Messages>()...};
}
constexpr auto kCatalogue = MakeCatalogue(std::type_identity<AllMessages>{});
static_assert(std::is_sorted(kCatalogue.begin(), kCatalogue.end(),
                             [](const MessageInfo& a, const MessageInfo& b) { return a.id < b.id; }));

/// Over the packet without its first byte, then the message's CRC_EXTRA.
std::uint16_t Checksum(std::span<const std::uint8_t> packet, std::uint8_t crc_extra) {
  std::uint16_t crc = 0xffff;
  for (const std::uint8_t byte : packet.subspan(1)) crc = AddToChecksum(crc, byte);
  return AddToChecksum(crc, crc_extra);
}

bool IsMagic(std::uint8_t byte) { return byte == kMagicV1 || byte == kMagicV2; }

/// What stands at the start of a run of bytes.
struct Attempt {
  enum class Kind { kNeedsMore, kGarbage, kUnknownMessage, kFrame } kind = Kind::kGarbage;
  std::size_t length = 1;  ///< To move on by.
  Frame frame;
};

Attempt ReadFrame(std::span<const std::uint8_t> bytes) {
  using Kind = Attempt::Kind;
  if (!IsMagic(bytes[0])) return {Kind::kGarbage, 1, {}};
  const bool is_v2 = bytes[0] == kMagicV2;
  const std::size_t header_length = is_v2 ? kHeaderLengthV2 : kHeaderLengthV1;
  if (bytes.size() < header_length) return {Kind::kNeedsMore, 0, {}};
  const std::uint8_t flags = is_v2 ? bytes[2] : 0;
  if ((flags & ~kSignedFlag) != 0) return {Kind::kGarbage, 1, {}};

  Frame frame;
  const std::size_t ids = is_v2 ? 4 : 2;
  frame.version = is_v2 ? 2 : 1;
  frame.sequence = bytes[ids];
  frame.system_id = bytes[ids + 1];
  frame.component_id = bytes[ids + 2];
  frame.message_id = bytes[ids + 3];
  if (is_v2) frame.message_id |= std::uint32_t{bytes[8]} << 8 | std::uint32_t{bytes[9]} << 16;

  const std::size_t payload_end = header_length + bytes[1];
  const std::size_t length = payload_end + kChecksumLength + (flags != 0 ? kSignatureLength : 0);
  const MessageInfo* info = FindMessage(frame.message_id);
  if (info != nullptr && !is_v2 && (bytes[1] < info->base_length || bytes[1] > info->full_length))
    return {Kind::kGarbage, 1, {}};
  if (bytes.size() < length) return {Kind::kNeedsMore, 0, {}};
  if (info == nullptr) return {Kind::kUnknownMessage, length, {}};

  const auto received = static_cast<std::uint16_t>(bytes[payload_end] | bytes[payload_end + 1] << 8);
  if (received != Checksum(bytes.first(payload_end), info->crc_extra)) return {Kind::kGarbage, 1, {}};
  frame.payload.assign(bytes.begin() + static_cast<std::ptrdiff_t>(header_length),
                       bytes.begin() + static_cast<std::ptrdiff_t>(payload_end));
  return {Kind::kFrame, length, std::move(frame)};
}

}  // namespace

const MessageInfo* FindMessage(std::uint32_t id) {
  const auto found =
      std::lower_bound(kCatalogue.begin(), kCatalogue.end(), id,
                       [](const MessageInfo& info, std::uint32_t wanted) { return info.id < wanted; });
  return found != kCatalogue.end() && found->id == id ? &*found : nullptr;
}

std::vector<std::uint8_t> Pack(const Frame& frame) {
  const auto is_zero = [](std::uint8_t byte) { return byte == 0; };
  auto end = std::find_if_not(frame.payload.rbegin(), frame.payload.rend(), is_zero).base();
  if (end == frame.payload.begin() && !frame.payload.empty()) ++end;  // One byte at least.
  const auto length = static_cast<std::size_t>(end - frame.payload.begin());
  std::vector<std::uint8_t> packet;
  packet.reserve(kHeaderLengthV2 + length + kChecksumLength);
  codec_internal::Writer writer{packet};
  const std::uint16_t no_flags = 0;
  writer.Put(kMagicV2);
  writer.Put(static_cast<std::uint8_t>(length));
  writer.Put(no_flags);
  writer.Put(frame.sequence);
  writer.Put(frame.system_id);
  writer.Put(frame.component_id);
  writer.Put(static_cast<std::uint16_t>(frame.message_id));
  writer.Put(static_cast<std::uint8_t>(frame.message_id >> 16));
  packet.insert(packet.end(), frame.payload.begin(), end);
  writer.Put(Checksum(packet, FindMessage(frame.message_id)->crc_extra));
  return packet;
}

bool IsSigned(std::span<const std::uint8_t> packet) {
  return packet.size() >= kHeaderLengthV2 + kChecksumLength + kSignatureLength && packet[0] == kMagicV2 &&
         (packet[2] & kSignedFlag) != 0;
}

void MarkAsSigned(std::vector<std::uint8_t>& packet) {
  packet[2] |= kSignedFlag;
  packet.resize(packet.size() - kChecksumLength);
  const std::uint32_t id = packet[7] | std::uint32_t{packet[8]} << 8 | std::uint32_t{packet[9]} << 16;
  codec_internal::Writer writer{packet};
  writer.Put(Checksum(packet, FindMessage(id)->crc_extra));
}

std::vector<Frame> FrameParser::Feed(std::span<const std::uint8_t> bytes) {
  pending_.insert(pending_.end(), bytes.begin(), bytes.end());
  std::vector<Frame> frames;
  std::size_t start = 0;
  while (start < pending_.size()) {
    Attempt attempt = ReadFrame(std::span<const std::uint8_t>(pending_).subspan(start));
    if (attempt.kind == Attempt::Kind::kNeedsMore) break;
    if (attempt.kind == Attempt::Kind::kUnknownMessage) {
      // Its checksum cannot be checked. What follows tells whether it was a packet or garbage that looks like
      // one.
      const std::size_t end = start + attempt.length;
      if (end < pending_.size() && !IsMagic(pending_[end])) attempt = {Attempt::Kind::kGarbage, 1, {}};
    }
    if (attempt.kind == Attempt::Kind::kFrame) {
      const auto packet = std::span<const std::uint8_t>(pending_).subspan(start, attempt.length);
      if (guard_ && !guard_->Accepts(packet)) {
        ++refused_packet_count_;
      } else {
        frames.push_back(std::move(attempt.frame));
      }
    }
    if (attempt.kind == Attempt::Kind::kGarbage) dropped_byte_count_ += attempt.length;
    start += attempt.length;
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(start));
  return frames;
}

}  // namespace soffit::mavlink
