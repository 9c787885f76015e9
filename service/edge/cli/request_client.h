#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "service/edge/dds/service_topics.h"
#include "shared/dds/participant.h"
#include "shared/dds/reader.h"
#include "shared/dds/writer.h"

namespace soffit {

/// One end of a pair of request and reply topics.
template <class RequestTopic, class ReplyTopic>
class RequestClient {
 public:
  using Request = typename RequestTopic::Value;
  using Reply = typename ReplyTopic::Value;

  explicit RequestClient(const Participant& participant)
      : writer_(participant), reader_(participant, [this](Reply reply) { Take(std::move(reply)); }) {}

  /// Sends `request` with an id of its own, again every second, until the answer is there. An error when no
  /// service is found, or none answers, within `timeout`.
  Result<Reply> Ask(Request request, std::chrono::seconds timeout);

 private:
  void Take(Reply reply) {
    const std::lock_guard lock(mutex_);
    if (!wanted_ || !(reply.id == *wanted_)) return;
    reply_ = std::move(reply);
    changed_.notify_all();
  }

  std::uint32_t sequence_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<RequestId> wanted_;
  std::optional<Reply> reply_;
  Writer<RequestTopic> writer_;
  Reader<ReplyTopic> reader_;
};

using MissionClient = RequestClient<MissionRequestTopic, MissionReplyTopic>;
using SceneClient = RequestClient<SceneQueryTopic, SceneReplyTopic>;
extern template class RequestClient<MissionRequestTopic, MissionReplyTopic>;
extern template class RequestClient<SceneQueryTopic, SceneReplyTopic>;

/// Where the service is: its configuration file (empty: the defaults), and a domain that goes before the
/// file's.
struct LocalDomain {
  std::string config_file;
  int domain_id = -1;  ///< Negative: that of the configuration.
};

/// The options of a command that say where.
void AddLocalDomainOptions(CLI::App& command, LocalDomain& place);

Result<Participant> JoinLocalDomain(const LocalDomain& place);

}  // namespace soffit
