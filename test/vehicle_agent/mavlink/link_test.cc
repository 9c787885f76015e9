#include "vehicle_agent/mavlink/link.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <stdlib.h>
#include <unistd.h>

#include <string>

namespace soffit::mavlink {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

const Bytes kHello = {'h', 'e', 'l', 'l', 'o'};
const Bytes kWorld = {'w', 'o', 'r', 'l', 'd'};

std::unique_ptr<Link> Open(const std::string& url) {
  auto link = OpenLink(url);
  if (!link.ok()) throw std::runtime_error(link.error().message);
  return std::move(link).value();
}

std::string PortOf(const Link& link) { return link.Url().substr(link.Url().rfind(':') + 1); }

/// What arrives within two seconds, while `other` is kept going.
Bytes ReceiveSoon(Link& link, Link* other = nullptr) {
  for (int i = 0; i < 200; ++i) {
    if (other != nullptr) other->Receive(milliseconds(0));
    Bytes bytes = link.Receive(milliseconds(10));
    if (!bytes.empty()) return bytes;
  }
  return {};
}

void WaitUntilConnected(Link& link, Link& other) {
  for (int i = 0; i < 300 && !(link.IsConnected() && other.IsConnected()); ++i) {
    link.Receive(milliseconds(5));
    other.Receive(milliseconds(5));
  }
}

TEST(OpenLink, TellsWhatIsWrongWithAUrl) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "SCHEME:HOST:PORT"},
      {"udpin", "SCHEME:HOST:PORT"},
      {"udpin::14550", "SCHEME:HOST:PORT"},
      {"udpin:0.0.0.0:", "SCHEME:HOST:PORT"},
      {"udpin:0.0.0.0:x", "not a port"},
      {"udpin:0.0.0.0:70000", "not a port"},
      {"udpin:0.0.0.0:-1", "not a port"},
      {"udpout:127.0.0.1:0", "port 0"},
      {"quic:127.0.0.1:1", "none of"},
      {"udpout:no.such.host.invalid:14550", "no.such.host.invalid"},
      {"serial:/dev/ttyACM0:12345", "baud"},
  };
  for (const auto& [url, expected] : cases) {
    const auto link = OpenLink(url);
    ASSERT_FALSE(link.ok()) << url;
    EXPECT_THAT(link.error().message, HasSubstr(expected)) << url;
    EXPECT_THAT(link.error().message, HasSubstr(std::string("'") + url + "'"));
  }
}

TEST(OpenLink, TellsThatAPortIsTaken) {
  const auto first = Open("udpin:127.0.0.1:0");
  const auto second = OpenLink("udpin:127.0.0.1:" + PortOf(*first));
  ASSERT_FALSE(second.ok());
  EXPECT_THAT(second.error().message, HasSubstr("in use"));
}

TEST(UdpLink, IsNotTakenFromTheAutopilotByAnotherStationThatSends) {
  const auto server = Open("udpin:127.0.0.1:0");
  const auto autopilot = Open("udpout:127.0.0.1:" + PortOf(*server));
  const auto other = Open("udpout:127.0.0.1:" + PortOf(*server));
  autopilot->Send(kHello);
  EXPECT_EQ(ReceiveSoon(*server), kHello);
  other->Send(kHello);
  EXPECT_EQ(ReceiveSoon(*server), kHello);
  server->Send(kWorld);
  EXPECT_EQ(ReceiveSoon(*autopilot), kWorld);
  EXPECT_EQ(ReceiveSoon(*other), kWorld);
}

TEST(UdpLink, TalksInBothDirections) {
  const auto server = Open("udpin:127.0.0.1:0");
  const auto client = Open("udpout:127.0.0.1:" + PortOf(*server));
  EXPECT_FALSE(server->IsConnected());
  server->Send(kWorld);  // To nobody yet.
  client->Send(kHello);
  EXPECT_EQ(ReceiveSoon(*server), kHello);
  server->Send(kWorld);
  EXPECT_EQ(ReceiveSoon(*client), kWorld);
  EXPECT_TRUE(client->IsConnected());
}

