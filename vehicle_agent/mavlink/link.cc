#include "vehicle_agent/mavlink/link.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <map>
#include <optional>
#include <thread>
#include <utility>

namespace soffit::mavlink {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kRetryPeriod{1000};

/// A file descriptor that closes itself.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    other.Close();
    return *this;
  }
  ~Descriptor() { Close(); }

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }
  void Close() {
    if (number_ >= 0) ::close(std::exchange(number_, -1));
  }

 private:
  int number_ = -1;
};

struct Address {
  sockaddr_storage bytes{};
  socklen_t length = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&bytes); }
  bool operator==(const Address& other) const {
    return length == other.length && std::memcmp(&bytes, &other.bytes, length) == 0;
  }
};

struct Endpoint {
  std::string host;
  std::uint16_t port = 0;
};

Error BadUrl(const std::string& url, const std::string& problem) {
  return InvalidInput("MAVLink link '" + url + "': " + problem);
}

std::string LastError() { return std::strerror(errno); }

bool IsTemporary(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

/// Waits until the descriptor is ready for `events`; false on timeout.
bool WaitFor(int descriptor, short events, milliseconds timeout) {
  pollfd request{descriptor, events, 0};
  return ::poll(&request, 1, static_cast<int>(timeout.count())) > 0;
}

/// Everything that can be read without waiting; none when the other side is gone.
std::optional<std::vector<std::uint8_t>> ReadAvailable(int descriptor) {
  constexpr std::size_t kMostAtOnce = 1 << 18;
  std::vector<std::uint8_t> bytes;
  std::array<std::uint8_t, 4096> chunk{};
  while (bytes.size() < kMostAtOnce) {
    const ssize_t count = ::read(descriptor, chunk.data(), chunk.size());
    if (count > 0) {
      bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + count);
    } else if (count < 0 && IsTemporary(errno)) {
      break;
    } else {
      if (bytes.empty()) return std::nullopt;
      break;
    }
  }
  return bytes;
}

Result<std::uint16_t> ParsePort(const std::string& url, std::string_view text) {
  unsigned port = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (problem != std::errc() || end != text.data() + text.size() || port > 65535) {
    return BadUrl(url, "'" + std::string(text) + "' is not a port from 0 to 65535");
  }
  return static_cast<std::uint16_t>(port);
}

Result<Address> Resolve(const std::string& url, const Endpoint& endpoint, int socket_type) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = socket_type;
  addrinfo* found = nullptr;
  const int problem =
      ::getaddrinfo(endpoint.host.c_str(), std::to_string(endpoint.port).c_str(), &hints, &found);
  if (problem != 0) return BadUrl(url, "host '" + endpoint.host + "': " + ::gai_strerror(problem));
  Address address;
  std::memcpy(&address.bytes, found->ai_addr, found->ai_addrlen);
  address.length = found->ai_addrlen;
  ::freeaddrinfo(found);
  return address;
}

