#include "service/edge/live/live_service.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "service/edge/files/file.h"
#include "service/edge/files/result.h"
#include "service/edge/files/survey.h"
#include "service/edge/live/findings.h"
#include "service/match/match.h"
#include "shared/options/yaml.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

constexpr auto kTick = 200ms;
constexpr std::size_t kMaxReplies = 256;
constexpr std::size_t kMaxWaitingFiles = 1024;
constexpr std::size_t kMaxPictures = 10'000;
constexpr std::uintmax_t kMaxPictureBytes = 64U << 20U;
constexpr double kTrackStep_m = 0.02;
constexpr double kTrackKept_s = 1.0;
constexpr auto kLongestWaitForTheStore = 250ms;

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

std::string PlaceOfStore(const ServiceOptions& options) {
  return options.store.empty() ? (fs::path(options.data_folder) / "soffit.gpkg").string() : options.store;
}

/// What the store has. One on a disk that is full or read-only is still read.
Result<std::vector<KeptRun>> ReadStore(const std::string& place) try {
  Result<Store> store = Store::Open(place, false);
  if (!store.ok()) {
    const Error why = store.error();
    store = Store::Open(place, true);
    if (!store.ok()) return Error{why.code, "store: " + why.message};
    spdlog::error("the store can only be read: {}", why.message);
  }
  return store.value().ReadNewest();
} catch (const std::exception& damage) {
  return Error{Error::Code::kUnavailable, Say("store: ", damage.what())};
}

std::optional<GeodeticOrigin> OriginOf(const MissionRun& run) {
  return run.mission.vehicle ? run.mission.vehicle->origin : std::nullopt;
}

/// Within a task of the keeper.
void Require(const Status& status) {
  if (!status.ok()) throw std::runtime_error(status.error().message);
}

}  // namespace

Result<std::unique_ptr<LiveService>> LiveService::Start(const ServiceOptions& options, Stages stages) {
  std::error_code problem;
  fs::create_directories(options.data_folder, problem);
  if (problem) {
    return Error{Error::Code::kUnavailable,
                 "the data folder " + options.data_folder + " cannot be made: " + problem.message()};
  }
  Result<std::vector<KeptRun>> kept = ReadStore(PlaceOfStore(options));
  if (!kept.ok()) return kept.error();
  auto radio = Participant::Join("soffitd radio", options.radio, LogProblem);
  if (!radio.ok()) return Error{radio.error().code, "radio: " + radio.error().message};
  auto local = Participant::Join("soffitd", options.local, LogProblem);
  if (!local.ok()) return Error{local.error().code, "local: " + local.error().message};
  return std::unique_ptr<LiveService>(new LiveService(options, std::move(stages), std::move(radio).value(),
                                                      std::move(local).value(), std::move(kept).value()));
}

LiveService::LiveService(const ServiceOptions& options, Stages stages, Participant radio, Participant local,
                         std::vector<KeptRun> kept)
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
      disk_(1, kMaxWaitingFiles),
      keeper_(PlaceOfStore(options), [this](const std::string& trouble) {
        trouble.empty() ? spdlog::info("the store is written again")
                        : spdlog::error("the store cannot be written: {}", trouble);
        loop_.Post([this, trouble] { trouble_ = trouble; });
      }) {
  for (KeptRun& run : kept) Restore(std::move(run));
}

LiveService::~LiveService() = default;

