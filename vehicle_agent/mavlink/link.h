#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "shared/result/result.h"

namespace soffit::mavlink {

/// A way to the other side: bytes out, bytes in, never blocking for longer than it is told to.
///
/// A link that loses its other side (cable, server, radio) opens itself again, trying at most once a second;
/// until then what is sent is lost and nothing is received. It does not throw once it is open. For one
/// thread.
class Link {
 public:
  virtual ~Link() = default;

  /// Sends what can be sent at once; the rest is lost, as on a radio.
  virtual void Send(std::span<const std::uint8_t> bytes) = 0;

  /// What has arrived, waiting for up to `timeout` for something to arrive. Empty when nothing did.
  virtual std::vector<std::uint8_t> Receive(std::chrono::milliseconds timeout) = 0;

  /// Whether there is another side, as far as the link can tell (UDP: whether something ever arrived from
  /// it).
  virtual bool IsConnected() const = 0;

  /// The link's URL, with the port that the system chose where 0 was asked for.
  virtual std::string Url() const = 0;
};

/// Opens a link from its URL:
///
///     udpin:0.0.0.0:14550           waits for datagrams, sends to all who sent in the last ten seconds
///     udpout:192.168.1.10:14550     sends datagrams there and takes the answers
///     tcp:192.168.1.10:5760         connects as a client
///     tcpin:127.0.0.1:5760          waits for one client; a new one takes the place of the old one
///     serial:/dev/ttyACM0:921600    8N1, without flow control
///
/// Port 0 means a free port (udpin, tcpin). A peer that is not there yet (tcp, serial) is no error. An error
/// names the URL and what is wrong with it: an unknown scheme, a port out of range, a host that does not
/// resolve, a port in use.
Result<std::unique_ptr<Link>> OpenLink(const std::string& url);

}  // namespace soffit::mavlink