Descriptor OpenSocket(int type) {
  return Descriptor(::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
}

Result<Descriptor> OpenBoundSocket(const std::string& url, const Endpoint& endpoint, int type) {
  auto address = Resolve(url, endpoint, type);
  if (!address.ok()) return address.error();
  Descriptor socket = OpenSocket(type);
  const int yes = 1;
  if (type == SOCK_STREAM) ::setsockopt(socket.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (!socket.is_open() || ::bind(socket.number(), address.value().get(), address.value().length) != 0) {
    return BadUrl(url, LastError());
  }
  return socket;
}

std::string BoundUrl(const char* scheme, const std::string& host, int socket) {
  sockaddr_in address{};
  socklen_t length = sizeof address;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &length);
  return std::string(scheme) + ":" + host + ":" + std::to_string(ntohs(address.sin_port));
}

class UdpLink : public Link {
 public:
  /// @param peer  The other side; none: whoever sends.
  UdpLink(Descriptor socket, std::string url, const std::optional<Address>& peer)
      : socket_(std::move(socket)), url_(std::move(url)), answers_senders_(!peer) {
    if (peer) peers_.push_back({*peer, {}});
  }

  void Send(std::span<const std::uint8_t> bytes) override {
    if (answers_senders_) {
      const auto is_gone = [now = Clock::now()](const Peer& peer) { return now - peer.heard > kPeerLife; };
      std::erase_if(peers_, is_gone);
    }
    for (const Peer& peer : peers_) {
      // What cannot be sent is lost; a peer that is not there (ECONNREFUSED) may come later.
      [[maybe_unused]] const ssize_t sent = ::sendto(socket_.number(), bytes.data(), bytes.size(),
                                                     MSG_NOSIGNAL, peer.address.get(), peer.address.length);
    }
  }

  std::vector<std::uint8_t> Receive(milliseconds timeout) override {
    constexpr int kMostDatagrams = 256;
    std::vector<std::uint8_t> bytes;
    if (!WaitFor(socket_.number(), POLLIN, timeout)) return bytes;
    std::array<std::uint8_t, 65536> datagram{};
    for (int i = 0; i < kMostDatagrams; ++i) {
      Address sender;
      sender.length = sizeof sender.bytes;
      const ssize_t count = ::recvfrom(socket_.number(), datagram.data(), datagram.size(), 0,
                                       reinterpret_cast<sockaddr*>(&sender.bytes), &sender.length);
      if (count < 0 && errno == ECONNREFUSED) continue;  // The answer to something sent earlier.
      if (count < 0) break;
      if (answers_senders_) NotePeer(sender);
      has_received_ = true;
      bytes.insert(bytes.end(), datagram.begin(), datagram.begin() + count);
    }
    return bytes;
  }

  bool IsConnected() const override { return has_received_; }
  std::string Url() const override { return url_; }

 private:
  struct Peer {
    Address address;
    Clock::time_point heard;
  };
  static constexpr std::chrono::seconds kPeerLife{10};
  static constexpr std::size_t kMostPeers = 4;

  /// The newest come last; of too many, the one that was silent for longest is forgotten.
  void NotePeer(const Address& sender) {
    std::erase_if(peers_, [&](const Peer& peer) { return peer.address == sender; });
    peers_.push_back({sender, Clock::now()});
    if (peers_.size() > kMostPeers) peers_.erase(peers_.begin());
  }

  Descriptor socket_;
  std::string url_;
  bool answers_senders_;
  std::vector<Peer> peers_;
  bool has_received_ = false;
};

/// A stream of bytes whose descriptor comes and goes.
class StreamLink : public Link {
 public:
  explicit StreamLink(std::string url) : url_(std::move(url)) {}

  void Send(std::span<const std::uint8_t> bytes) override {
    Reopen();
    if (!IsConnected()) return;
    // A packet that does not fit as a whole is finished from here before the next one is begun.
    if (unsent_.size() < kMostUnsent) unsent_.insert(unsent_.end(), bytes.begin(), bytes.end());
    Flush();
  }

  std::vector<std::uint8_t> Receive(milliseconds timeout) override {
    Reopen();
    if (IsConnected()) Flush();
    const int waits_on = WaitDescriptor();
    if (waits_on < 0) {
      std::this_thread::sleep_for(timeout);
      return {};
    }
    const bool is_ready = WaitFor(waits_on, WaitEvents(), timeout);
    Reopen();
    if (!is_ready || !IsConnected()) return {};
    auto bytes = ReadAvailable(stream_.number());
    if (!bytes) Drop();
    return bytes.value_or(std::vector<std::uint8_t>{});
  }

  bool IsConnected() const override { return stream_.is_open(); }
  std::string Url() const override { return url_; }

 protected:
  /// Moves on towards an open `stream_`, without waiting.
  virtual void Reopen() = 0;
  /// What to wait on: the stream, or what it will come from; negative when there is nothing yet.
  virtual int WaitDescriptor() const { return stream_.number(); }
  virtual short WaitEvents() const { return POLLIN; }

  bool IsTimeToRetry() {
    const auto now = Clock::now();
    if (now < next_try_) return false;
    next_try_ = now + kRetryPeriod;
    return true;
  }

  void Drop() {
    stream_.Close();
    unsent_.clear();
  }

  Descriptor stream_;
  std::string url_;

 private:
  static constexpr std::size_t kMostUnsent = 4096;

  void Flush() {
    while (!unsent_.empty()) {
      const ssize_t count = ::write(stream_.number(), unsent_.data(), unsent_.size());
      if (count > 0) {
        unsent_.erase(unsent_.begin(), unsent_.begin() + count);
      } else {
        if (count < 0 && !IsTemporary(errno)) Drop();
        return;
      }
    }
  }

  std::vector<std::uint8_t> unsent_;
  Clock::time_point next_try_{};
};

/// Sends every packet at once and reports a closed connection as an error, not as a signal.
void PrepareTcp(int socket) {
  const int yes = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  ::setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &yes, sizeof yes);
}

