#include "service/edge/live/live_service.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "service/edge/files/file.h"
#include "service/edge/files/result.h"
#include "service/edge/live/findings.h"
#include "service/match/match.h"
#include "shared/options/yaml.h"

namespace soffit {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr auto kTick = 200ms;
constexpr std::size_t kMaxReplies = 256;
constexpr std::size_t kMaxWaitingFiles = 1024;
constexpr std::size_t kMaxPictures = 10'000;
constexpr double kTrackStep_m = 0.02;

std::int64_t Now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

Result<Reference> ReadReferenceBytes(const MissionRequest& request, const ImageOptions& options) {
  const Result<cv::Mat3b> picture = DecodePicture(request.reference, options);
  if (!picture.ok()) return picture.error();
  cv::Mat1b grey;
  cv::cvtColor(picture.value(), grey, cv::COLOR_BGR2GRAY);
  return ReadReference(grey);
}

bool IsShownAlike(const MissionReport& a, const MissionReport& b) {
  const auto percent = [](double ratio) { return std::lround(100.0 * ratio); };
  return a.status.state == b.status.state && a.status.step == b.status.step &&
         a.status.outcome == b.status.outcome && a.status.message == b.status.message &&
         a.status.problems == b.status.problems && a.status.object_id == b.status.object_id &&
         percent(a.status.progress_ratio) == percent(b.status.progress_ratio) &&
         percent(a.status.step_progress_ratio) == percent(b.status.step_progress_ratio) &&
         a.pictures_received == b.pictures_received && a.pictures_used == b.pictures_used &&
         a.picture_to_decision_s == b.picture_to_decision_s;
}

void LogProblem(const std::string& problem) { spdlog::warn("{}", problem); }

}  // namespace

Result<std::unique_ptr<LiveService>> LiveService::Start(const ServiceOptions& options, Stages stages) {
  std::error_code problem;
  fs::create_directories(options.data_folder, problem);
  if (problem) {
    return Error{Error::Code::kUnavailable,
                 "the data folder " + options.data_folder + " cannot be made: " + problem.message()};
  }
  auto radio = Participant::Join("soffitd radio", options.radio, LogProblem);
  if (!radio.ok()) return Error{radio.error().code, "radio: " + radio.error().message};
  auto local = Participant::Join("soffitd", options.local, LogProblem);
  if (!local.ok()) return Error{local.error().code, "local: " + local.error().message};
  return std::unique_ptr<LiveService>(
      new LiveService(options, std::move(stages), std::move(radio).value(), std::move(local).value()));
}

LiveService::LiveService(const ServiceOptions& options, Stages stages, Participant radio, Participant local)
    : options_(options),
      stages_(std::move(stages)),
      epoch_utc_ns_(Now()),
      last_decision_id_(static_cast<std::uint64_t>(epoch_utc_ns_)),
      radio_(std::move(radio)),
      local_(std::move(local)),
      commands_(radio_),
      heartbeats_(radio_),
      mission_replies_(local_),
      statuses_(local_),
      scenes_(local_, options.pipeline),
      states_(
          radio_,
          [this](VehicleState state) { loop_.Post([this, state = std::move(state)] { OnState(state); }); }),
      acks_(radio_, [this](CommandAck ack) { loop_.Post([this, ack = std::move(ack)] { OnAck(ack); }); }),
      captures_(radio_,
                [this](Capture capture) {
                  auto shared = std::make_shared<Capture>(std::move(capture));
                  loop_.Post([this, shared] { OnCapture(std::move(*shared)); });
                }),
      requests_(local_,
                [this](MissionRequest request) {
                  loop_.Post([this, request = std::move(request)] { OnRequest(request); });
                }),
      workers_(options.workers, static_cast<std::size_t>(options.max_waiting_pictures)),
      disk_(1, kMaxWaitingFiles) {}

LiveService::~LiveService() = default;

void LiveService::Run() {
  loop_.Run(kTick, [this] { OnTick(); });
  for (auto& [vehicle_id, run] : runs_) {
    if (run.mission.status.state == MissionState::kEnded) continue;
    spdlog::warn("vehicle {}: its mission {} is left: it holds, then comes home by itself", vehicle_id,
                 run.mission.order.mission_id);
    SaveLog(run);
  }
}

