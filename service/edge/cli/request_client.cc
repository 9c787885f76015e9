#include "service/edge/cli/request_client.h"

#include <iostream>
#include <random>

#include "service/edge/live/service_options.h"
#include "shared/options/yaml.h"

namespace soffit {
namespace {

std::array<std::uint8_t, 16> DrawClientId() {
  std::random_device random;
  std::array<std::uint8_t, 16> id{};
  for (std::uint8_t& byte : id) byte = static_cast<std::uint8_t>(random());
  return id;
}

}  // namespace

template <class RequestTopic, class ReplyTopic>
Result<typename ReplyTopic::Value> RequestClient<RequestTopic, ReplyTopic>::Ask(
    Request request, std::chrono::seconds timeout) {
  using std::chrono::milliseconds;
  const auto end = std::chrono::steady_clock::now() + timeout;
  request.id = {DrawClientId(), ++sequence_};
  if (!writer_.WaitForReader(timeout) || !reader_.WaitForWriter(timeout)) {
    return Error{Error::Code::kUnavailable,
                 "no soffitd is found on the local domain: is it running, with the same domain_id?"};
  }
  std::unique_lock lock(mutex_);
  wanted_ = request.id;
  reply_.reset();
  while (!reply_ && std::chrono::steady_clock::now() < end) {
    lock.unlock();
    writer_.Write(request);
    lock.lock();
    changed_.wait_for(lock, milliseconds(1000), [this] { return reply_.has_value(); });
  }
  if (!reply_) return Error{Error::Code::kUnavailable, "soffitd does not answer"};
  return *reply_;
}

template class RequestClient<MissionRequestTopic, MissionReplyTopic>;
template class RequestClient<SceneQueryTopic, SceneReplyTopic>;

void AddLocalDomainOptions(CLI::App& command, LocalDomain& place) {
  command.add_option("--config", place.config_file, "The configuration of soffitd, for its local domain");
  command.add_option("--domain", place.domain_id, "Its local domain, before that of the configuration");
}

Result<Participant> JoinLocalDomain(const LocalDomain& place) {
  ServiceOptions options;
  if (!place.config_file.empty()) {
    const auto read = ReadOptionsFile<ServiceOptions>(place.config_file);
    if (!read.ok()) return read.error();
    options = read.value();
  }
  if (place.domain_id >= 0) options.local.domain_id = place.domain_id;
  return Participant::Join("soffit", options.local,
                           [](const std::string& problem) { std::cerr << "soffit: " << problem << '\n'; });
}

}  // namespace soffit