class TcpClientLink : public StreamLink {
 public:
  TcpClientLink(std::string url, Address server) : StreamLink(std::move(url)), server_(server) {}

 protected:
  void Reopen() override {
    if (stream_.is_open()) return;
    if (!connecting_.is_open() && IsTimeToRetry()) {
      connecting_ = OpenSocket(SOCK_STREAM);
      PrepareTcp(connecting_.number());
      const int status = ::connect(connecting_.number(), server_.get(), server_.length);
      if (status != 0 && errno != EINPROGRESS) connecting_.Close();
    }
    if (!connecting_.is_open() || !WaitFor(connecting_.number(), POLLOUT, milliseconds(0))) return;
    int problem = 0;
    socklen_t length = sizeof problem;
    ::getsockopt(connecting_.number(), SOL_SOCKET, SO_ERROR, &problem, &length);
    if (problem == 0) {
      stream_ = std::move(connecting_);
    } else {
      connecting_.Close();
    }
  }
  int WaitDescriptor() const override { return stream_.is_open() ? stream_.number() : connecting_.number(); }
  short WaitEvents() const override { return stream_.is_open() ? POLLIN : POLLOUT; }

 private:
  Address server_;
  Descriptor connecting_;
};

class TcpServerLink : public StreamLink {
 public:
  TcpServerLink(std::string url, Descriptor listener)
      : StreamLink(std::move(url)), listener_(std::move(listener)) {}

 protected:
  void Reopen() override {
    Descriptor client(::accept4(listener_.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!client.is_open()) return;
    Drop();
    PrepareTcp(client.number());
    stream_ = std::move(client);
  }
  int WaitDescriptor() const override { return stream_.is_open() ? stream_.number() : listener_.number(); }

 private:
  Descriptor listener_;
};

class SerialLink : public StreamLink {
 public:
  SerialLink(std::string url, std::string device, speed_t speed)
      : StreamLink(std::move(url)), device_(std::move(device)), speed_(speed) {}

