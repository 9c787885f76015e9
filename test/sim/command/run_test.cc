/// The program itself: started, talked to on its sockets, stopped by a signal.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <httplib.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "test/sim/camera/http_port.h"
#include "vehicle_agent/mavlink/codec.h"
#include "vehicle_agent/mavlink/constants.h"
#include "vehicle_agent/mavlink/link.h"

namespace soffit::sim {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr char kWorld[] = R"(
camera: {width_px: 64, height_px: 48, fx_px: 40}
vehicle: {radius_m: 0.35, height_m: 0.30, safety_margin_m: 0.25}
mission: {wanted: [arch], area_center: [0, 5]}
buildings:
  - id: arch
    position: [0, 5]
    color: yellow
    parts:
      - {box: {center: [-1.5, 0], size: [1, 2]}, z: [0, 2]}
      - {box: {center: [1.5, 0], size: [1, 2]}, z: [0, 2]}
      - {box: {center: [0, 0], size: [4, 2]}, z: [2, 3]}
)";

class RunTest : public ::testing::Test {
 protected:
  RunTest() {
    std::string pattern = (std::filesystem::temp_directory_path() / "soffit-sim-test-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    std::ofstream(folder_ / "world.yaml") << kWorld;
    link_ = std::move(mavlink::OpenLink("udpin:127.0.0.1:0")).value();
  }
  ~RunTest() override {
    Stop(SIGKILL);
    std::filesystem::remove_all(folder_);
  }

  /// Starts `soffit-sim run` and gives the line that it prints when it is ready; empty when it ends before.
  std::string Start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {SOFFIT_SIM, "run", (folder_ / "world.yaml").string(), "--out",
                                         (folder_ / "out").string(), "--quick-start"});
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    int pipe_ends[2];
    if (::pipe(pipe_ends) != 0) return "";
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(pipe_ends[1], STDOUT_FILENO);
      ::dup2(::open((folder_ / "log").c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), STDERR_FILENO);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    ::close(pipe_ends[1]);
    std::string line;
    for (char letter = 0; ::read(pipe_ends[0], &letter, 1) == 1 && letter != '\n';) line += letter;
    ::close(pipe_ends[0]);
    return line;
  }

  std::string MavlinkUrl() const {
    return "udpout:127.0.0.1:" + link_->Url().substr(link_->Url().rfind(':') + 1);
  }

  /// Sends the signal and gives the exit code.
  int Stop(int signal) {
    if (process_ <= 0) return -1;
    int status = 0;
    ::kill(process_, signal);
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// Listens for up to 20 s.
  template <class Message>
  std::optional<Message> Hear() {
    for (int i = 0; i < 200; ++i) {
      for (const mavlink::Frame& frame : parser_.Feed(link_->Receive(milliseconds(100)))) {
        if (auto message = mavlink::Decode<Message>(frame)) return message;
      }
    }
    return std::nullopt;
  }

  std::string Read(const std::string& file) const {
    std::ifstream stream(folder_ / file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  std::filesystem::path folder_;
  std::unique_ptr<mavlink::Link> link_;
  mavlink::FrameParser parser_;
  pid_t process_ = -1;
};

TEST_F(RunTest, SpeaksMavlinkTakesDisturbancesAndLeavesTheTruthBehind) {
  const json ready = json::parse(Start({"--mavlink", MavlinkUrl()}));
  EXPECT_GT(ready["camera_port"], 0);
  ASSERT_TRUE(Hear<mavlink::Heartbeat>().has_value());

  httplib::Client control("127.0.0.1", ready["control_port"].get<int>());
  EXPECT_EQ(control.Post("/disturb", "pilot LOITER\n", "text/plain")->status, 200);
  EXPECT_EQ(control.Post("/disturb", "camera 0.5 0", "text/plain")->status, 200);
  const auto refused = control.Post("/disturb", "fly away", "text/plain");
  EXPECT_EQ(refused->status, 400);
  EXPECT_THAT(refused->body, HasSubstr("none of"));
  const json now = json::parse(control.Get("/truth")->body);
  EXPECT_EQ(now["state"]["mode"], "LOITER");
  EXPECT_FALSE(now["finished"]);

  EXPECT_EQ(Stop(SIGTERM), 0);
  const json truth = json::parse(Read("out/truth.json"));
  EXPECT_TRUE(truth["finished"]);
  EXPECT_EQ(truth["truth"]["expected"], "flown");
  EXPECT_TRUE(truth["contacts"].empty());
  EXPECT_THAT(Read("out/track.csv"), HasSubstr("LOITER"));
}

TEST_F(RunTest, IsSilentWhileTheLinkIsOff) {
  const json ready = json::parse(Start({"--mavlink", MavlinkUrl()}));
  ASSERT_TRUE(Hear<mavlink::Heartbeat>().has_value());
  httplib::Client control("127.0.0.1", ready["control_port"].get<int>());
  EXPECT_EQ(control.Post("/disturb", "link off 1000", "text/plain")->status, 200);
  link_->Receive(milliseconds(0));
  EXPECT_TRUE(link_->Receive(milliseconds(1500)).empty());
}

TEST_F(RunTest, SaysWhatIsWrongAndEnds) {
  EXPECT_EQ(Start({"--mavlink", "pigeon:127.0.0.1:1"}), "");
  EXPECT_EQ(Stop(0), 1);
  EXPECT_THAT(Read("log"), HasSubstr("pigeon"));
  httplib::Server other;
  const std::string taken = std::to_string(BindAlone(other, 0));
  for (const char* port : {"--camera-port", "--control-port"}) {
    EXPECT_EQ(Start({"--mavlink", MavlinkUrl(), port, taken}), "");
    EXPECT_EQ(Stop(0), 1);
    EXPECT_THAT(Read("log"), HasSubstr(taken));
  }
  EXPECT_EQ(Start({"--autopilot", "none", "--mavlink", "tcp:127.0.0.1:9", "--mavlink", "tcp:127.0.0.1:10"}),
            "");
  EXPECT_EQ(Stop(0), 1);
  EXPECT_THAT(Read("log"), HasSubstr("one --mavlink link"));
  std::ofstream(folder_ / "world.yaml") << "buildings: [{id: 5, wings: 2}]\n";
  EXPECT_EQ(Start({"--mavlink", MavlinkUrl()}), "");
  EXPECT_EQ(Stop(0), 1);
  EXPECT_THAT(Read("log"), HasSubstr("line 1"));
}

}  // namespace
}  // namespace soffit::sim
