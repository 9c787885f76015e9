#include "test/sim/command/run.h"

#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>

#include "test/sim/camera/camera_server.h"
#include "test/sim/command/control_server.h"
#include "test/sim/flight/flight.h"
#include "test/sim/render/renderer.h"
#include "test/sim/truth/truth.h"
#include "test/sim/world/space.h"
#include "test/sim/world/world.h"
#include "vehicle_agent/mavlink/link.h"

namespace soffit::sim {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kRound{5};
constexpr milliseconds kPosePatience{500};
constexpr std::int64_t kSilence_ns = 5'000'000'000;
constexpr std::int64_t kTruthPeriod_ns = 1'000'000'000;
constexpr std::int64_t kTrackPeriod_ns = 50'000'000;

volatile std::sig_atomic_t stop_requested = 0;

std::int64_t UtcNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

/// The vehicle does not wait for the machine: flying comes before drawing pictures, where the system allows
/// it.
void PutThisThreadFirst() {
  if (::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), -10) != 0) {
    spdlog::debug("flying at ordinary priority: {}", std::strerror(errno));
  }
}

/// Readers see the old file or the new one, never a part.
void WriteWhole(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path fresh = file.string() + ".part";
  {
    std::ofstream stream(fresh);
    stream << text;
  }
  std::filesystem::rename(fresh, file);
}

/// A link and what has been cut off at its end.
struct Wire {
  std::unique_ptr<mavlink::Link> link;
  mavlink::FrameParser parser;
};

Result<std::vector<Wire>> OpenWires(const RunOptions& options) {
  if (options.autopilot == "none" && options.mavlink_urls.size() != 1) {
    return InvalidInput("an autopilot that flies elsewhere is followed on one --mavlink link, not on " +
                        std::to_string(options.mavlink_urls.size()));
  }
  std::vector<Wire> wires;
  for (const std::string& url : options.mavlink_urls) {
    auto link = mavlink::OpenLink(url);
    if (!link.ok()) return link.error();
    wires.push_back({std::move(link).value(), {}});
  }
  return wires;
}

/// One run: everything that happens between the start and the signal to stop.
class Session {
 public:
  Session(const RunOptions& options, const World& world, const Truth& truth, std::vector<Wire> wires)
      : options_(options),
        world_(world),
        truth_(truth),
        wires_(std::move(wires)),
        space_(world),
        renderer_(world),
        flight_(MakeFlight()),
        cameras_(
            world, renderer_,
            [this](Mount mount, std::int64_t utc_ns) -> std::optional<Pose<Map, Camera>> {
              const auto pose = flight_->poses().Await(utc_ns, kPosePatience);
              if (!pose) return std::nullopt;
              return CameraPose(mount, *pose);
            },
            {options.camera_port, options.seed, options.broken_picture_ratio, options.late_picture_ratio}),
        track_(std::filesystem::path(options.out_folder) / "track.csv"),
        control_(
            options.control_port, [this](const std::string& words) { return Disturb(words); },
            [this] {
              const std::lock_guard lock(mutex_);
              return TruthJson(false).dump();
            }) {
    track_ << Flight::TrackHeader() << '\n';
  }

  void Go() {
    nlohmann::json urls;
    for (const Wire& wire : wires_) urls.push_back(wire.link->Url());
    const nlohmann::json ready = {{"mavlink", urls},
                                  {"camera_port", cameras_.port()},
                                  {"control_port", control_.port()},
                                  {"out", options_.out_folder}};
    std::cout << ready.dump() << std::endl;
    PutThisThreadFirst();
    while (stop_requested == 0) Round();
    const std::lock_guard lock(mutex_);
    track_ << flight_->TrackLine() << '\n';
    WriteTruth(true);
    TellContacts();
  }

 private:
  std::unique_ptr<Flight> MakeFlight() const {
    if (options_.autopilot == "none") return FollowFlight(world_, space_, truth_);
    const auto kind = options_.autopilot == "px4" ? AutopilotKind::kPx4 : AutopilotKind::kArduPilot;
    return SimulateFlight(world_, space_, truth_,
                          {kind, options_.is_quick_start, options_.seed, UtcNs(), wires_.size()});
  }

  void Round() {
    std::vector<std::vector<mavlink::Frame>> frames;  // By link. The first one gives the beat.
    for (Wire& wire : wires_) {
      frames.push_back(wire.parser.Feed(wire.link->Receive(frames.empty() ? kRound : milliseconds(0))));
    }
    const std::lock_guard lock(mutex_);
    const std::int64_t now_ns = UtcNs();
    const bool is_link_off = now_ns < link_off_until_ns_;
    WatchLink(!frames.front().empty(), now_ns);
    for (std::size_t i = 0; i < wires_.size() && !is_link_off; ++i) {
      for (const mavlink::Frame& frame : frames[i]) flight_->Receive(frame, now_ns, i);
    }
    flight_->Advance(now_ns);
    for (std::size_t i = 0; i < wires_.size(); ++i) {
      for (const auto& packet : flight_->TakePackets(i)) {
        if (!is_link_off) wires_[i].link->Send(packet);
      }
    }
    if (now_ns >= next_track_ns_) {
      next_track_ns_ = now_ns + kTrackPeriod_ns;
      track_ << flight_->TrackLine() << '\n';
    }
    if (now_ns >= next_truth_ns_) {
      next_truth_ns_ = now_ns + kTruthPeriod_ns;
      WriteTruth(false);
      TellContacts();
    }
  }

