#include "service/edge/live/live_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "service/edge/cli/request_client.h"
#include "service/edge/files/survey.h"

namespace soffit {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr VehicleEnvelope kEnvelope{0.35, 0.30, 0.25};

DdsOptions Loopback(int offset) {
  DdsOptions options;
  options.domain_id = 100 + static_cast<int>((getpid() * 2 + offset) % 100);
  options.udp_only = true;
  options.interfaces = {"127.0.0.1"};
  return options;
}

std::vector<std::uint8_t> ReferencePicture() {
  cv::Mat1b bitmap(120, 160, uchar{255});
  cv::rectangle(bitmap, {40, 40, 80, 30}, cv::Scalar(0), cv::FILLED);
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", bitmap, bytes);
  return bytes;
}

/// Stands for the stages: every picture shows the same building, with a way through it.
Understanding SeeAnArch(std::uint64_t revision, const VehicleEnvelope& vehicle) {
  Understanding all;
  all.scene.revision = revision;
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  tree->updateNode(octomap::point3d(0.05F, 5.05F, 0.85F), false);
  tree->updateNode(octomap::point3d(0.05F, 7.05F, 2.05F), true);
  all.scene.octree = tree;
  SceneObject object;
  object.footprint.object_id = 1;
  object.footprint.color = "yellow";
  object.footprint.polygon_in_map_m.outer = {{-2, 6}, {2, 6}, {2, 8}, {-2, 8}};
  object.footprint.height_m = 2.3;
  object.is_matched = true;
  all.scene.objects = {object};
  all.matches.emplace_back();
  all.matches.front().shapes = {0};
  ClearanceDecision decision;
  decision.object_id = 1;
  decision.side = 0;
  decision.verdict = Verdict::kClear;
  decision.reason = "clear";
  decision.vehicle = vehicle;
  decision.scene_revision = revision;
  decision.corridor.emplace();
  decision.corridor->entry_in_map_m = {0, 4.5, 0.8};
  decision.corridor->exit_in_map_m = {0, 9.5, 0.8};
  decision.corridor->free_width_m = 1.6;
  decision.corridor->free_height_m = 1.5;
  all.decisions = {decision};
  return all;
}

Stages FakeStages() {
  return {[](const Capture& capture) -> Result<Observation> {
            if (capture.bytes.size() < 10) return InvalidInput("not a picture");
            Observation seen;
            seen.image.capture_id = capture.capture_id;
            seen.image.purpose = capture.purpose;
            seen.image.has_trusted_pose = capture.has_trusted_pose;
            return seen;
          },
          [](const std::vector<Observation>&, const Reference&, const VehicleEnvelope& vehicle,
             std::uint64_t revision) { return SeeAnArch(revision, vehicle); }};
}

/// An agent whose vehicle does quickly what it is told, but not so quickly that no heartbeat falls into a
/// mission.
class FakeAgent {
 public:
  FakeAgent(std::uint32_t vehicle_id, std::uint64_t epoch)
      : participant_(Participant::Join("agent", Loopback(0), {}).value()),
        states_(participant_),
        acks_(participant_),
        captures_(participant_),
        commands_(participant_, [this](const FlightCommand& command) { Obey(command); }),
        heartbeats_(participant_, [this](const MissionHeartbeat& heartbeat) {
          beats += heartbeat.vehicle_id == state_.vehicle_id;
        }) {
    state_.vehicle_id = vehicle_id;
    state_.agent_epoch = epoch;
    state_.phase = VehiclePhase::kOnGround;
    state_.envelope = kEnvelope;
    state_.camera = {1280, 960, 850.0, 850.0, 639.5, 479.5, {}};
    state_.max_speed_mps = 5.0;
    thread_ = std::jthread([this](std::stop_token stop) {
      while (!stop.stop_requested()) {
        Report();
        std::this_thread::sleep_for(50ms);
      }
    });
  }

  std::atomic<int> spoiled_pictures = 0;  ///< So many are sent broken first.
  std::atomic<int> beats = 0;

 private:
  void Report() {
    const std::lock_guard lock(mutex_);
    states_.Write(state_);
  }

