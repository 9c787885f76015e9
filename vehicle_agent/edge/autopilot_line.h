#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/result/result.h"
#include "vehicle_agent/mavlink/codec.h"
#include "vehicle_agent/mavlink/link.h"
#include "vehicle_agent/mavlink/signing.h"

namespace soffit {

/// The link to the autopilot: whole packets, signed and checked when there is a key.
class AutopilotLine {
 public:
  /// @param key_file  64 hexadecimal digits, readable by its owner alone; empty: nothing is signed.
  static Result<AutopilotLine> Open(const std::string& url, const std::string& key_file);

  std::vector<mavlink::Frame> Receive(std::chrono::milliseconds wait) {
    return parser_.Feed(link_->Receive(wait));
  }
  void Send(std::vector<std::uint8_t> packet);

  std::string Url() const { return link_->Url(); }
  bool IsSigned() const { return signer_.has_value(); }
  std::uint64_t refused_packet_count() const { return parser_.refused_packet_count(); }

 private:
  AutopilotLine(std::unique_ptr<mavlink::Link> link, const std::optional<mavlink::SigningKey>& key);

  std::unique_ptr<mavlink::Link> link_;
  mavlink::FrameParser parser_;
  std::optional<mavlink::Signer> signer_;
};

}  // namespace soffit