TEST(UdpLink, GoesOnWhenThePeerComesLater) {
  auto server = Open("udpin:127.0.0.1:0");
  const std::string port = PortOf(*server);
  server.reset();
  const auto client = Open("udpout:127.0.0.1:" + port);
  client->Send(kHello);
  EXPECT_THAT(client->Receive(milliseconds(20)), IsEmpty());
  server = Open("udpin:127.0.0.1:" + port);
  client->Send(kHello);
  EXPECT_EQ(ReceiveSoon(*server), kHello);
}

TEST(TcpLink, TalksInBothDirections) {
  const auto server = Open("tcpin:127.0.0.1:0");
  const auto client = Open("tcp:127.0.0.1:" + PortOf(*server));
  WaitUntilConnected(*client, *server);
  client->Send(kHello);
  EXPECT_EQ(ReceiveSoon(*server), kHello);
  server->Send(kWorld);
  EXPECT_EQ(ReceiveSoon(*client), kWorld);
}

TEST(TcpLink, ConnectsAgainAfterTheServerWentAway) {
  auto server = Open("tcpin:127.0.0.1:0");
  const std::string port = PortOf(*server);
  const auto client = Open("tcp:127.0.0.1:" + port);
  WaitUntilConnected(*client, *server);
  ASSERT_TRUE(client->IsConnected());
  server.reset();
  for (int i = 0; i < 100 && client->IsConnected(); ++i) client->Receive(milliseconds(5));
  EXPECT_FALSE(client->IsConnected());
  client->Send(kHello);  // Lost, without a signal or an exception.
  server = Open("tcpin:127.0.0.1:" + port);
  WaitUntilConnected(*client, *server);
  client->Send(kHello);
  EXPECT_EQ(ReceiveSoon(*server), kHello);
}

TEST(TcpLink, TakesANewClientInPlaceOfTheOldOne) {
  const auto server = Open("tcpin:127.0.0.1:0");
  const auto first = Open("tcp:127.0.0.1:" + PortOf(*server));
  WaitUntilConnected(*first, *server);
  const auto second = Open("tcp:127.0.0.1:" + PortOf(*server));
  WaitUntilConnected(*second, *server);
  second->Send(kHello);
  EXPECT_EQ(ReceiveSoon(*server), kHello);
}

TEST(SerialLink, TalksThroughATerminalAndOutlivesIt) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_GE(master, 0);
  ASSERT_EQ(::grantpt(master), 0);
  ASSERT_EQ(::unlockpt(master), 0);
  const auto link = Open(std::string("serial:") + ::ptsname(master) + ":921600");
  link->Receive(milliseconds(1));
  ASSERT_TRUE(link->IsConnected());
  ASSERT_EQ(::write(master, kHello.data(), kHello.size()), 5);
  EXPECT_EQ(ReceiveSoon(*link), kHello);

  link->Send({{0x0a, 0x0d, 0x11, 0x13, 0xfd}});  // Nothing is translated or swallowed.
  Bytes read(16);
  ASSERT_EQ(::read(master, read.data(), read.size()), 5);
  EXPECT_EQ(read[0], 0x0a);
  EXPECT_EQ(read[4], 0xfd);

  ::close(master);  // The cable is out.
  for (int i = 0; i < 20 && link->IsConnected(); ++i) link->Receive(milliseconds(5));
  EXPECT_FALSE(link->IsConnected());
  link->Send(kHello);
}

TEST(SerialLink, WaitsForADeviceThatIsNotThere) {
  const auto link = Open("serial:/dev/no_such_tty:57600");
  EXPECT_THAT(link->Receive(milliseconds(1)), IsEmpty());
  EXPECT_FALSE(link->IsConnected());
}

}  // namespace
}  // namespace soffit::mavlink
