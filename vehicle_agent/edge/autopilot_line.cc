#include "vehicle_agent/edge/autopilot_line.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace soffit {
namespace {

constexpr std::uint8_t kLinkId = 1;

std::int64_t NowUtc_ns() {
  using namespace std::chrono;
  return duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count();
}

Result<mavlink::SigningKey> ReadKey(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code problem;
  const fs::perms perms = fs::status(path, problem).permissions();
  if (!problem && (perms & (fs::perms::group_all | fs::perms::others_all)) != fs::perms::none) {
    return InvalidInput(path + ": must be readable by its owner alone (chmod 600)");
  }
  std::ifstream file(path);
  if (!file) return InvalidInput(path + ": the signing key cannot be read");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  Result<mavlink::SigningKey> key = mavlink::ParseSigningKey(text);
  if (!key.ok()) return InvalidInput(path + ": " + key.error().message);
  return key;
}

std::optional<mavlink::SignatureGuard> MakeGuard(const std::optional<mavlink::SigningKey>& key) {
  if (!key) return std::nullopt;
  return mavlink::SignatureGuard(*key, NowUtc_ns());
}

}  // namespace

Result<AutopilotLine> AutopilotLine::Open(const std::string& url, const std::string& key_file) {
  std::optional<mavlink::SigningKey> key;
  if (!key_file.empty()) {
    const Result<mavlink::SigningKey> read = ReadKey(key_file);
    if (!read.ok()) return read.error();
    key = read.value();
  }
  Result<std::unique_ptr<mavlink::Link>> link = mavlink::OpenLink(url);
  if (!link.ok()) return link.error();
  return AutopilotLine(std::move(link).value(), key);
}

AutopilotLine::AutopilotLine(std::unique_ptr<mavlink::Link> link,
                             const std::optional<mavlink::SigningKey>& key)
    : link_(std::move(link)), parser_(MakeGuard(key)) {
  if (key) signer_.emplace(*key, kLinkId);
}

void AutopilotLine::Send(std::vector<std::uint8_t> packet) {
  if (signer_) signer_->Sign(packet, NowUtc_ns());
  link_->Send(packet);
}

}  // namespace soffit