 protected:
  void Reopen() override {
    if (stream_.is_open() || !IsTimeToRetry()) return;
    Descriptor device(::open(device_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    termios settings{};
    if (!device.is_open() || ::tcgetattr(device.number(), &settings) != 0) return;
    ::cfmakeraw(&settings);
    settings.c_cflag |= CLOCAL | CREAD;
    settings.c_cflag &= static_cast<tcflag_t>(~(CSTOPB | CRTSCTS));
    settings.c_cc[VMIN] = 1;  // Nothing there is EAGAIN, so that 0 means that the cable is out.
    settings.c_cc[VTIME] = 0;
    ::cfsetispeed(&settings, speed_);
    ::cfsetospeed(&settings, speed_);
    if (::tcsetattr(device.number(), TCSANOW, &settings) == 0) stream_ = std::move(device);
  }

 private:
  std::string device_;
  speed_t speed_;
};

const std::map<std::string, speed_t, std::less<>> kBaudRates = {
    {"9600", B9600},     {"19200", B19200},     {"38400", B38400},     {"57600", B57600},
    {"115200", B115200}, {"230400", B230400},   {"460800", B460800},   {"500000", B500000},
    {"921600", B921600}, {"1000000", B1000000}, {"1500000", B1500000}, {"2000000", B2000000}};

Result<std::unique_ptr<Link>> OpenSerial(const std::string& url, const std::string& device,
                                         const std::string& baud) {
  const auto rate = kBaudRates.find(baud);
  if (rate == kBaudRates.end()) {
    return BadUrl(url, "'" + baud + "' is not a baud rate; use 57600, 115200, 921600 or another usual one");
  }
  return std::unique_ptr<Link>(std::make_unique<SerialLink>(url, device, rate->second));
}

Result<std::unique_ptr<Link>> OpenUdpIn(const std::string& url, const Endpoint& endpoint) {
  auto socket = OpenBoundSocket(url, endpoint, SOCK_DGRAM);
  if (!socket.ok()) return socket.error();
  const std::string bound = BoundUrl("udpin", endpoint.host, socket.value().number());
  return std::unique_ptr<Link>(std::make_unique<UdpLink>(std::move(socket).value(), bound, std::nullopt));
}

Result<std::unique_ptr<Link>> OpenUdpOut(const std::string& url, const Endpoint& endpoint) {
  auto address = Resolve(url, endpoint, SOCK_DGRAM);
  if (!address.ok()) return address.error();
  Descriptor socket = OpenSocket(SOCK_DGRAM);
  if (!socket.is_open()) return BadUrl(url, LastError());
  return std::unique_ptr<Link>(std::make_unique<UdpLink>(std::move(socket), url, address.value()));
}

Result<std::unique_ptr<Link>> OpenTcp(const std::string& url, const Endpoint& endpoint) {
  auto address = Resolve(url, endpoint, SOCK_STREAM);
  if (!address.ok()) return address.error();
  return std::unique_ptr<Link>(std::make_unique<TcpClientLink>(url, address.value()));
}

Result<std::unique_ptr<Link>> OpenTcpIn(const std::string& url, const Endpoint& endpoint) {
  auto socket = OpenBoundSocket(url, endpoint, SOCK_STREAM);
  if (!socket.ok()) return socket.error();
  if (::listen(socket.value().number(), 1) != 0) return BadUrl(url, LastError());
  const std::string bound = BoundUrl("tcpin", endpoint.host, socket.value().number());
  return std::unique_ptr<Link>(std::make_unique<TcpServerLink>(bound, std::move(socket).value()));
}

}  // namespace

Result<std::unique_ptr<Link>> OpenLink(const std::string& url) {
  const std::size_t first = url.find(':');
  const std::size_t last = url.rfind(':');
  if (first == std::string::npos || last == first || last == first + 1 || last + 1 == url.size()) {
    return BadUrl(url, "write SCHEME:HOST:PORT or serial:DEVICE:BAUD");
  }
  const std::string scheme = url.substr(0, first);
  const std::string middle = url.substr(first + 1, last - first - 1);
  const std::string end = url.substr(last + 1);
  if (scheme == "serial") return OpenSerial(url, middle, end);

  const auto port = ParsePort(url, end);
  if (!port.ok()) return port.error();
  const Endpoint endpoint{middle, port.value()};
  if (scheme == "udpin") return OpenUdpIn(url, endpoint);
  if (scheme == "tcpin") return OpenTcpIn(url, endpoint);
  if (port.value() == 0) return BadUrl(url, "port 0 is only for udpin and tcpin");
  if (scheme == "udpout") return OpenUdpOut(url, endpoint);
  if (scheme == "tcp") return OpenTcp(url, endpoint);
  return BadUrl(url, "'" + scheme + "' is none of udpin, udpout, tcp, tcpin, serial");
}

}  // namespace soffit::mavlink
