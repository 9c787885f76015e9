#include "test/bench/rehearsal.h"

#include <deque>
#include <fstream>
#include <map>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "service/edge/files/survey.h"
#include "service/edge/live/findings.h"
#include "test/sim/draw/dice.h"
#include "test/sim/flight/recorder.h"
#include "test/sim/render/renderer.h"
#include "test/sim/survey/reference.h"
#include "test/sim/world/space.h"

namespace soffit::bench {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kBegin_utc_ns = 1'750'000'000'000'000'000;
constexpr std::int64_t kEvent_ns = 100'000'000;
constexpr std::uint32_t kVehicleId = 1;
constexpr int kMostEvents = 2000;
constexpr double kTrackStep_m = 0.01;
constexpr double kHover_m = 0.03;                             // How well the vehicle holds its place,
constexpr double kSway_rad = 0.4 * std::numbers::pi / 180.0;  // and its attitude.

Eigen::Quaterniond Turn(const Vector3d& rotation) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(rotation.norm(), rotation.stableNormalized()));
}

class Rehearsal {
 public:
  Rehearsal(const sim::World& world, std::uint64_t seed, const PipelineOptions& pipeline,
            const MissionOptions& options)
      : world_(world),
        pipeline_(pipeline),
        options_(options),
        dice_(seed),
        noise_seed_(sim::Mix(seed)),
        truth_(sim::FindTruth(world)),
        space_(world),
        recorder_(world, space_, truth_),
        renderer_(world, 1) {
    pipeline_.viewpoint.overview_altitude_m = world.mission.overview_altitude_m;
    state_.vehicle_id = kVehicleId;
    state_.agent_epoch = 1;
    state_.phase = VehiclePhase::kOnGround;
    state_.envelope = world.vehicle;
    state_.camera = world.camera.intrinsics;
    state_.max_speed_mps = 5.0;
  }

  void Run() {
    const Result<Reference> reference = ReadReference(sim::DrawReference(world_));
    if (!reference.ok())
      throw ContractViolation("the drawn reference cannot be read: " + reference.error().message);
    reference_ = reference.value();
    MissionOrder order;
    order.vehicle_id = kVehicleId;
    order.mission_id = 1;
    order.area_center_in_map_m = world_.mission.area_center_m;
    mission_ = StartMission(order);
    for (int i = 0; i < kMostEvents && mission_.status.state != MissionState::kEnded; ++i) {
      events_.push_back(Stamped());
      while (!events_.empty()) {
        const MissionEvent event = events_.front();
        events_.pop_front();
        Feed(event);
      }
    }
  }

  RehearsalResult Judge() const {
    RehearsalResult result;
    result.expected = truth_.expected;
    result.outcome = mission_.status.outcome;
    result.message = mission_.status.message;
    result.pictures = static_cast<int>(captures_.size());
    result.contacts = static_cast<int>(recorder_.contacts().size());
    if (!recorder_.contacts().empty()) {
      const sim::Contact& contact = recorder_.contacts().front();
      std::ostringstream text;
      text << "touched " << contact.with << " at " << contact.position_m.transpose() << "; ";
      result.first_contact = text.str();
    }
    const nlohmann::json flight = recorder_.ToJson();
    result.was_passage_flown = flight["passage_flown"].get<bool>();
    for (const sim::FlightUnder& under : recorder_.flights_under())
      result.was_flown_wrongly |= !under.is_passable;
    if (flight["least_distance_m"].is_number())
      result.least_distance_m = flight["least_distance_m"].get<double>();
    result.nearest = flight["nearest"].get<std::string>();
    return result;
  }

