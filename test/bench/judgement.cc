#include "test/bench/judgement.h"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <optional>

#include "service/edge/files/outputs.h"
#include "service/edge/files/survey.h"
#include "test/sim/survey/reference.h"
#include "test/sim/survey/survey.h"
#include "test/sim/world/space.h"

namespace soffit::bench {
namespace {

using Eigen::Vector3d;

constexpr double kMostMargin_m = 1.0;
constexpr double kRounding_m = 1e-3;
constexpr double kSamePlace_m = 0.5;
constexpr std::uint32_t kVehicleId = 1;

double CpuSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// The largest margin on all sides with which the vehicle flies along without touching anything; negative: it
/// touches something by itself.
double FindMargin_m(const sim::Space& space, const VehicleEnvelope& vehicle, const Corridor& way) {
  const auto is_free = [&](double margin_m) {
    const sim::Cylinder swept{way.entry_in_map_m, vehicle.radius_m + margin_m,
                              vehicle.height_m + 2.0 * margin_m};
    return space.IsFreeAlong(swept, way.exit_in_map_m);
  };
  if (!is_free(0.0)) return -1.0;
  double low = 0.0, high = kMostMargin_m;
  while (high - low > 1e-4) {
    const double middle = 0.5 * (low + high);
    (is_free(middle) ? low : high) = middle;
  }
  return low;
}

class Judge {
 public:
  Judge(const sim::World& world, std::uint64_t seed)
      : world_(world), seed_(seed), dice_(sim::Mix(seed)), space_(world), renderer_(world, 1) {
    options_.viewpoint.overview_altitude_m = world.mission.overview_altitude_m;
    Result<Reference> reference = ReadReference(sim::DrawReference(world));
    if (!reference.ok()) throw ContractViolation("the drawn reference cannot be read");
    reference_ = std::move(reference).value();
    survey_ = sim::RenderSurvey(world, renderer_, seed);
    for (std::size_t i = 0; i < survey_.frames.size(); ++i) Observe(i);
    Understand();
  }

  /// Takes the picture that the decision asks for; false: it asks for none, or decided.
  bool LookAgain() {
    const auto wanting = std::find_if(decisions().begin(), decisions().end(),
                                      [](const ClearanceDecision& d) { return d.wanted.has_value(); });
    if (BestDecision() != Verdict::kInsufficientData || wanting == decisions().end()) return false;
    const Viewpoint look = *wanting->wanted;
    if (space_.DistanceToBodies({look.position_in_map_m, 0.01, 0.01}, world_.vehicle.radius_m).distance_m <
        world_.vehicle.radius_m)
      return false;
    const std::size_t index = survey_.frames.size();
    survey_.frames.push_back({"look_" + std::to_string(index) + ".jpg", look.purpose, "", 0.0, {}, {}});
    sim::SurveyFrame& frame = survey_.frames.back();
    frame.reported = {CameraAttitude(look.yaw_rad, look.pitch_rad), look.position_in_map_m};
    frame.map_from_camera = Err(frame.reported);
    const cv::Mat3b picture = renderer_.Render({{frame.map_from_camera}, sim::Mix(seed_) + index});
    survey_.jpegs.push_back(sim::EncodeJpeg(picture, world_.camera.jpeg_quality, 0));
    Observe(index);
    Understand();
    return true;
  }

  Judgement Conclude() const {
    Judgement judgement;
    judgement.kind = world_.title.substr(0, world_.title.find(','));
    judgement.seed = seed_;
    judgement.pictures = static_cast<int>(survey_.frames.size());
    if (const sim::ObjectTruth* wanted = FindTruly(world_.mission.wanted.front());
        wanted != nullptr && !wanted->passages.empty()) {
      judgement.is_passable = wanted->passages.front().is_passable;
      judgement.spare_m = wanted->passages.front().spare_m;
    }
    if (const std::optional<Verdict> best = BestDecision()) judgement.decision = ToString(*best);
    for (const ClearanceDecision& decision : decisions()) {
      if (IsOnWanted(decision) && ToString(decision.verdict) == judgement.decision &&
          judgement.reason.empty())
        judgement.reason = decision.reason;
      if (decision.verdict == Verdict::kClear) Check(decision, judgement);
    }
    if (judgement.decision == "none" && !analysis_.understanding.problems.empty())
      judgement.reason = analysis_.understanding.problems.front();
    return judgement;
  }

  void Keep(const std::filesystem::path& folder) const {
    Status kept = sim::WriteSurvey(world_, survey_, folder);
    std::ofstream(folder / "world.yaml") << sim::FormatWorld(world_);
    if (kept.ok()) kept = WriteOutputs(folder / "analysis", analysis_, {});
    if (!kept.ok()) throw ContractViolation(kept.error().message);
  }

