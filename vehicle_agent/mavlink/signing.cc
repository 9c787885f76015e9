#include "vehicle_agent/mavlink/signing.h"

#include <openssl/evp.h>

#include <algorithm>
#include <charconv>
#include <memory>

#include "vehicle_agent/mavlink/codec.h"

namespace soffit::mavlink {
namespace {

constexpr std::int64_t kEpochUtc_ns = 1'420'070'400'000'000'000;  // 2015-01-01
constexpr std::int64_t kTick_ns = 10'000;
constexpr std::uint64_t kMinute = 6'000'000;  // Ticks.
constexpr std::size_t kTailLength = 7;        // Link id and time stamp.
constexpr std::size_t kMaxStreams = 64;

std::uint64_t TicksOf(std::int64_t utc_ns) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(utc_ns - kEpochUtc_ns, 0) / kTick_ns);
}

/// The first six bytes of the SHA-256 of the key and what is signed.
std::array<std::uint8_t, 6> MakeSignature(const SigningKey& key, std::span<const std::uint8_t> signed_part) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> hash(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  std::array<std::uint8_t, EVP_MAX_MD_SIZE> digest{};
  EVP_DigestInit_ex(hash.get(), EVP_sha256(), nullptr);
  EVP_DigestUpdate(hash.get(), key.data(), key.size());
  EVP_DigestUpdate(hash.get(), signed_part.data(), signed_part.size());
  EVP_DigestFinal_ex(hash.get(), digest.data(), nullptr);
  std::array<std::uint8_t, 6> signature{};
  std::copy_n(digest.begin(), signature.size(), signature.begin());
  return signature;
}

}  // namespace

Result<SigningKey> ParseSigningKey(std::string_view text) {
  const char* const space = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(space), text.size()));
  text = text.substr(0, text.find_last_not_of(space) + 1);
  SigningKey key{};
  if (text.size() != 2 * key.size()) {
    return InvalidInput("a signing key has " + std::to_string(2 * key.size()) + " hexadecimal digits, not " +
                        std::to_string(text.size()) + " characters");
  }
  for (std::size_t i = 0; i < key.size(); ++i) {
    const char* const digits = text.data() + 2 * i;
    const auto [end, problem] = std::from_chars(digits, digits + 2, key[i], 16);
    if (problem != std::errc{} || end != digits + 2) {
      return InvalidInput("a signing key has hexadecimal digits only");
    }
  }
  return key;
}

void Signer::Sign(std::vector<std::uint8_t>& packet, std::int64_t utc_ns) {
  newest_ = std::max(newest_ + 1, TicksOf(utc_ns));
  MarkAsSigned(packet);
  packet.push_back(link_id_);
  for (unsigned i = 0; i < 6; ++i) packet.push_back(static_cast<std::uint8_t>(newest_ >> (8 * i)));
  const auto signature = MakeSignature(key_, packet);
  packet.insert(packet.end(), signature.begin(), signature.end());
}

SignatureGuard::SignatureGuard(const SigningKey& key, std::int64_t utc_ns)
    : key_(key), newest_(TicksOf(utc_ns)) {}

bool SignatureGuard::Accepts(std::span<const std::uint8_t> packet) {
  if (!IsSigned(packet)) return false;
  const auto signed_part = packet.first(packet.size() - 6);
  const auto signature = packet.last(6);
  if (!std::ranges::equal(signature, MakeSignature(key_, signed_part))) return false;
  const auto tail = signed_part.last(kTailLength);
  std::uint64_t stamp = 0;
  for (unsigned i = 0; i < 6; ++i) stamp |= std::uint64_t{tail[1 + i]} << (8 * i);
  const Stream stream{tail[0], packet[5], packet[6]};
  const auto known = newest_of_.find(stream);
  const bool is_fresh = known != newest_of_.end()
                            ? stamp > known->second
                            : stamp + kMinute > newest_ && newest_of_.size() < kMaxStreams;
  if (!is_fresh) return false;
  newest_of_[stream] = stamp;
  newest_ = std::max(newest_, stamp);
  return true;
}

}  // namespace soffit::mavlink