  /// An autopilot that flies elsewhere has to be heard.
  void WatchLink(bool has_heard, std::int64_t now_ns) {
    if (has_heard || options_.autopilot != "none") silent_since_ns_ = now_ns;
    if (now_ns - silent_since_ns_ < kSilence_ns) return;
    spdlog::warn("nothing is heard on {}: is the autopilot running, and is this its link?",
                 wires_.front().link->Url());
    silent_since_ns_ = now_ns;
  }

  nlohmann::json TruthJson(bool is_finished) const {
    nlohmann::json json = flight_->recorder().ToJson();
    json["format"] = "soffit-sim-truth/1";
    json["world"] = world_.name;
    json["seed"] = options_.seed;
    json["autopilot"] = options_.autopilot;
    json["finished"] = is_finished;
    json["state"] = flight_->State();
    json["truth"] = ToJson(truth_);
    json["track"] = "track.csv";
    return json;
  }

  void WriteTruth(bool is_finished) {
    track_.flush();
    WriteWhole(std::filesystem::path(options_.out_folder) / "truth.json",
               TruthJson(is_finished).dump(1) + "\n");
  }

  void TellContacts() {
    for (; told_contacts_ < flight_->recorder().contacts().size(); ++told_contacts_) {
      const Contact& contact = flight_->recorder().contacts()[told_contacts_];
      spdlog::error("contact with '{}' at ({:.2f}, {:.2f}, {:.2f})", contact.with, contact.position_m.x(),
                    contact.position_m.y(), contact.position_m.z());
    }
  }

  Status Disturb(const std::string& words) {
    const std::lock_guard lock(mutex_);
    Status status = TryToDisturb(words);
    if (status.ok()) spdlog::warn("disturbance: {}", words);
    return status;
  }

  Status TryToDisturb(const std::string& words) {
    std::istringstream stream(words);
    std::string what;
    stream >> what;
    if (std::string off; what == "link" && stream >> off && off == "off") {
      double seconds = 0.0;
      if (!(stream >> seconds) || !(seconds >= 0.0 && seconds < 1e6))
        return InvalidInput("write: link off SECONDS");
      link_off_until_ns_ = UtcNs() + static_cast<std::int64_t>(seconds * 1e9);
      return OkStatus();
    }
    if (what == "camera") {
      double broken_ratio = 0.0;
      double late_ratio = 0.0;
      if (!(stream >> broken_ratio >> late_ratio))
        return InvalidInput("write: camera BROKEN_RATIO LATE_RATIO");
      cameras_.SetFaults(broken_ratio, late_ratio);
      return OkStatus();
    }
    return flight_->Disturb(words);
  }

  const RunOptions& options_;
  const World& world_;
  const Truth& truth_;
  std::vector<Wire> wires_;
  Space space_;
  Renderer renderer_;
  std::mutex mutex_;  ///< Of the flight and of what follows.
  std::unique_ptr<Flight> flight_;
  CameraServer cameras_;
  std::ofstream track_;
  std::int64_t link_off_until_ns_ = 0;
  std::int64_t silent_since_ns_ = UtcNs();
  std::int64_t next_track_ns_ = 0;
  std::int64_t next_truth_ns_ = 0;
  std::size_t told_contacts_ = 0;
  ControlServer control_;
};

}  // namespace

Status Run(const RunOptions& options) {
  std::signal(SIGINT, [](int) { stop_requested = 1; });
  std::signal(SIGTERM, [](int) { stop_requested = 1; });
  const auto world = LoadWorld(options.world_file);
  if (!world.ok()) return world.error();
  auto wires = OpenWires(options);
  if (!wires.ok()) return wires.error();
  std::error_code problem;
  std::filesystem::create_directories(options.out_folder, problem);
  if (problem) return InvalidInput("folder '" + options.out_folder + "': " + problem.message());
  const Truth truth = FindTruth(world.value());
  spdlog::info("{}: {} ({})", world.value().name, ToString(truth.expected), truth.reason);
  try {
    Session(options, world.value(), truth, std::move(wires).value()).Go();
    return OkStatus();
  } catch (const std::runtime_error& failure) {
    return Error{Error::Code::kUnavailable, failure.what()};
  }
}

}  // namespace soffit::sim