  void Obey(const FlightCommand& command) {
    std::this_thread::sleep_for(80ms);
    const std::lock_guard lock(mutex_);
    if (command.vehicle_id != state_.vehicle_id) return;
    if (!command.path_in_map_m.empty()) state_.position_in_map_m = command.path_in_map_m.back();
    state_.armed = command.kind != CommandKind::kLand;
    state_.phase = state_.armed ? VehiclePhase::kHolding : VehiclePhase::kOnGround;
    states_.Write(state_);
    if (command.kind == CommandKind::kLook) Expose(command);
    for (const AckStatus status : {AckStatus::kAccepted, AckStatus::kDone}) {
      acks_.Write(
          {command.vehicle_id, command.mission_id, command.sequence, state_.agent_epoch, 0, status, ""});
    }
  }

  void Expose(const FlightCommand& command) {
    Capture capture;
    capture.vehicle_id = command.vehicle_id;
    capture.mission_id = command.mission_id;
    capture.capture_id = command.capture_id;
    capture.purpose = command.purpose;
    capture.intrinsics = state_.camera;
    capture.has_trusted_pose = true;
    capture.map_from_camera.translation_m = command.path_in_map_m.back();
    capture.bytes.assign(spoiled_pictures-- > 0 ? 5 : 100'000, 0xff);
    captures_.Write(capture);
  }

  std::mutex mutex_;
  VehicleState state_;
  Participant participant_;
  Writer<VehicleStateTopic> states_;
  Writer<CommandAckTopic> acks_;
  Writer<CaptureTopic> captures_;
  Reader<FlightCommandTopic> commands_;
  Reader<MissionHeartbeatTopic> heartbeats_;
  std::jthread thread_;
};

class Live : public testing::Test {
 protected:
  Live() {
    options_.radio = Loopback(0);
    options_.local = Loopback(1);
    options_.mission.retry_delay_s = 0.1;
    options_.mission.picture_timeout_s = 3.0;
    folder_ = fs::temp_directory_path() / ("soffit-live-test-" + std::to_string(getpid()));
    options_.data_folder = folder_.string();
    Begin();
  }
  ~Live() override {
    End();
    fs::remove_all(folder_);
  }

  void Begin() {
    service_ = LiveService::Start(options_, FakeStages()).value();
    thread_ = std::thread([this] { service_->Run(); });
  }
  void End() {  ///< Finishes what is to be written.
    service_->Stop();
    thread_.join();
    service_.reset();
  }

  MissionReply Start(std::uint32_t vehicle_id, std::vector<std::uint8_t> reference = ReferencePicture()) {
    MissionRequest request;
    request.kind = MissionRequestKind::kStart;
    request.vehicle_id = vehicle_id;
    request.reference_name = "reference.png";
    request.reference = std::move(reference);
    return Ask(request);
  }
  MissionReply Ask(const MissionRequest& request) { return missions_.Ask(request, 10s).value(); }

  /// The newest report that fulfils `condition`; a default one when none came within 20 s.
  MissionReport Await(const std::function<bool(const MissionReport&)>& condition) {
    std::unique_lock lock(mutex_);
    const auto found = [&] { return std::any_of(reports_.begin(), reports_.end(), condition); };
    if (!changed_.wait_for(lock, 20s, found)) return {};
    return *std::find_if(reports_.rbegin(), reports_.rend(), condition);
  }
  MissionReport AwaitEnd(std::uint64_t mission_id) {
    return Await([&](const MissionReport& r) {
      return r.mission_id == mission_id && r.status.state == MissionState::kEnded;
    });
  }

