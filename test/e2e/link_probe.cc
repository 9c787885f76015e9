// Commands looks over a link and measures it: how long a picture takes, and what becomes of commands
// meanwhile.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "test/support/commander.h"
#include "vehicle_agent/camera/jpeg.h"

namespace soffit {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kMissionId = 1;
constexpr std::chrono::milliseconds kPatience(200);
constexpr std::uint32_t kFirstPing = 1'000'000;  // Far out of order: refused, and answered like any other.

double SecondsSince(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

/// Sends commands that the agent refuses, one every 50 ms, and measures how long it takes until the answer is
/// there.
class Pinger {
 public:
  explicit Pinger(const Participant& radio)
      : commands_(radio),
        acks_(radio, [this](const CommandAck& ack) { Note(ack); }),
        thread_([this] { Work(); }) {}
  ~Pinger() { Stop(); }
  void Stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }

  /// [until the agent answered, until the answer was here] of each in order of sending; nulls: never
  /// answered. From the first that was answered: before, the agent may not know yet who listens.
  nlohmann::json Describe() {
    const std::lock_guard lock(mutex_);
    nlohmann::json all = nlohmann::json::array();
    for (const auto& [sequence, trip] : trips_) {
      const bool is_answered = trip.answered_utc_ns != 0;
      if (!is_answered && all.empty()) continue;
      all.push_back(is_answered ? nlohmann::json{ToSeconds(trip.answered_utc_ns - trip.sent_utc_ns),
                                                 ToSeconds(trip.back_utc_ns - trip.sent_utc_ns)}
                                : nlohmann::json{nullptr, nullptr});
    }
    return all;
  }

 private:
  void Work() {
    std::uint32_t sequence = kFirstPing;
    while (!stop_ && !(commands_.WaitForReader(kPatience) && acks_.WaitForWriter(kPatience))) {
    }
    while (!stop_) {
      FlightCommand command;
      command.vehicle_id = 1;
      command.mission_id = kMissionId;
      command.sequence = ++sequence;
      command.kind = CommandKind::kGoTo;
      {
        const std::lock_guard lock(mutex_);
        trips_[sequence].sent_utc_ns = Commander::NowUtc_ns();
      }
      commands_.Write(command);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  void Note(const CommandAck& ack) {
    const std::lock_guard lock(mutex_);
    const auto trip = trips_.find(ack.sequence);
    if (trip == trips_.end() || trip->second.answered_utc_ns != 0) return;
    trip->second.answered_utc_ns = ack.stamp_utc_ns;
    trip->second.back_utc_ns = Commander::NowUtc_ns();
  }

  struct Trip {
    std::int64_t sent_utc_ns = 0;
    std::int64_t answered_utc_ns = 0;
    std::int64_t back_utc_ns = 0;
  };
  std::mutex mutex_;
  std::map<std::uint32_t, Trip> trips_;
  Writer<FlightCommandTopic> commands_;
  Reader<CommandAckTopic> acks_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

FlightCommand MakeLook(std::uint32_t capture_id) {
  FlightCommand look;
  look.kind = CommandKind::kLook;
  look.path_in_map_m = {{0.0, 0.0, 4.0}};
  look.speed_mps = 1.0;
  look.camera_pitch_rad = capture_id % 2 == 0 ? 0.0 : -std::numbers::pi / 2.0;
  look.purpose = Purpose::kTop;
  look.capture_id = capture_id;
  return look;
}

nlohmann::json Describe(const std::optional<CommandAck>& ack, std::uint32_t capture_id, double took_s,
                        const std::vector<Capture>& captures) {
  nlohmann::json picture{{"status", ack ? ToString(ack->status) : "no answer"},
                         {"reason", ack ? ack->reason : ""},
                         {"took_s", took_s},
                         {"arrived", 0},
                         {"whole", false}};
  for (const Capture& capture : captures) {
    if (capture.capture_id != capture_id) continue;
    picture["arrived"] = picture["arrived"].get<int>() + 1;
    picture["bytes"] = capture.bytes.size();
    picture["whole"] = CheckJpeg(capture.bytes).ok();
  }
  return picture;
}

int Measure(const DdsOptions& options, int pictures) {
  Result<Participant> radio = Participant::Join("link-probe", options, [](const std::string& problem) {
    std::fprintf(stderr, "%s\n", problem.c_str());
  });
  if (!radio.ok()) {
    std::fprintf(stderr, "%s\n", radio.error().message.c_str());
    return 1;
  }
  Commander commander(radio.value(), 1, kMissionId);
  if (!commander.WaitFor([](const VehicleState& state) { return state.phase == VehiclePhase::kOnGround; },
                         60.0)) {
    std::fprintf(stderr, "the vehicle does not get ready\n");
    return 1;
  }
  FlightCommand take_off;
  take_off.kind = CommandKind::kTakeOff;
  take_off.path_in_map_m = {{0.0, 0.0, 4.0}};
  const auto is_up = commander.Do(take_off, 60.0);
  if (!is_up || is_up->status != AckStatus::kDone) {
    std::fprintf(stderr, "no take-off: %s\n", is_up ? is_up->reason.c_str() : "no answer");
    return 1;
  }
  nlohmann::json report{{"pictures", nlohmann::json::array()}};
  Pinger pinger(radio.value());
  for (int i = 1; i <= pictures; ++i) {
    const auto capture_id = static_cast<std::uint32_t>(i);
    const auto began = Clock::now();
    const auto ack = commander.Do(MakeLook(capture_id), 60.0);
    report["pictures"].push_back(Describe(ack, capture_id, SecondsSince(began), commander.Captures()));
  }
  pinger.Stop();
  std::this_thread::sleep_for(std::chrono::seconds(1));  // For the last answers.
  report["commands_s"] = pinger.Describe();
  std::printf("%s\n", report.dump().c_str());
  return 0;
}

}  // namespace
}  // namespace soffit

int main(int argc, char** argv) {
  CLI::App app{"link_probe: measures pictures and commands over a link to an agent"};
  soffit::DdsOptions options = soffit::DefaultRadioOptions();
  int pictures = 10;
  app.add_option("--domain", options.domain_id)->required();
  app.add_option("--peer", options.peers);
  app.add_option("--pictures", pictures);
  CLI11_PARSE(app, argc, argv);
  return soffit::Measure(options, pictures);
}