 private:
  const std::vector<ClearanceDecision>& decisions() const { return analysis_.understanding.decisions; }

  Pose<Map, Camera> Err(const Pose<Map, Camera>& pose) {
    const sim::PoseNoise& noise = world_.pose_noise;
    const auto draw = [&] { return Vector3d(dice_.Normal(), dice_.Normal(), dice_.Normal()); };
    const Vector3d turn = noise.orientation_std_rad * draw();
    const Eigen::Quaterniond wrong(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
    return {(wrong * pose.rotation).normalized(), pose.translation_m + noise.position_std_m * draw()};
  }

  void Observe(std::size_t index) {
    const sim::SurveyFrame& frame = survey_.frames[index];
    Capture capture;
    capture.vehicle_id = kVehicleId;
    capture.capture_id = static_cast<std::uint32_t>(index + 1);
    capture.name = frame.file;
    capture.purpose = frame.purpose;
    capture.intrinsics = world_.camera.intrinsics;
    capture.map_from_camera = frame.reported;
    capture.has_trusted_pose = true;
    capture.position_std_m = world_.pose_noise.position_std_m;
    capture.orientation_std_rad = world_.pose_noise.orientation_std_rad;
    capture.bytes = survey_.jpegs[index];
    Result<Observation> seen = soffit::Observe(capture, options_);
    if (seen.ok()) analysis_.observations.push_back(std::move(seen).value());
  }

  void Understand() {
    analysis_.understanding =
        soffit::Understand(analysis_.observations, reference_, world_.vehicle, ++revision_, options_);
  }

  const sim::ObjectTruth* FindTruly(const std::string& id) const {
    const auto& objects = survey_.truth.objects;
    const auto found = std::find_if(objects.begin(), objects.end(),
                                    [&](const sim::ObjectTruth& object) { return object.id == id; });
    return found == objects.end() ? nullptr : &*found;
  }

  /// The building that a decision is about; null: there is none.
  const sim::ObjectTruth* FindTruly(const ClearanceDecision& decision) const {
    for (const SceneObject& object : analysis_.understanding.scene.objects) {
      if (object.footprint.object_id != decision.object_id) continue;
      const Eigen::Vector2d center = Centroid(object.footprint.polygon_in_map_m);
      for (const sim::ObjectTruth& truly : survey_.truth.objects) {
        if (!truly.is_absent && (Centroid(truly.footprint_in_map_m.front()) - center).norm() < kSamePlace_m)
          return &truly;
      }
    }
    return nullptr;
  }

  bool IsOnWanted(const ClearanceDecision& decision) const {
    const sim::ObjectTruth* truly = FindTruly(decision);
    return truly != nullptr && truly->id == world_.mission.wanted.front();
  }

  /// CLEAR before INSUFFICIENT_DATA before BLOCKED.
  std::optional<Verdict> BestDecision() const {
    for (const Verdict verdict : {Verdict::kClear, Verdict::kInsufficientData, Verdict::kBlocked}) {
      for (const ClearanceDecision& decision : decisions()) {
        if (decision.verdict == verdict && IsOnWanted(decision)) return verdict;
      }
    }
    return std::nullopt;
  }

  void Check(const ClearanceDecision& decision, Judgement& judgement) const {
    const sim::ObjectTruth* truly = FindTruly(decision);
    judgement.has_false_clear |=
        truly == nullptr || truly->passages.empty() || !truly->passages.front().is_passable;
    const double margin_m = FindMargin_m(space_, world_.vehicle, *decision.corridor);
    judgement.is_unsafe |= margin_m < world_.vehicle.safety_margin_m - kRounding_m;
    if (judgement.claimed_margin_m >= 0.0 && margin_m >= judgement.true_margin_m) return;
    judgement.true_margin_m = margin_m;
    judgement.claimed_margin_m =
        world_.vehicle.safety_margin_m + std::min({decision.margin_left_m, decision.margin_right_m,
                                                   decision.margin_up_m, decision.margin_down_m});
  }

  const sim::World& world_;
  std::uint64_t seed_;
  sim::Dice dice_;
  sim::Space space_;
  sim::Renderer renderer_;
  PipelineOptions options_;
  Reference reference_;
  sim::Survey survey_;
  Analysis analysis_;
  std::uint64_t revision_ = 0;
};

}  // namespace

Judgement JudgeWorld(const sim::World& world, std::uint64_t seed, int looks,
                     const std::filesystem::path& folder) {
  const double begin_s = CpuSeconds();
  Judge judge(world, seed);
  for (int i = 0; i < looks && judge.LookAgain(); ++i) {
  }
  Judgement judgement = judge.Conclude();
  judgement.seconds = CpuSeconds() - begin_s;
  if (!folder.empty()) judge.Keep(folder);
  return judgement;
}

}  // namespace soffit::bench