  ServiceOptions options_;
  fs::path folder_;
  std::unique_ptr<LiveService> service_;
  std::thread thread_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<MissionReport> reports_;
  Participant operator_ = Participant::Join("operator", Loopback(1), {}).value();
  MissionClient missions_{operator_};
  SceneClient scenes_{operator_};
  Reader<MissionStatusTopic> watch_{operator_, [this](MissionReport report) {
                                      const std::lock_guard lock(mutex_);
                                      reports_.push_back(std::move(report));
                                      changed_.notify_all();
                                    }};
};

TEST_F(Live, FliesAMissionAndKeepsEverythingOfIt) {
  const FakeAgent agent(1, 11);
  const MissionReply reply = Start(1);
  ASSERT_TRUE(reply.is_accepted) << reply.message;
  const MissionReport end = AwaitEnd(reply.mission_id);
  ASSERT_EQ(end.status.outcome, MissionOutcome::kFlown) << end.status.message;
  EXPECT_GT(end.picture_to_decision_max_s, 0.0);
  EXPECT_EQ(end.pictures_received, end.pictures_used);
  EXPECT_GT(agent.beats, 0);

  End();
  const fs::path folder = folder_ / ("mission-" + std::to_string(reply.mission_id));
  for (const char* file :
       {"reference.png", "survey.json", "mission.json", "track.csv", "result.json", "scene.bt"}) {
    EXPECT_TRUE(fs::exists(folder / file)) << file;
  }
  const auto survey = ReadSurvey(folder);
  ASSERT_TRUE(survey.ok()) << survey.error().message;
  EXPECT_EQ(survey.value().captures.size(), end.pictures_received);
  EXPECT_EQ(survey.value().vehicle.radius_m, kEnvelope.radius_m);
  Begin();
}

TEST_F(Live, GoesOnWithAMissionWhereItWasWhenItWasStopped) {
  const FakeAgent agent(1, 11);
  const MissionReply reply = Start(1);
  for (const MissionStep step : {MissionStep::kOverview, MissionStep::kWalls, MissionStep::kLookAgain}) {
    ASSERT_EQ(Await([&](const MissionReport& r) { return r.status.step == step; }).mission_id,
              reply.mission_id);
    End();
    Begin();
  }
  const MissionReport end = AwaitEnd(reply.mission_id);
  EXPECT_EQ(end.status.outcome, MissionOutcome::kFlown) << end.status.message;
  std::uint32_t revision = 0;  // Nobody sees a report, or a picture, taken back.
  std::uint32_t pictures = 0;
  const std::lock_guard lock(mutex_);
  for (const MissionReport& report : reports_) {
    EXPECT_GT(report.revision, revision);
    EXPECT_GE(report.pictures_received, pictures);
    revision = report.revision;
    pictures = report.pictures_received;
  }
}

TEST_F(Live, PublishesTheSameSceneAfterARestart) {
  const FakeAgent agent(1, 11);
  ASSERT_EQ(AwaitEnd(Start(1).mission_id).status.outcome, MissionOutcome::kFlown);
  SceneQuery revisions;
  revisions.vehicle_id = 1;
  revisions.kind = SceneQueryKind::kRevisions;
  const SceneReply before = scenes_.Ask(revisions, 10s).value();
  End();
  const auto began = std::chrono::steady_clock::now();
  Begin();
  const SceneReply after = scenes_.Ask(revisions, 10s).value();
  EXPECT_LT(std::chrono::steady_clock::now() - began, 3s);
  EXPECT_EQ(after.origin.scene_revision, before.origin.scene_revision);
  EXPECT_EQ(after.stamp_utc_ns, before.stamp_utc_ns);
  ASSERT_EQ(after.revisions.size(), before.revisions.size());
  EXPECT_EQ(after.revisions[0].octree_nodes, before.revisions[0].octree_nodes);
  SceneQuery clearance = revisions;
  clearance.kind = SceneQueryKind::kClearance;
  clearance.object_id = 1;
  EXPECT_EQ(scenes_.Ask(clearance, 10s).value().decisions[0].decision.verdict, Verdict::kClear);
}

TEST_F(Live, FliesOnAndSaysSoWhenNothingCanBeKept) {
  const FakeAgent agent(1, 11);
  fs::remove_all(folder_);
  std::ofstream(folder_) << "no folder any more";
  const MissionReply reply = Start(1);
  ASSERT_TRUE(reply.is_accepted);
  const MissionReport end = AwaitEnd(reply.mission_id);
  EXPECT_EQ(end.status.outcome, MissionOutcome::kFlown) << end.status.message;
  EXPECT_THAT(end.status.problems, testing::Contains(HasSubstr("cannot be kept")));
}

TEST_F(Live, LeadsSeveralVehiclesAtOnce) {
  const FakeAgent first(1, 11);
  const FakeAgent second(2, 22);
  const MissionReply one = Start(1);
  const MissionReply two = Start(2);
  ASSERT_TRUE(one.is_accepted && two.is_accepted);
  EXPECT_NE(one.mission_id, two.mission_id);
  EXPECT_EQ(AwaitEnd(one.mission_id).status.outcome, MissionOutcome::kFlown);
  EXPECT_EQ(AwaitEnd(two.mission_id).status.outcome, MissionOutcome::kFlown);
}

TEST_F(Live, SaysThatAReferenceIsMalformedAndGoesOn) {
  const FakeAgent agent(1, 11);
  const MissionReply bad = Start(1, {1, 2, 3});
  EXPECT_FALSE(bad.is_accepted);
  EXPECT_THAT(bad.message, HasSubstr("reference"));
  EXPECT_EQ(AwaitEnd(bad.mission_id).status.outcome, MissionOutcome::kFailed);
  const MissionReply good = Start(1);
  EXPECT_TRUE(good.is_accepted) << good.message;
  EXPECT_EQ(AwaitEnd(good.mission_id).status.outcome, MissionOutcome::kFlown);
}

TEST_F(Live, SaysThatNoAgentIsHeard) {
  const MissionReply reply = Start(3);
  ASSERT_TRUE(reply.is_accepted);
  const MissionReport report =
      Await([](const MissionReport& r) { return r.status.message.find("no agent") != std::string::npos; });
  EXPECT_EQ(report.mission_id, reply.mission_id);
}

TEST_F(Live, TakesABrokenPictureAgain) {
  FakeAgent agent(1, 11);
  agent.spoiled_pictures = 1;
  const MissionReply reply = Start(1);
  const MissionReport end = AwaitEnd(reply.mission_id);
  EXPECT_EQ(end.status.outcome, MissionOutcome::kFlown);
  EXPECT_THAT(end.status.problems, testing::Contains(HasSubstr("not a picture")));
}

TEST_F(Live, SaysThatASecondAgentHasTheSameVehicleId) {
  const FakeAgent first(1, 11);
  const FakeAgent second(1, 22);
  const MissionReply reply = Start(1);
  const MissionReport report = Await([](const MissionReport& r) {
    return std::any_of(r.status.problems.begin(), r.status.problems.end(), [](const std::string& problem) {
      return problem.find("second agent") != std::string::npos;
    });
  });
  EXPECT_EQ(report.mission_id, reply.mission_id);
}

TEST_F(Live, RefusesASecondMissionForAVehicleThatFliesOne) {
  ASSERT_TRUE(Start(3).is_accepted);
  const MissionReply second = Start(3);
  EXPECT_FALSE(second.is_accepted);
  EXPECT_THAT(second.message, HasSubstr("abort"));
  MissionRequest abort;
  abort.kind = MissionRequestKind::kAbort;
  abort.vehicle_id = 3;
  EXPECT_TRUE(Ask(abort).is_accepted);
  EXPECT_TRUE(Start(3).is_accepted);
}

TEST_F(Live, AnswersQuestionsAboutTheScene) {
  const FakeAgent agent(1, 11);
  const MissionReply reply = Start(1);
  ASSERT_EQ(AwaitEnd(reply.mission_id).status.outcome, MissionOutcome::kFlown);

  SceneQuery query;
  query.vehicle_id = 1;
  query.kind = SceneQueryKind::kPoint;
  query.from_in_map_m = {0.05, 5.05, 0.85};
  EXPECT_EQ(scenes_.Ask(query, 10s).value().occupancy, Occupancy::kFree);
  query.from_in_map_m = {0.05, 7.05, 2.05};
  EXPECT_EQ(scenes_.Ask(query, 10s).value().occupancy, Occupancy::kOccupied);
  query.from_in_map_m = {50, 50, 50};
  EXPECT_EQ(scenes_.Ask(query, 10s).value().occupancy, Occupancy::kUnknown);

  query.kind = SceneQueryKind::kClearance;
  query.object_id = 1;
  const SceneReply clearance = scenes_.Ask(query, 10s).value();
  ASSERT_EQ(clearance.decisions.size(), 1u);
  EXPECT_EQ(clearance.decisions[0].decision.verdict, Verdict::kClear);
  query.object_id = 9;
  EXPECT_EQ(scenes_.Ask(query, 10s).value().status, AnswerStatus::kNotFound);
}

TEST(LiveService, SaysThatTheStoreBelongsToSomethingElse) {
  ServiceOptions options;
  options.data_folder = fs::temp_directory_path() / ("soffit-live-test-foreign-" + std::to_string(getpid()));
  options.store = (fs::path(options.data_folder) / "other.gpkg").string();
  fs::create_directories(options.data_folder);
  std::ofstream(options.store) << "a picture of a cat";
  const auto service = LiveService::Start(options, FakeStages());
  fs::remove_all(options.data_folder);
  ASSERT_FALSE(service.ok());
  EXPECT_THAT(service.error().message, HasSubstr("other.gpkg"));
}

TEST(LiveService, SaysThatTheDataFolderCannotBeMade) {
  ServiceOptions options;
  options.data_folder = "/proc/no/such/folder";
  const auto service = LiveService::Start(options, FakeStages());
  ASSERT_FALSE(service.ok());
  EXPECT_THAT(service.error().message, HasSubstr("/proc/no/such/folder"));
}

}  // namespace
}  // namespace soffit
