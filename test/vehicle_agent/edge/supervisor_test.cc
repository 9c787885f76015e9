#include "vehicle_agent/edge/supervisor.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>

namespace soffit {
namespace {

/// The socket on which systemd hears what it supervises.
class Systemd : public ::testing::Test {
 protected:
  Systemd() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  ~Systemd() override {
    close(socket_);
    unlink(path_.c_str());
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
  }
  std::string Hear() const {
    char text[256];
    const auto size = recv(socket_, text, sizeof text, MSG_DONTWAIT);
    return size < 0 ? "" : std::string(text, static_cast<std::size_t>(size));
  }

  std::string path_ = ::testing::TempDir() + "notify_" + std::to_string(getpid());
  int socket_ = socket(AF_UNIX, SOCK_DGRAM, 0);
};

TEST_F(Systemd, HearsThatTheProgramIsReadyAndWhatItDoes) {
  const Supervisor supervisor;
  supervisor.SayReady();
  EXPECT_EQ(Hear(), "READY=1");
  supervisor.SayStatus("holding");
  EXPECT_EQ(Hear(), "STATUS=holding");
}

TEST_F(Systemd, HearsOftenEnoughThatTheProgramLives) {
  setenv("WATCHDOG_USEC", "2000000", 1);
  Supervisor supervisor;
  int heard = 0;
  for (int beat = 1; beat <= 500; ++beat) {  // 10 s
    supervisor.SayAlive({beat * 20'000'000LL, 0});
    if (Hear() == "WATCHDOG=1") ++heard;
  }
  EXPECT_NEAR(heard, 20, 1);
}

TEST_F(Systemd, IsLeftAloneWhenItDoesNotWatch) {
  Supervisor supervisor;
  supervisor.SayAlive({1'000'000'000, 0});
  EXPECT_EQ(Hear(), "");
}

TEST(LogsToJournal, IsNotMisledByAnInheritedVariable) {
  unsetenv("JOURNAL_STREAM");
  EXPECT_FALSE(LogsToJournal());
  setenv("JOURNAL_STREAM", "1:2", 1);
  EXPECT_FALSE(LogsToJournal());
  unsetenv("JOURNAL_STREAM");
}

}  // namespace
}  // namespace soffit