void LiveService::Run() {
  for (auto& [vehicle_id, run] : runs_) PublishReport(run);
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
  if (ack.status != AckStatus::kAccepted)
    Note(*run, "answer",
         Say(ack.sequence, " ", ToString(ack.status), ack.reason.empty() ? "" : ": ", ack.reason));
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
  KeepPicture(*run, capture);
  scenes_.ros().PublishCapture(capture);
  run->unobserved.insert(capture.capture_id);
  if (TryToObserve(*run, capture)) return;
  OnObserved(capture.vehicle_id, capture.mission_id, capture.capture_id,
             Error{Error::Code::kUnavailable, "the service is busy with other pictures"});
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
    ReadPictures(run);
    TryToUnderstand(run);
    KeepTrack(run);
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
  run.request_id = request.id;
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
    keeper_.Keep([folder = run.folder, name = run.reference_file, bytes,
                  options = DescribeOptions(options_.pipeline)](Store&) {
      Require(WriteFile(folder / "options.yaml", options));
      Require(WriteFile(folder / name, {reinterpret_cast<const char*>(bytes->data()), bytes->size()}));
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
  MissionRun& begun = runs_[request.vehicle_id] = std::move(run);
  Note(begun, "begin", Say("vehicle ", request.vehicle_id, " looks for ", request.reference_name));
  PublishReport(begun);
  scenes_.Publish(Snapshot(begun));
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
  const std::uint32_t known_sequence = run.mission.last_sequence;
  MissionUpdate update =
      Advance(std::move(run.mission), event, Now(), options_.pipeline.viewpoint, options_.mission);
  run.mission = std::move(update.mission);
  const auto& problems = run.mission.status.problems;
  for (std::size_t i = known_problems; i < problems.size(); ++i) {
    spdlog::warn("mission {}: {}", run.mission.order.mission_id, problems[i]);
    Note(run, "problem", problems[i]);
  }
  for (const FlightCommand& command : update.commands) {
    if (command.sequence > known_sequence)
      Note(run, "command", Say(command.sequence, " ", ToString(command.kind)));
  }
  NoteStep(run);
  PublishReport(run);
  for (const FlightCommand& command : update.commands) {
    commands_.Write(command);
    scenes_.ros().PublishWaypoints(command.vehicle_id, command.issued_utc_ns, command.path_in_map_m);
  }
  if (!update.commands.empty()) NoteDecisions(run);
  if (update.wants_findings) run.is_understanding_wanted = true;
  TryToUnderstand(run);
  if (run.mission.status.state == MissionState::kEnded) {
    KeepTrack(run);
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
  Note(run, "step", Say(ToString(step), ": ", run.mission.status.message));
  SaveLog(run);
}

// ---- What survives this process ----

/// Everything is as it was but for what is heard anew; the pictures are looked at again.
void LiveService::Restore(KeptRun kept) {
  MissionRun run;
  static_cast<KeptMission&>(run) = std::move(kept.mission);
  const MissionOrder order = run.mission.order;
  last_mission_id_ = std::max(last_mission_id_, order.mission_id);
  run.folder = fs::path(options_.data_folder) / ("mission-" + std::to_string(order.mission_id));
  run.kept = WriteMission(run);
  run.track_kept = run.log.track.size();
  for (const auto& scene : kept.scenes) {
    if (scene->origin.scene_revision == run.findings_revision)
      run.mission.findings = MakeFindings(*scene->understanding);
  }
  if (!kept.scenes.empty()) {
    run.scene_revision = kept.scenes.back()->origin.scene_revision;
    run.understanding = kept.scenes.back()->understanding;
    run.decisions = kept.scenes.back()->decisions;
    scenes_.Restore(MakeHistory(std::move(kept.revisions), std::move(kept.scenes)));
  }
  const bool was_accepted = run.mission.status.outcome != MissionOutcome::kFailed;
  replies_.push_back({run.request_id, was_accepted, order.mission_id, run.mission.status.message});
  if (run.mission.status.state != MissionState::kEnded) {
    spdlog::warn("mission {} of vehicle {} goes on: {}", order.mission_id, order.vehicle_id,
                 ToString(run.mission.status.step));
    const Result<Reference> reference = ReadReferenceFile(run.folder / run.reference_file);
    if (reference.ok()) run.reference = reference.value();
    if (!reference.ok()) spdlog::error("mission {}: {}", order.mission_id, reference.error().message);
    run.mission = ContinueMission(std::move(run.mission), Now(), options_.mission);
    run.is_understanding_wanted = run.mission.is_waiting_for_findings;
    for (const Capture& capture : run.captures) {
      run.unobserved.insert(capture.capture_id);
      run.unread.push_back(capture.capture_id);
    }
  }
  runs_[order.vehicle_id] = std::move(run);
}

void LiveService::Note(MissionRun& run, const char* kind, std::string text) {
  run.news.push_back({Now(), kind, std::move(text)});
}

/// Nothing is sent that follows from what could be forgotten: whoever hears of it finds it again after a
/// restart. A store that is slow or away keeps nobody waiting.
void LiveService::Keep(MissionRun& run) {
  run.findings_revision = run.mission.findings ? run.mission.findings->scene_revision : 0;
  MissionRecord record = WriteMission(run);
  if (record == run.kept && run.news.empty()) return;
  run.kept = record;
  keeper_.Keep([record = std::move(record), news = std::exchange(run.news, {})](Store& store) {
    store.PutMission(record);
    store.AddToJournal(record.mission_id, news);
  });
  keeper_.Wait(kLongestWaitForTheStore);
}

void LiveService::KeepTrack(MissionRun& run) {
  const auto& track = run.log.track;
  if (run.track_kept == track.size()) return;
  const bool is_ended = run.mission.status.state == MissionState::kEnded;
  if (!is_ended && track.back().time_s - track[run.track_kept].time_s < kTrackKept_s) return;
  std::vector<TrackPoint> points(track.begin() + static_cast<std::ptrdiff_t>(run.track_kept), track.end());
  run.track_kept = track.size();
  keeper_.Keep([id = run.mission.order.mission_id, points = std::move(points),
                origin = OriginOf(run)](Store& store) { store.AddTrack(id, points, origin); });
}

// ---- Pictures ----

bool LiveService::TryToObserve(MissionRun& run, const Capture& capture) {
  const auto shared = std::make_shared<Capture>(capture);
  return workers_.TrySubmit([this, shared, folder = run.folder] {
    auto seen = std::make_shared<Result<Observation>>(Error{});
    if (shared->bytes.empty()) {
      Result<std::vector<std::uint8_t>> bytes = ReadFile(folder / shared->name, kMaxPictureBytes);
      bytes.ok() ? void(shared->bytes = std::move(bytes).value()) : void(*seen = bytes.error());
    }
    if (!shared->bytes.empty()) *seen = stages_.observe(*shared);
    loop_.Post([this, shared, seen] {
      OnObserved(shared->vehicle_id, shared->mission_id, shared->capture_id, std::move(*seen));
    });
  });
}

/// Looks again at what arrived before a restart.
void LiveService::ReadPictures(MissionRun& run) {
  while (!run.unread.empty()) {
    const auto capture = std::find_if(run.captures.begin(), run.captures.end(),
                                      [&](const Capture& c) { return c.capture_id == run.unread.front(); });
    if (!TryToObserve(run, *capture)) return;  // At the next tick.
    run.unread.pop_front();
  }
}

void LiveService::OnObserved(std::uint32_t vehicle_id, std::uint64_t mission_id, std::uint32_t capture_id,
                             Result<Observation> seen) {
  MissionRun* run = FindRun(vehicle_id, mission_id);
  if (run == nullptr) return;
  run->unobserved.erase(capture_id);
  PictureResult result{capture_id, ""};
  if (!seen.ok()) {
    result.problem = seen.error().message;
  } else {
    if (!seen.value().image.has_trusted_pose) result.problem = "its pose is not known well enough";
    run->observations.insert_or_assign(capture_id, std::move(seen).value());
  }
  for (PictureTimes& picture : run->log.pictures) {
    if (picture.capture_id != capture_id || picture.observed_s >= 0.0) continue;
    picture.observed_s = SecondsInto(*run);
    picture.problem = result.problem;
  }
  const auto& known = run->mission.pictures;
  const bool is_known = std::any_of(known.begin(), known.end(),
                                    [&](const PictureResult& p) { return p.capture_id == capture_id; });
  if (!is_known) Feed(*run, result);
}

void LiveService::TryToUnderstand(MissionRun& run) {
  if (!run.is_understanding_wanted || run.is_understanding || !run.mission.vehicle) return;
  if (!run.unobserved.empty()) return;
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
  const auto snapshot = Snapshot(*run);
  keeper_.Keep([snapshot, origin = OriginOf(*run)](Store& store) { store.AddScene(*snapshot, origin); });
  Note(*run, "scene", Say("revision ", snapshot->origin.scene_revision));
  Keep(*run);
  scenes_.Publish(snapshot);
  SaveResults(*run);
  Feed(*run, MakeFindings(*run->understanding));
}

/// The picture is on the disk before the store knows of it.
void LiveService::KeepPicture(MissionRun& run, const Capture& capture) {
  run.captures.push_back(capture);
  const auto survey = std::make_shared<Survey>();
  survey->captures = run.captures;
  if (run.mission.vehicle) survey->vehicle = run.mission.vehicle->envelope;
  if (run.mission.vehicle) survey->origin = run.mission.vehicle->origin;
  survey->reference_file = run.reference_file;
  survey->colors = options_.pipeline.mask.colors;
  keeper_.Keep([folder = run.folder, survey, origin = survey->origin](Store& store) {
    Require(WriteSurvey(folder, *survey));
    store.AddCapture(survey->captures.back(), origin);
  });
  run.captures.back().bytes.clear();
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

/// Nobody sees a report that is forgotten by a restart.
void LiveService::PublishReport(MissionRun& run) {
  const bool is_news = UpdateReport(run);
  Keep(run);
  if (is_news) statuses_.Write(*run.published);
}

/// Whether there is something to tell.
bool LiveService::UpdateReport(MissionRun& run) {
  MissionReport& report = run.log.report;
  report.vehicle_id = run.mission.order.vehicle_id;
  report.mission_id = run.mission.order.mission_id;
  report.started_utc_ns = run.started_utc_ns;
  report.status = run.mission.status;
  if (!trouble_.empty()) report.status.problems.push_back("what happens cannot be kept: " + trouble_);
  report.pictures_received = static_cast<std::uint32_t>(run.captures.size());
  report.pictures_used = static_cast<std::uint32_t>(run.observations.size());
  if (run.published && IsShownAlike(*run.published, report)) return false;
  if (!run.published || run.published->status.message != report.status.message) {
    spdlog::info("mission {}: {}: {}", report.mission_id, ToString(report.status.step),
                 report.status.message);
  }
  report.revision += 1;
  report.stamp_utc_ns = Now();
  run.published = report;
  return true;
}

std::shared_ptr<const SceneSnapshot> LiveService::Snapshot(const MissionRun& run) const {
  const std::uint64_t revision = run.understanding ? run.understanding->scene.revision : run.scene_revision;
  return std::make_shared<SceneSnapshot>(
      SceneSnapshot{{run.mission.order.vehicle_id, run.mission.order.mission_id, revision},
                    Now(),
                    run.understanding,
                    run.decisions,
                    run.mission.vehicle ? run.mission.vehicle->envelope : VehicleEnvelope{},
                    run.reference_name});
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