void LiveService::Stop() { loop_.Stop(); }

// ---- What others say ----

void LiveService::OnState(const VehicleState& state) {
  const auto known = vehicles_.find(state.vehicle_id);
  if (known == vehicles_.end()) {
    spdlog::info("vehicle {} '{}' is here: {}, {}", state.vehicle_id, state.name,
                 state.autopilot.empty() ? "no autopilot yet" : state.autopilot, ToString(state.phase));
  } else if (known->second.phase != state.phase) {
    spdlog::info("vehicle {}: {}{}{}", state.vehicle_id, ToString(state.phase),
                 state.message.empty() ? "" : ": ", state.message);
  }
  const auto run = runs_.find(state.vehicle_id);
  if (run != runs_.end()) {
    const bool is_of_run =
        !run->second.mission.vehicle || run->second.mission.vehicle->agent_epoch == state.agent_epoch;
    auto& track = run->second.log.track;
    const bool has_moved =
        track.empty() || (track.back().position_in_map_m - state.position_in_map_m).norm() > kTrackStep_m;
    if (is_of_run && has_moved && run->second.mission.status.state != MissionState::kEnded) {
      track.push_back({SecondsInto(run->second), state.position_in_map_m, state.yaw_rad});
    }
    Feed(run->second, state);
  }
  vehicles_[state.vehicle_id] = state;
  scenes_.ros().PublishState(state);
}

void LiveService::OnAck(const CommandAck& ack) {
  MissionRun* run = FindRun(ack.vehicle_id, ack.mission_id);
  if (run == nullptr) return;
  if (ack.status == AckStatus::kRefused || ack.status == AckStatus::kFailed) {
    spdlog::warn("vehicle {}: command {} {}: {}", ack.vehicle_id, ack.sequence, ToString(ack.status),
                 ack.reason);
  }
  Feed(*run, ack);
}

void LiveService::OnCapture(Capture capture) {
  MissionRun* run = FindRun(capture.vehicle_id, capture.mission_id);
  if (run == nullptr || run->captures.size() >= kMaxPictures) {
    spdlog::warn("vehicle {}: picture {} of mission {} dropped: no such mission is flown", capture.vehicle_id,
                 capture.capture_id, capture.mission_id);
    return;
  }
  const bool is_known = std::any_of(run->captures.begin(), run->captures.end(),
                                    [&](const Capture& c) { return c.capture_id == capture.capture_id; });
  if (is_known) return;
  capture.name = NamePicture(capture);
  run->log.pictures.push_back(
      {capture.capture_id, capture.name, capture.purpose, SecondsInto(*run), -1.0, -1.0, ""});
  run->captures.push_back(capture);
  SaveSurvey(*run);
  scenes_.ros().PublishCapture(capture);

  const auto shared = std::make_shared<const Capture>(std::move(capture));
  const bool is_taken = workers_.TrySubmit([this, shared] {
    auto seen = std::make_shared<Result<Observation>>(stages_.observe(*shared));
    loop_.Post([this, shared, seen] {
      OnObserved(shared->vehicle_id, shared->mission_id, shared->capture_id, std::move(*seen));
    });
  });
  if (!is_taken) {
    OnObserved(shared->vehicle_id, shared->mission_id, shared->capture_id,
               Error{Error::Code::kUnavailable, "the service is busy with other pictures"});
  }
}

void LiveService::OnRequest(const MissionRequest& request) {
  const auto known = std::find_if(replies_.begin(), replies_.end(),
                                  [&](const MissionReply& r) { return r.id == request.id; });
  if (known == replies_.end()) {
    MissionReply reply = Serve(request);
    reply.id = request.id;
    if (!reply.is_accepted)
      spdlog::error("request for vehicle {} refused: {}", request.vehicle_id, reply.message);
    replies_.push_back(std::move(reply));
    if (replies_.size() > kMaxReplies) replies_.pop_front();
    mission_replies_.Write(replies_.back());
  } else {
    mission_replies_.Write(*known);
  }
}

void LiveService::OnTick() {
  for (auto& [vehicle_id, run] : runs_) {
    Feed(run, Tick{});
    TryToUnderstand(run);
  }
  PublishHeartbeats();
}

// ---- Missions ----