  Status Keep(const std::filesystem::path& folder) const {
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "world.yaml") << sim::FormatWorld(world_);
    cv::imwrite((folder / "reference.png").string(), sim::DrawReference(world_));
    Survey survey;
    survey.captures = captures_;
    survey.vehicle = world_.vehicle;
    survey.reference_file = "reference.png";
    survey.colors = pipeline_.mask.colors;
    return WriteSurvey(folder, survey);
  }

 private:
  VehicleState Stamped() {
    state_.stamp_utc_ns = now_;
    return state_;
  }

  void Feed(const MissionEvent& event) {
    now_ += kEvent_ns;
    MissionUpdate update = Advance(std::move(mission_), event, now_, pipeline_.viewpoint, options_);
    mission_ = std::move(update.mission);
    for (const FlightCommand& command : update.commands) Obey(command);
    if (update.wants_findings) events_.push_back(Understood());
  }

  void Obey(const FlightCommand& command) {
    Answer(command, AckStatus::kAccepted);
    for (const Vector3d& place : command.path_in_map_m) {
      if (command.kind == CommandKind::kTakeOff) {
        FlyTo({state_.position_in_map_m.x(), state_.position_in_map_m.y(), place.z()});
      } else {
        FlyTo(place);
      }
    }
    state_.yaw_rad = command.yaw_rad;
    state_.armed = command.kind != CommandKind::kLand;
    state_.phase = state_.armed ? VehiclePhase::kHolding : VehiclePhase::kOnGround;
    if (command.kind == CommandKind::kLook) TakePicture(command);
    Answer(command, AckStatus::kDone);
  }

  void Answer(const FlightCommand& command, AckStatus status) {
    CommandAck ack;
    ack.vehicle_id = command.vehicle_id;
    ack.mission_id = command.mission_id;
    ack.sequence = command.sequence;
    ack.agent_epoch = state_.agent_epoch;
    ack.status = status;
    events_.push_back(ack);
  }

  Vector3d Draw(double std) { return std * Vector3d(dice_.Normal(), dice_.Normal(), dice_.Normal()); }

  /// The vehicle truly is off its path by what it errs about its place.
  void FlyTo(const Vector3d& believed_m) {
    offset_m_ = Draw(world_.pose_noise.position_std_m);
    const Vector3d from = true_m_;
    const Vector3d to = believed_m + offset_m_;
    const int steps = 1 + static_cast<int>((to - from).norm() / kTrackStep_m);
    for (int i = 1; i <= steps; ++i) {
      recorder_.Add(
          {static_cast<double>(now_ - kBegin_utc_ns) * 1e-9, from + (to - from) * i / steps, false, 0.0});
    }
    true_m_ = to;
    state_.position_in_map_m = believed_m;
  }

  void TakePicture(const FlightCommand& command) {
    Capture capture;
    capture.vehicle_id = kVehicleId;
    capture.mission_id = command.mission_id;
    capture.capture_id = command.capture_id;
    capture.purpose = command.purpose;
    capture.exposure_utc_ns = now_;
    capture.name = std::to_string(command.capture_id) + "_" + ToString(command.purpose) + ".jpg";
    capture.intrinsics = world_.camera.intrinsics;
    capture.has_trusted_pose = true;
    capture.position_std_m = world_.pose_noise.position_std_m;
    capture.orientation_std_rad = world_.pose_noise.orientation_std_rad;
    const Vector3d hover_m = Draw(kHover_m);
    const Eigen::Quaterniond attitude =
        Turn(Draw(kSway_rad)) * CameraAttitude(command.yaw_rad, command.camera_pitch_rad);
    capture.map_from_camera = {attitude.normalized(), state_.position_in_map_m + hover_m};
    const Pose<Map, Camera> truly = {
        (Turn(Draw(world_.pose_noise.orientation_std_rad)) * attitude).normalized(), true_m_ + hover_m};
    const cv::Mat3b picture = renderer_.Render({{truly}, noise_seed_ + command.capture_id});
    capture.bytes = sim::EncodeJpeg(picture, world_.camera.jpeg_quality, now_);
    Result<Observation> seen = Observe(capture, pipeline_);
    events_.push_back(PictureResult{command.capture_id, seen.ok() ? "" : seen.error().message});
    if (seen.ok()) observations_[command.capture_id] = std::move(seen).value();
    captures_.push_back(std::move(capture));
  }

  Findings Understood() {
    std::vector<Observation> observations;
    for (const auto& [id, seen] : observations_) observations.push_back(seen);
    Understanding all = Understand(observations, reference_, world_.vehicle, ++revision_, pipeline_);
    for (ClearanceDecision& decision : all.decisions) {
      decision.vehicle_id = kVehicleId;
      decision.decision_id = ++last_decision_id_;
    }
    return MakeFindings(all);
  }

  const sim::World& world_;
  PipelineOptions pipeline_;
  const MissionOptions& options_;
  sim::Dice dice_;
  std::uint64_t noise_seed_;
  sim::Truth truth_;
  sim::Space space_;
  sim::FlightRecorder recorder_;
  sim::Renderer renderer_;
  Reference reference_;
  Mission mission_;
  VehicleState state_;
  std::deque<MissionEvent> events_;
  std::vector<Capture> captures_;
  std::map<std::uint32_t, Observation> observations_;
  Vector3d true_m_ = Vector3d::Zero();
  Vector3d offset_m_ = Vector3d::Zero();
  std::int64_t now_ = kBegin_utc_ns;
  std::uint64_t revision_ = 0;
  std::uint64_t last_decision_id_ = 0;
};

}  // namespace

bool RehearsalResult::IsRight() const {
  if (contacts > 0 || was_flown_wrongly) return false;
  switch (expected) {
    case sim::Outcome::kFlown:
      return outcome == MissionOutcome::kFlown && was_passage_flown;
    case sim::Outcome::kNotFlown:
      return !was_passage_flown &&
             (outcome == MissionOutcome::kBlocked || outcome == MissionOutcome::kInsufficientData);
    case sim::Outcome::kNoMatch:
      return !was_passage_flown && outcome == MissionOutcome::kNoMatch;
  }
  return false;
}

RehearsalResult Rehearse(const sim::World& world, std::uint64_t seed, const PipelineOptions& pipeline,
                         const MissionOptions& mission, const std::filesystem::path& folder) {
  Rehearsal rehearsal(world, seed, pipeline, mission);
  rehearsal.Run();
  if (!folder.empty()) {
    const Status kept = rehearsal.Keep(folder);
    if (!kept.ok()) throw ContractViolation(kept.error().message);
  }
  return rehearsal.Judge();
}

}  // namespace soffit::bench
