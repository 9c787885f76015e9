#pragma once

#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "service/edge/dds/service_topics.h"
#include "service/edge/live/event_loop.h"
#include "service/edge/live/scene_server.h"
#include "service/edge/live/service_options.h"
#include "service/edge/live/thread_pool.h"
#include "service/edge/store/keeper.h"
#include "shared/dds/reader.h"
#include "shared/dds/writer.h"
#include "shared/wire/topics.h"

namespace soffit {

/// The work on pictures, as pipeline/ does it. Called from several threads at once.
struct Stages {
  std::function<Result<Observation>(const Capture&)> observe;
  std::function<Understanding(const std::vector<Observation>&, const Reference&, const VehicleEnvelope&,
                              std::uint64_t revision)>
      understand;
};

/// One mission as the service leads it.
struct MissionRun : KeptMission {
  Reference reference;
  std::filesystem::path folder;

  std::map<std::uint32_t, Observation> observations;
  std::set<std::uint32_t> unobserved;  ///< Pictures that are being worked on, or wait for it.
  std::deque<std::uint32_t> unread;    ///< Those of them that have to be read from the disk first.
  std::uint64_t scene_revision = 0;
  bool is_understanding_wanted = false;
  bool is_understanding = false;
  std::shared_ptr<const Understanding> understanding;  ///< Null: none yet.
  std::vector<DecisionReport> decisions;               ///< Of `understanding`.

  std::optional<MissionReport> published;  ///< The newest.

  MissionRecord kept;              ///< As it was given to the keeper last.
  std::vector<JournalEntry> news;  ///< Not yet given to it, as is the track from here on.
  std::size_t track_kept = 0;
};

/// The ground service: leads a mission for each vehicle, over DDS. Everything happens on one thread (Run),
/// but for work on pictures and files, which threads of their own do on values; what they made comes back as
/// a task of that thread.
class LiveService {
 public:
  /// Joins both domains, and goes on with the missions that the store has. An error when a domain, the data
  /// folder or the store cannot be used. A store that can only be read is told, and does.
  static Result<std::unique_ptr<LiveService>> Start(const ServiceOptions& options, Stages stages);
  ~LiveService();

  void Run();   ///< Until Stop().
  void Stop();  ///< From any thread.

 private:
  LiveService(const ServiceOptions& options, Stages stages, Participant radio, Participant local,
              std::vector<KeptRun> kept);

  // What others say.
  void OnState(const VehicleState& state);
  void OnAck(const CommandAck& ack);
  void OnCapture(Capture capture);
  void OnRequest(const MissionRequest& request);
  void OnTick();

  // Missions.
  MissionReply Serve(const MissionRequest& request);
  MissionReply StartFlight(const MissionRequest& request);
  MissionReply Wish(const MissionRequest& request, OperatorWish wish);
  MissionRun* FindRun(std::uint32_t vehicle_id, std::uint64_t mission_id);
  void Feed(MissionRun& run, const MissionEvent& event);
  void Restore(KeptRun kept);
  void NoteDecisions(MissionRun& run);
  void NoteStep(MissionRun& run);
  void Note(MissionRun& run, const char* kind, std::string text);
  void Keep(MissionRun& run);
  void KeepTrack(MissionRun& run);

  // Pictures.
  bool TryToObserve(MissionRun& run, const Capture& capture);
  void ReadPictures(MissionRun& run);
  void OnObserved(std::uint32_t vehicle_id, std::uint64_t mission_id, std::uint32_t capture_id,
                  Result<Observation> seen);
  void TryToUnderstand(MissionRun& run);
  void OnUnderstood(std::uint32_t vehicle_id, std::uint64_t mission_id, std::shared_ptr<Understanding> all,
                    const std::string& failure);
  void KeepPicture(MissionRun& run, const Capture& capture);
  void SaveResults(const MissionRun& run);
  void SaveLog(const MissionRun& run);
  void OnDisk(const std::string& what, std::function<Status()> write);

  // What it tells.
  bool UpdateReport(MissionRun& run);
  void PublishReport(MissionRun& run);
  std::shared_ptr<const SceneSnapshot> Snapshot(const MissionRun& run) const;
  void PublishHeartbeats();
  double SecondsInto(const MissionRun& run) const;

  ServiceOptions options_;
  Stages stages_;
  std::int64_t epoch_utc_ns_;
  std::uint64_t last_mission_id_ = 0;
  std::uint64_t last_decision_id_;
  std::map<std::uint32_t, MissionRun> runs_;  ///< The newest of each vehicle.
  std::map<std::uint32_t, VehicleState> vehicles_;
  std::deque<MissionReply> replies_;  ///< The latest: a resent request gets its answer again.
  std::string trouble_;               ///< Of the store; empty: none.

  EventLoop loop_;
  Participant radio_;
  Participant local_;
  Writer<FlightCommandTopic> commands_;
  Writer<MissionHeartbeatTopic> heartbeats_;
  Writer<MissionReplyTopic> mission_replies_;
  Writer<MissionStatusTopic> statuses_;
  SceneServer scenes_;
  Reader<VehicleStateTopic> states_;
  Reader<CommandAckTopic> acks_;
  Reader<CaptureTopic> captures_;
  Reader<MissionRequestTopic> requests_;
  ThreadPool workers_;
  ThreadPool disk_;  ///< One thread: files are written in order.
  Keeper keeper_;
};

}  // namespace soffit
