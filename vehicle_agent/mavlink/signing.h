#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

#include "shared/result/result.h"

/// MAVLink 2 message signing: https://mavlink.io/en/guide/message_signing.html.
namespace soffit::mavlink {

using SigningKey = std::array<std::uint8_t, 32>;

/// The key in the text of a key file: 64 hexadecimal digits, white space around them. An error says what is
/// wrong, without the key.
Result<SigningKey> ParseSigningKey(std::string_view text);

/// Signs packets for one link.
class Signer {
 public:
  Signer(const SigningKey& key, std::uint8_t link_id) : key_(key), link_id_(link_id) {}

  /// Signs an unsigned MAVLink 2 packet of a message in messages.h. Time stamps never repeat, even when the
  /// clock is set back.
  void Sign(std::vector<std::uint8_t>& packet, std::int64_t utc_ns);

 private:
  SigningKey key_;
  std::uint8_t link_id_;
  std::uint64_t newest_ = 0;
};

/// Tells packets of those who know the key, each heard once, from all others.
class SignatureGuard {
 public:
  /// @param utc_ns  Of now: a sender that is heard for the first time must not be a minute older.
  SignatureGuard(const SigningKey& key, std::int64_t utc_ns);

  /// Whether a whole packet carries our key's signature, and is newer than all before it of its sender. An
  /// unsigned packet, a forged one and a replayed one are not.
  bool Accepts(std::span<const std::uint8_t> packet);

 private:
  using Stream = std::tuple<std::uint8_t, std::uint8_t, std::uint8_t>;  ///< Link, system, component.

  SigningKey key_;
  std::uint64_t newest_;
  std::map<Stream, std::uint64_t> newest_of_;
};

}  // namespace soffit::mavlink