MissionReply LiveService::Serve(const MissionRequest& request) {
  switch (request.kind) {
    case MissionRequestKind::kStart:
      return StartFlight(request);
    case MissionRequestKind::kPause:
      return Wish(request, OperatorWish::kPause);
    case MissionRequestKind::kResume:
      return Wish(request, OperatorWish::kResume);
    case MissionRequestKind::kAbort:
      return Wish(request, OperatorWish::kAbort);
    case MissionRequestKind::kNone:
      break;
  }
  return {{}, false, 0, "the request has no kind"};
}

MissionReply LiveService::StartFlight(const MissionRequest& request) {
  if (request.vehicle_id == 0) return {{}, false, 0, "vehicle ids begin at 1"};
  const auto current = runs_.find(request.vehicle_id);
  if (current != runs_.end() && current->second.mission.status.state != MissionState::kEnded) {
    const std::uint64_t mission_id = current->second.mission.order.mission_id;
    return {{},
            false,
            mission_id,
            "vehicle " + std::to_string(request.vehicle_id) + " flies mission " + std::to_string(mission_id) +
                ": abort that one first"};
  }
  MissionRun run;
  run.started_utc_ns = Now();
  last_mission_id_ =
      std::max(last_mission_id_ + 1, static_cast<std::uint64_t>(run.started_utc_ns / 1'000'000));
  run.mission = StartMission(
      {request.vehicle_id, last_mission_id_, request.area_center_in_map_m, request.area_radius_m});
  run.folder = fs::path(options_.data_folder) / ("mission-" + std::to_string(last_mission_id_));
  run.reference_name = request.reference_name;
  const bool is_png = !request.reference.empty() && request.reference.front() == 0x89;
  run.reference_file = is_png ? "reference.png" : "reference.jpg";

  MissionReply reply{{}, true, last_mission_id_, ""};
  const Result<Reference> reference = ReadReferenceBytes(request, options_.pipeline.image);
  if (reference.ok()) {
    run.reference = reference.value();
    const auto bytes = std::make_shared<const std::vector<std::uint8_t>>(request.reference);
    // With the survey and these options `soffit analyze` and `soffit report` repeat what was understood here.
    OnDisk("the options", [file = run.folder / "options.yaml", text = DescribeOptions(options_.pipeline)] {
      return WriteFile(file, text);
    });
    OnDisk("the reference", [file = run.folder / run.reference_file, bytes] {
      return WriteFile(file, {reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    });
    spdlog::info("mission {}: vehicle {} looks for '{}', {} shapes", last_mission_id_, request.vehicle_id,
                 request.reference_name, run.reference.shapes.size());
  } else {
    reply = {{},
             false,
             last_mission_id_,
             "the reference '" + request.reference_name + "': " + reference.error().message};
    run.mission.status.state = MissionState::kEnded;
    run.mission.status.step = MissionStep::kDone;
    run.mission.status.outcome = MissionOutcome::kFailed;
    run.mission.status.message = reply.message;
  }
  MissionRun& kept = runs_[request.vehicle_id] = std::move(run);
  PublishScene(kept);
  PublishReport(kept);
  return reply;
}

MissionReply LiveService::Wish(const MissionRequest& request, OperatorWish wish) {
  const auto found = runs_.find(request.vehicle_id);
  const bool is_there =
      found != runs_.end() && found->second.mission.status.state != MissionState::kEnded &&
      (request.mission_id == 0 || request.mission_id == found->second.mission.order.mission_id);
  if (!is_there)
    return {{},
            false,
            request.mission_id,
            "vehicle " + std::to_string(request.vehicle_id) + " flies no such mission"};
  Feed(found->second, wish);
  return {{}, true, found->second.mission.order.mission_id, ""};
}

MissionRun* LiveService::FindRun(std::uint32_t vehicle_id, std::uint64_t mission_id) {
  const auto found = runs_.find(vehicle_id);
  return found != runs_.end() && found->second.mission.order.mission_id == mission_id ? &found->second
                                                                                      : nullptr;
}

void LiveService::Feed(MissionRun& run, const MissionEvent& event) {
  if (run.mission.status.state == MissionState::kEnded) return;
  const std::size_t known_problems = run.mission.status.problems.size();
  MissionUpdate update =
      Advance(std::move(run.mission), event, Now(), options_.pipeline.viewpoint, options_.mission);
  run.mission = std::move(update.mission);
  for (const FlightCommand& command : update.commands) {
    commands_.Write(command);
    scenes_.ros().PublishWaypoints(command.vehicle_id, command.issued_utc_ns, command.path_in_map_m);
  }
  if (!update.commands.empty()) NoteDecisions(run);
  if (update.wants_findings) run.is_understanding_wanted = true;
  const auto& problems = run.mission.status.problems;
  for (std::size_t i = known_problems; i < problems.size(); ++i) {
    spdlog::warn("mission {}: {}", run.mission.order.mission_id, problems[i]);
  }
  NoteStep(run);
  PublishReport(run);
  TryToUnderstand(run);
  if (run.mission.status.state == MissionState::kEnded) {
    SaveLog(run);
    SaveResults(run);
  }
}

/// The command that was just sent is what the pictures observed before it allowed.
void LiveService::NoteDecisions(MissionRun& run) {
  for (PictureTimes& picture : run.log.pictures) {
    if (picture.observed_s < 0.0 || picture.decided_s >= 0.0) continue;
    picture.decided_s = SecondsInto(run);
    MissionReport& report = run.log.report;
    report.picture_to_decision_s = picture.decided_s - picture.arrived_s;
    report.picture_to_decision_max_s =
        std::max(report.picture_to_decision_max_s, report.picture_to_decision_s);
    spdlog::info("mission {}: {} arrived {:.2f} s before what it allowed", run.mission.order.mission_id,
                 picture.file, report.picture_to_decision_s);
  }
}

void LiveService::NoteStep(MissionRun& run) {
  const MissionStep step = run.mission.status.step;
  if (!run.log.steps.empty() && run.log.steps.back().step == step) return;
  run.log.steps.push_back({step, SecondsInto(run)});
  SaveLog(run);
}

// ---- Pictures ----

void LiveService::OnObserved(std::uint32_t vehicle_id, std::uint64_t mission_id, std::uint32_t capture_id,
                             Result<Observation> seen) {
  MissionRun* run = FindRun(vehicle_id, mission_id);
  if (run == nullptr) return;
  PictureResult result{capture_id, ""};
  if (!seen.ok()) {
    result.problem = seen.error().message;
  } else {
    if (!seen.value().image.has_trusted_pose) result.problem = "its pose is not known well enough";
    run->observations.insert_or_assign(capture_id, std::move(seen).value());
  }
  for (PictureTimes& picture : run->log.pictures) {
    if (picture.capture_id != capture_id) continue;
    picture.observed_s = SecondsInto(*run);
    picture.problem = result.problem;
  }
  Feed(*run, result);
}

void LiveService::TryToUnderstand(MissionRun& run) {
  if (!run.is_understanding_wanted || run.is_understanding || !run.mission.vehicle) return;
  std::vector<Observation> observations;
  for (const auto& [capture_id, seen] : run.observations) observations.push_back(seen);
  const MissionOrder order = run.mission.order;
  const bool is_taken =
      workers_.TrySubmit([this, order, observations = std::move(observations), reference = run.reference,
                          envelope = run.mission.vehicle->envelope, revision = run.scene_revision + 1] {
        auto all = std::make_shared<Understanding>();
        std::string failure;
        try {
          *all = stages_.understand(observations, reference, envelope, revision);
        } catch (const std::exception& problem) {
          failure = problem.what();
        }
        loop_.Post(
            [this, order, all, failure] { OnUnderstood(order.vehicle_id, order.mission_id, all, failure); });
      });
  if (!is_taken) return;  // Tried again at the next tick.
  run.is_understanding_wanted = false;
  run.is_understanding = true;
  ++run.scene_revision;
}

void LiveService::OnUnderstood(std::uint32_t vehicle_id, std::uint64_t mission_id,
                               std::shared_ptr<Understanding> all, const std::string& failure) {
  MissionRun* run = FindRun(vehicle_id, mission_id);
  if (run == nullptr) return;
  run->is_understanding = false;
  if (!failure.empty()) {
    spdlog::error("mission {}: the pictures could not be understood: {}", mission_id, failure);
    Findings none;
    none.failure = "the pictures could not be understood: " + failure;
    return Feed(*run, none);
  }
  const std::int64_t now = Now();
  run->decisions.clear();
  for (ClearanceDecision& decision : all->decisions) {
    decision.vehicle_id = vehicle_id;
    decision.decision_id = ++last_decision_id_;
    const auto valid_ns = static_cast<std::int64_t>(options_.mission.permit_valid_s * 1e9);
    run->decisions.push_back({mission_id, now, now + valid_ns, decision});
    spdlog::info("mission {}: building {}, side {}: {}: {}", mission_id, decision.object_id, decision.side,
                 ToString(decision.verdict), decision.reason);
  }
  run->understanding = std::move(all);
  PublishScene(*run);
  SaveResults(*run);
  Feed(*run, MakeFindings(*run->understanding));
}

void LiveService::SaveSurvey(MissionRun& run) {
  const auto survey = std::make_shared<Survey>();
  survey->captures = run.captures;
  if (run.mission.vehicle) survey->vehicle = run.mission.vehicle->envelope;
  if (run.mission.vehicle) survey->origin = run.mission.vehicle->origin;
  survey->reference_file = run.reference_file;
  survey->colors = options_.pipeline.mask.colors;
  OnDisk("a picture", [folder = run.folder, survey] { return WriteSurvey(folder, *survey); });
  for (Capture& capture : run.captures) capture.bytes.clear();
}

void LiveService::SaveResults(const MissionRun& run) {
  if (!run.understanding) return;
  std::vector<Observation> observations;
  for (const auto& [capture_id, seen] : run.observations) observations.push_back(seen);
  OnDisk("the results",
         [folder = run.folder, all = run.understanding, observations = std::move(observations)] {
           return WriteResult(folder, *all, observations);
         });
}

void LiveService::SaveLog(const MissionRun& run) {
  OnDisk("the mission's log", [folder = run.folder, log = run.log] { return WriteMissionLog(folder, log); });
}

void LiveService::OnDisk(const std::string& what, std::function<Status()> write) {
  const bool is_taken = disk_.TrySubmit([what, write = std::move(write)] {
    try {
      const Status status = write();
      if (!status.ok()) spdlog::error("{} could not be written: {}", what, status.error().message);
    } catch (const std::exception& problem) {
      spdlog::error("{} could not be written: {}", what, problem.what());
    }
  });
  if (!is_taken) spdlog::error("{} was not written: the disk is too slow", what);
}

// ---- What it tells ----

void LiveService::PublishReport(MissionRun& run) {
  MissionReport& report = run.log.report;
  report.vehicle_id = run.mission.order.vehicle_id;
  report.mission_id = run.mission.order.mission_id;
  report.started_utc_ns = run.started_utc_ns;
  report.status = run.mission.status;
  report.pictures_received = static_cast<std::uint32_t>(run.captures.size());
  report.pictures_used = static_cast<std::uint32_t>(run.observations.size());
  if (run.published && IsShownAlike(*run.published, report)) return;
  if (!run.published || run.published->status.message != report.status.message) {
    spdlog::info("mission {}: {}: {}", report.mission_id, ToString(report.status.step),
                 report.status.message);
  }
  report.revision += 1;
  report.stamp_utc_ns = Now();
  run.published = report;
  statuses_.Write(report);
}

void LiveService::PublishScene(const MissionRun& run) {
  const std::uint64_t revision = run.understanding ? run.understanding->scene.revision : run.scene_revision;
  scenes_.Publish(std::make_shared<SceneSnapshot>(
      SceneSnapshot{{run.mission.order.vehicle_id, run.mission.order.mission_id, revision},
                    Now(),
                    run.understanding,
                    run.decisions,
                    run.mission.vehicle ? run.mission.vehicle->envelope : VehicleEnvelope{},
                    run.reference_name}));
}

void LiveService::PublishHeartbeats() {
  for (const auto& [vehicle_id, run] : runs_) {
    if (run.mission.status.state == MissionState::kEnded) continue;
    heartbeats_.Write({vehicle_id, run.mission.order.mission_id, static_cast<std::uint64_t>(epoch_utc_ns_),
                       Now(), run.mission.status.state == MissionState::kPaused});
  }
}

double LiveService::SecondsInto(const MissionRun& run) const {
  return static_cast<double>(Now() - run.started_utc_ns) * 1e-9;
}

}  // namespace soffit
