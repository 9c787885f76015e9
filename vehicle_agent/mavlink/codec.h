#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "vehicle_agent/mavlink/messages.h"
#include "vehicle_agent/mavlink/signing.h"

/// MAVLink 2 framing and (de)serialization: https://mavlink.io/en/guide/serialization.html.
namespace soffit::mavlink {

/// One packet, unpacked as far as that is the same for all messages.
struct Frame {
  std::uint8_t version = 2;  ///< 1 or 2.
  std::uint8_t sequence = 0;
  std::uint8_t system_id = 0;
  std::uint8_t component_id = 0;
  std::uint32_t message_id = 0;
  std::vector<std::uint8_t>
      payload;  ///< As it was on the wire, without its trailing zeros if the sender left them out.
};

/// What has to be known of a message to take it from a stream.
struct MessageInfo {
  std::uint32_t id = 0;
  std::string_view name;
  std::uint8_t crc_extra =
      0;  ///< Checksum of the names and types of the fields, so that both sides mean the same.
  std::size_t base_length = 0;  ///< Of the payload without extension fields.
  std::size_t full_length = 0;
};

/// None for a message that is not in messages.h.
const MessageInfo* FindMessage(std::uint32_t id);

/// CRC-16/MCRF4XX (X.25 without the final inversion).
constexpr std::uint16_t AddToChecksum(std::uint16_t crc, std::uint8_t byte) {
  auto t = static_cast<std::uint8_t>(byte ^ (crc & 0xff));
  t = static_cast<std::uint8_t>(t ^ (t << 4));
  return static_cast<std::uint16_t>((crc >> 8) ^ (t << 8) ^ (t << 3) ^ (t >> 4));
}

namespace codec_internal {

template <class T>
struct ArrayTraits {
  using Element = T;
  static constexpr std::size_t kCount = 0;  // A scalar.
};
template <class T, std::size_t N>
struct ArrayTraits<std::array<T, N>> {
  using Element = T;
  static constexpr std::size_t kCount = N;
};

template <class T>
constexpr std::string_view TypeName() {
  if constexpr (std::is_same_v<T, char>) return "char";
  if constexpr (std::is_same_v<T, float>) return "float";
  if constexpr (std::is_same_v<T, double>) return "double";
  if constexpr (std::is_same_v<T, std::int8_t>) return "int8_t";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "uint8_t";
  if constexpr (std::is_same_v<T, std::int16_t>) return "int16_t";
  if constexpr (std::is_same_v<T, std::uint16_t>) return "uint16_t";
  if constexpr (std::is_same_v<T, std::int32_t>) return "int32_t";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "uint32_t";
  if constexpr (std::is_same_v<T, std::int64_t>) return "int64_t";
  if constexpr (std::is_same_v<T, std::uint64_t>) return "uint64_t";
}

/// Visitor that works out a message's lengths and CRC_EXTRA, and whether its base fields are in wire order.
struct Surveyor {
  std::uint16_t crc = 0xffff;
  std::size_t base_length = 0;
  std::size_t full_length = 0;
  std::size_t last_size = 8;
  bool in_extensions = false;
  bool is_ordered = true;

  constexpr void AddText(std::string_view text) {
    for (const char c : text) crc = AddToChecksum(crc, static_cast<std::uint8_t>(c));
    crc = AddToChecksum(crc, ' ');
  }
  constexpr void Extensions() { in_extensions = true; }

  template <class T>
  constexpr void operator()(std::string_view name, const T&) {
    using Element = typename ArrayTraits<T>::Element;
    constexpr std::size_t kCount = ArrayTraits<T>::kCount;
    constexpr std::size_t kBytes = sizeof(Element) * std::max<std::size_t>(kCount, 1);
    full_length += kBytes;
    if (in_extensions) return;
    base_length += kBytes;
    is_ordered = is_ordered && sizeof(Element) <= last_size;
    last_size = sizeof(Element);
    AddText(TypeName<Element>());
    AddText(name);
    if (kCount > 0) crc = AddToChecksum(crc, static_cast<std::uint8_t>(kCount));
  }
};

template <class T>
using Bits =
    std::conditional_t<sizeof(T) == 1, std::uint8_t,
                       std::conditional_t<sizeof(T) == 2, std::uint16_t,
                                          std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;

/// Visitor that appends fields, little end first.
struct Writer {
  std::vector<std::uint8_t>& bytes;

  void Extensions() {}
  template <class T>
  void operator()(std::string_view, const T& value) {
    if constexpr (ArrayTraits<T>::kCount > 0) {
      for (const auto& element : value) Put(element);
    } else {
      Put(value);
    }
  }
  template <class T>
  void Put(T value) {
    const auto bits = std::bit_cast<Bits<T>>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
  }
};

/// Visitor that takes fields from a payload; what the sender left out is zero.
struct Reader {
  std::span<const std::uint8_t> bytes;
  std::size_t next = 0;

