#include "vehicle_agent/edge/station.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "vehicle_agent/edge/develop.h"

namespace soffit {
namespace {

constexpr std::chrono::milliseconds kBeat(20);
constexpr double kQuietRate_hz = 2.0;  // Of the state of an agent that gives way.

Participant::ProblemHandler MakeProblemLogger() {
  return [](const std::string& problem) { spdlog::warn("bus: {}", problem); };
}

}  // namespace

Instant ReadClocks() {
  using namespace std::chrono;
  return {duration_cast<nanoseconds>(steady_clock::now().time_since_epoch()).count(),
          duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count()};
}

Result<std::unique_ptr<Station>> Station::Open(const AgentConfig& config, std::uint64_t epoch) {
  Result<AutopilotLine> line = AutopilotLine::Open(config.mavlink, config.mavlink_key_file);
  if (!line.ok()) return line.error();
  const Result<LinkProfile> profile = FindLinkProfile(config.radio);
  if (!profile.ok()) return profile.error();
  Result<Participant> radio =
      Participant::Join("soffit-agent " + config.vehicle.name, config.radio, MakeProblemLogger());
  if (!radio.ok()) return radio.error();
  return std::unique_ptr<Station>(
      new Station(config, profile.value(), epoch, std::move(line).value(), std::move(radio).value()));
}

Station::Station(const AgentConfig& config, const LinkProfile& profile, std::uint64_t epoch,
                 AutopilotLine line, Participant radio)
    : config_(config),
      line_(std::move(line)),
      autopilot_(config.autopilot, IsPresent(config.cameras.gimbal)),
      agent_(MakeIdentity(config, epoch), config.agent, config.guard, ReadClocks()),
      radio_(std::move(radio)),
      states_(radio_),
      acks_(radio_),
      sender_(radio_, profile, config.send_timeout_s, mailbox_),
      commands_(radio_, [this](const FlightCommand& command) { mailbox_.Put(command); }),
      heartbeats_(
          radio_,
          [this, id = static_cast<std::uint32_t>(config.vehicle.id)](const MissionHeartbeat& heartbeat) {
            if (heartbeat.vehicle_id == id) mailbox_.Put(ServiceHeartbeat{heartbeat.mission_id});
          }),
      others_(radio_,
              [this, id = static_cast<std::uint32_t>(config.vehicle.id), epoch](const VehicleState& state) {
                if (state.vehicle_id == id && state.agent_epoch != epoch) {
                  mailbox_.Put(RivalHeard{state.agent_epoch, state.name});
                }
              }) {
  for (const auto& [id, options] : ListCameras(config_)) {
    cameras_[id] = std::make_unique<CameraPost>(id, *options, mailbox_);
    health_.problems[id] = "was not tried yet";
  }
  Tell(health_, ReadClocks());
  spdlog::info("vehicle {} '{}': MAVLink on {}{}, DDS domain {}", config.vehicle.id, config.vehicle.name,
               line_.Url(), line_.IsSigned() ? ", signed" : "", config.radio.domain_id);
  if (cameras_.empty()) spdlog::warn("no camera is configured: every look will be refused");
}

void Station::Run(const std::atomic<bool>& stop) {
  supervisor_.SayReady();
  while (!stop) {
    for (const mavlink::Frame& frame : line_.Receive(kBeat)) autopilot_.Receive(frame, ReadClocks());
    const Instant now = ReadClocks();
    OpenLetters(now);
    DevelopPictures(now);
    ExchangeWithAutopilot(now);
    PublishState(now);
    supervisor_.SayAlive(now);
  }
}

void Station::ExchangeWithAutopilot(Instant now) {
  Tell(autopilot_.Report(now), now);
  Tell(Beat{}, now);
  for (auto& packet : autopilot_.Pursue(agent_.intent(), now)) line_.Send(std::move(packet));
  for (const std::string& note : autopilot_.TakeNotes()) spdlog::info("{}", note);
}

void Station::OpenLetters(Instant now) {
  for (const Letter& letter : mailbox_.TakeAll()) {
    std::visit([&](const auto& it) { Open(it, now); }, letter);
  }
}

void Station::Open(const CameraTried& tried, Instant now) {
  const auto known = health_.problems.find(tried.camera);
  const std::string before = known == health_.problems.end() ? "" : known->second;
  if (tried.problem == before) return;
  if (tried.problem.empty()) {
    health_.problems.erase(tried.camera);
    spdlog::info("{} camera works", ToString(tried.camera));
  } else {
    health_.problems[tried.camera] = tried.problem;
    spdlog::error("{} camera: {}; it is tried again", ToString(tried.camera), tried.problem);
  }
  Tell(health_, now);
}

void Station::Open(const PictureTaken& taken, Instant now) {
  if (!taken.picture.ok()) {
    return Tell(PictureOutcome{taken.request.request_id, std::string(ToString(taken.request.camera)) +
                                                             " camera: " + taken.picture.error().message},
                now);
  }
  negatives_.push_back({taken, now});
}

void Station::Open(const PictureDelivered& delivered, Instant now) {
  const DeliveryReport& report = delivered.report;
  if (delivered.outcome.problem.empty()) {
    spdlog::info("picture {} arrived: {} x {}, {} kB in {:.2f} s, {} of {} fragments sent again{}",
                 report.capture_id, report.width_px, report.height_px, report.size_bytes / 1000,
                 report.latency_s, report.fragments.sent_again, report.fragments.sent,
                 report.tries > 1 ? ", the service was lost and found meanwhile" : "");
  }
  Tell(delivered.outcome, now);
}

void Station::DevelopPictures(Instant now) {
  const auto is_due = [&](const Negative& negative) {
    return autopilot_.poses().newest_utc_ns() >= negative.taken.picture.value().exposure_utc_ns ||
           SecondsBetween(negative.since, now) > config_.pose_wait_s;
  };
  const auto cameras = ListCameras(config_);
  for (Negative& negative : negatives_) {
    if (!is_due(negative)) continue;
    const ExposureRequest request = std::exchange(negative.taken.request, {});
    Picture picture = std::move(negative.taken.picture).value();
    const CameraOptions& camera =
        *std::ranges::find(cameras, request.camera, [](const auto& entry) { return entry.first; })->second;
    const std::string blur = FindBlurProblem(picture, camera, autopilot_.poses());
    if (!blur.empty()) {
      Tell(PictureOutcome{request.request_id, blur}, now);
      continue;
    }
    if (!picture.has_trusted_time)
      spdlog::warn("picture {}: its time is not of our clock", request.capture_id);
    const ExposureContext context{static_cast<std::uint32_t>(config_.vehicle.id), autopilot_.Report(now),
                                  autopilot_.TrustsPoses(now), autopilot_.ClockUncertainty_s().value_or(0.0)};
    Capture capture = MakeCapture(request, std::move(picture), camera, autopilot_.poses(), context);
    if (!capture.has_trusted_pose) spdlog::warn("picture {}: its pose is not trusted", request.capture_id);
    sender_.Send(request.request_id, std::move(capture));
  }
  std::erase_if(negatives_, [](const Negative& negative) { return negative.taken.request.request_id == 0; });
}

void Station::PublishState(Instant now) {
  const double rate_hz = agent_.GivesWayToRival(now) ? kQuietRate_hz : config_.state_rate_hz;
  if (published_.steady_ns != 0 && SecondsBetween(published_, now) < 1.0 / rate_hz) return;
  published_ = now;
  const VehicleState state = agent_.Describe(now);
  states_.Write(state);
  if (state.phase == told_phase_ && state.message == told_message_) return;
  if (state.phase != told_phase_ || state.message.find("silent for") == std::string::npos) {
    spdlog::info("{}{}{}", ToString(state.phase), state.message.empty() ? "" : ": ", state.message);
  }
  supervisor_.SayStatus(std::string(ToString(state.phase)) + (state.message.empty() ? "" : ": ") +
                        state.message);
  told_phase_ = state.phase;
  told_message_ = state.message;
}

void Station::Tell(const AgentEvent& event, Instant now) {
  const AgentOutputs outputs = agent_.Step(event, now);
  for (const CommandAck& ack : outputs.acks) acks_.Write(ack);
  for (const std::string& note : outputs.notes) {
    spdlog::info("{}", note);
    autopilot_.Announce(note);
  }
  if (outputs.exposure) cameras_.at(outputs.exposure->camera)->Ask(*outputs.exposure);
}

}  // namespace soffit