  void Extensions() {}
  template <class T>
  void operator()(std::string_view, T& value) {
    if constexpr (ArrayTraits<T>::kCount > 0) {
      for (auto& element : value) Take(element);
    } else {
      Take(value);
    }
  }
  template <class T>
  void Take(T& value) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i, ++next) {
      if (next < bytes.size()) bits |= std::uint64_t{bytes[next]} << (8 * i);
    }
    value = std::bit_cast<T>(static_cast<Bits<T>>(bits));
  }
};

}  // namespace codec_internal

/// Lengths and CRC_EXTRA of a message type, at compile time.
template <class Message>
constexpr MessageInfo InfoOf() {
  codec_internal::Surveyor survey;
  survey.AddText(Message::kName);
  const Message message{};
  Message::Visit(message, survey);
  return {Message::kId, Message::kName, static_cast<std::uint8_t>((survey.crc & 0xff) ^ (survey.crc >> 8)),
          survey.base_length, survey.full_length};
}

/// Whether the base fields stand in wire order, largest type first. All of messages.h is checked at compile
/// time.
template <class Message>
constexpr bool IsInWireOrder() {
  codec_internal::Surveyor survey;
  const Message message{};
  Message::Visit(message, survey);
  return survey.is_ordered && survey.full_length <= 255;
}

/// The fields of a frame of this type; none when the frame carries another message. Fields that the sender
/// left out are zero, fields that it has beyond ours are ignored.
template <class Message>
std::optional<Message> Decode(const Frame& frame) {
  if (frame.message_id != Message::kId) return std::nullopt;
  Message message{};
  Message::Visit(message, codec_internal::Reader{frame.payload});
  return message;
}

/// The packet of a frame of a message in messages.h: MAVLink 2, unsigned, trailing zeros left out.
std::vector<std::uint8_t> Pack(const Frame& frame);

/// Whether a whole packet says that a signature of 13 bytes follows its checksum.
bool IsSigned(std::span<const std::uint8_t> packet);

/// Makes an unsigned packet say so; its checksum is made anew. The signature itself is for the caller to add.
void MarkAsSigned(std::vector<std::uint8_t>& packet);

/// Makes packets, numbered in sequence, for one sender on one link. MAVLink 2, unsigned.
class Encoder {
 public:
  Encoder(std::uint8_t system_id, std::uint8_t component_id)
      : system_id_(system_id), component_id_(component_id) {}

  template <class Message>
  std::vector<std::uint8_t> Encode(const Message& message) {
    Frame frame{2, sequence_++, system_id_, component_id_, Message::kId, {}};
    Message::Visit(message, codec_internal::Writer{frame.payload});
    return Pack(frame);
  }

 private:
  std::uint8_t system_id_;
  std::uint8_t component_id_;
  std::uint8_t sequence_ = 0;
};

/// Finds packets in a stream of bytes that may be cut anywhere and may hold garbage.
///
/// MAVLink 1 and 2. Signatures are skipped, unless there is a key to check them by: then whatever is not
/// signed by it is left out and counted. A message that is not in messages.h cannot be
/// checked and is left out; so is everything whose checksum, length or flags are wrong, and the search goes
/// on right behind its first byte. Never throws on any input; keeps at most one packet's worth of bytes
/// between calls.
class FrameParser {
 public:
  FrameParser() = default;
  explicit FrameParser(std::optional<SignatureGuard> guard) : guard_(std::move(guard)) {}

  /// The complete packets up to the end of `bytes`, in order.
  std::vector<Frame> Feed(std::span<const std::uint8_t> bytes);

  /// Bytes that were no part of a packet; packets of messages that we do not know are not counted.
  std::uint64_t dropped_byte_count() const { return dropped_byte_count_; }

  /// Packets that were whole, but not signed by the key, or replayed.
  std::uint64_t refused_packet_count() const { return refused_packet_count_; }

 private:
  std::optional<SignatureGuard> guard_;
  std::vector<std::uint8_t> pending_;
  std::uint64_t refused_packet_count_ = 0;
  std::uint64_t dropped_byte_count_ = 0;
};

/// A text field up to its first NUL (there is none when the text fills the field).
template <std::size_t N>
std::string TextOf(const std::array<char, N>& field) {
  return {field.begin(), std::find(field.begin(), field.end(), '\0')};
}

/// A text field; what does not fit is cut off.
template <std::size_t N>
std::array<char, N> ToTextField(std::string_view text) {
  std::array<char, N> field{};
  std::copy_n(text.begin(), std::min(text.size(), N), field.begin());
  return field;
}

}  // namespace soffit::mavlink
