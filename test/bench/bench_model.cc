// How long a building takes from its pictures to its model with openings, and from there to the decision, on
// one core. The yardstick is decoding the same pictures with libjpeg-turbo.

#include <benchmark/benchmark.h>
#include <turbojpeg.h>

#include <memory>

#include "service/facade/align.h"
#include "service/pipeline/pipeline.h"
#include "test/sim/render/renderer.h"
#include "test/sim/survey/frames.h"
#include "test/sim/survey/reference.h"

namespace soffit::bench {
namespace {

constexpr int kWidth_px = 2880;  // 6 megapixels.
constexpr std::size_t kPictures = 6;

/// A plain arch, 3.9 m long and 1.5 m deep, with another building beside it.
constexpr char kWorld[] = R"(
camera: {width_px: 1280, height_px: 960, fx_px: 850, distortion: [-0.06, 0.012, 0.0003, -0.0002, 0]}
vehicle: {radius_m: 0.35, height_m: 0.30, safety_margin_m: 0.25}
pose_noise: {position_std_m: 0.01, orientation_std_deg: 0.1}
mission: {wanted: [arch], reference_m_per_px: 0.027, reference_rotation_cw_deg: 82, overview_altitude_m: 9}
buildings:
  - id: arch
    position: [2.6, 0]
    yaw_deg: 78
    color: yellow
    parts:
      - {box: {center: [-1.325, 0], size: [1.25, 1.5]}, z: [0, 1.5]}
      - {box: {center: [1.45, 0], size: [1, 1.5]}, z: [0, 1.5]}
      - {box: {center: [0, 0], size: [3.9, 1.5]}, z: [1.5, 2.3]}
  - {id: annex, position: [-4.6, 3], yaw_deg: -12, color: red, parts: [{box: {center: [0, 0], size: [1.7, 1.2]}, z: [0, 1.3]}]}
)";

sim::World MakeWorld() {
  sim::World world = sim::ParseWorld(kWorld, "bench", {}).value();
  Intrinsics& lens = world.camera.intrinsics;
  const double scale = static_cast<double>(kWidth_px) / lens.width_px;
  lens = {kWidth_px,          static_cast<int>(scale * lens.height_px), scale * lens.fx_px,
          scale * lens.fy_px, scale * (lens.cx_px + 0.5) - 0.5,         scale * (lens.cy_px + 0.5) - 0.5,
          lens.distortion};
  return world;
}

/// Of the wanted building and of the area.
std::vector<Capture> TakePictures(const sim::World& world) {
  sim::Dice dice(1);
  const sim::Renderer renderer(world);
  std::vector<Capture> captures;
  for (const sim::SurveyFrame& frame : sim::PlanFrames(world, sim::FindTruth(world), dice)) {
    const bool serves = frame.object.empty() || frame.object == world.mission.wanted.front();
    if (!serves || captures.size() == kPictures) continue;
    Capture capture;
    capture.capture_id = static_cast<std::uint32_t>(captures.size() + 1);
    capture.name = frame.file;
    capture.purpose = frame.purpose;
    capture.intrinsics = world.camera.intrinsics;
    capture.map_from_camera = frame.reported;
    capture.has_trusted_pose = true;
    capture.position_std_m = world.pose_noise.position_std_m;
    capture.orientation_std_rad = world.pose_noise.orientation_std_rad;
    const cv::Mat3b picture = renderer.Render({{frame.map_from_camera}, capture.capture_id});
    capture.bytes = sim::EncodeJpeg(picture, world.camera.jpeg_quality, 0);
    captures.push_back(std::move(capture));
  }
  return captures;
}

std::vector<Observation> ObserveAll(const std::vector<Capture>& captures) {
  std::vector<Observation> observations;
  for (const Capture& capture : captures) observations.push_back(Observe(capture, {}).value());
  return observations;
}

Solid MakeModel(const std::vector<Observation>& observations, const Footprint& wanted) {
  std::vector<Image> images;
  std::vector<Mask> masks;
  std::vector<Sight> sights;
  for (const Observation& seen : observations) {
    if (seen.image.purpose != Purpose::kWall) continue;
    images.push_back(seen.image);
    masks.push_back(seen.mask);
    sights.push_back(seen.sight);
  }
  const Alignment aligned = AlignSights(wanted, masks, sights, {});
  const std::vector<Facade> facades = ReadFacades(aligned.footprint, images, masks, aligned.sights, {});
  return RaiseSolid(aligned.footprint, facades).value();
}

std::vector<Footprint> MakeMap(const std::vector<Observation>& observations) {
  std::vector<Footprint> map;
  for (const Observation& seen : observations) map = MergeFootprints(map, seen.footprints);
  return map;
}

std::vector<ClearanceDecision> Decide(const Scene& scene, std::uint32_t object_id,
                                      const std::vector<Sight>& sights, const VehicleEnvelope& vehicle) {
  return JudgeClearance(scene, object_id, PlanCorridors(scene, object_id, vehicle, {}), sights, vehicle, {});
}

/// The survey that the benchmarks work on, and what the stages make of it.
struct Survey {
  Survey()
      : world(MakeWorld()),
        captures(TakePictures(world)),
        reference(ReadReference(sim::DrawReference(world)).value()),
        observations(ObserveAll(captures)),
        understanding(Understand(observations, reference, world.vehicle, 1, {})) {
    for (const Observation& seen : observations) sights.push_back(seen.sight);
    for (const SceneObject& object : understanding.scene.objects) {
      if (object.is_matched) wanted_id = object.footprint.object_id;
    }
  }

  sim::World world;
  std::vector<Capture> captures;
  Reference reference;
  std::vector<Observation> observations;
  Understanding understanding;
  std::vector<Sight> sights;
  std::uint32_t wanted_id = 0;
};

const Survey& Known() {
  static const Survey survey;
  return survey;
}

Footprint WantedOf(const std::vector<Observation>& observations) {
  for (const Footprint& footprint : MakeMap(observations)) {
    if (footprint.object_id == Known().wanted_id) return footprint;
  }
  throw std::runtime_error("the wanted building was not found");
}

void LibjpegTurbo(benchmark::State& state) {
  const std::unique_ptr<void, decltype(&tjDestroy)> decoder(tjInitDecompress(), tjDestroy);
  const Intrinsics& lens = Known().world.camera.intrinsics;
  std::vector<std::uint8_t> pixels(3UL * static_cast<std::size_t>(lens.width_px) *
                                   static_cast<std::size_t>(lens.height_px));
  for (auto _ : state) {
    for (const Capture& capture : Known().captures) {
      if (tjDecompress2(decoder.get(), capture.bytes.data(), capture.bytes.size(), pixels.data(),
                        lens.width_px, 0, lens.height_px, TJPF_BGR, 0) != 0) {
        state.SkipWithError(tjGetErrorStr2(decoder.get()));
      }
    }
    benchmark::DoNotOptimize(pixels.data());
  }
}

void ObservesPictures(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(ObserveAll(Known().captures));
}

void LabelsSights(benchmark::State& state) {
  for (auto _ : state) {
    for (const Observation& seen : Known().observations)
      benchmark::DoNotOptimize(LabelSight(seen.image, seen.mask, {}));
  }
}

void MakesModel(benchmark::State& state) {
  const Footprint wanted = WantedOf(Known().observations);
  for (auto _ : state) benchmark::DoNotOptimize(MakeModel(Known().observations, wanted));
}

void FromPicturesToModel(benchmark::State& state) {
  std::size_t openings = 0;
  for (auto _ : state) {
    const std::vector<Observation> observations = ObserveAll(Known().captures);
    openings = MakeModel(observations, WantedOf(observations)).openings.size();
  }
  state.counters["pictures"] = static_cast<double>(Known().captures.size());
  state.counters["openings"] = static_cast<double>(openings);
}

void BuildsScene(benchmark::State& state) {
  const Scene& scene = Known().understanding.scene;
  for (auto _ : state)
    benchmark::DoNotOptimize(BuildScene(1, scene.objects, scene.solids, Known().sights, {}));
}

void DecidesClearance(benchmark::State& state) {
  const Survey& known = Known();
  std::vector<ClearanceDecision> decisions;
  for (auto _ : state)
    decisions = Decide(known.understanding.scene, known.wanted_id, known.sights, known.world.vehicle);
  state.counters["decisions"] = static_cast<double>(decisions.size());
}

void FromPicturesToDecisions(benchmark::State& state) {
  const Survey& known = Known();
  for (auto _ : state) {
    const Understanding all =
        Understand(ObserveAll(known.captures), known.reference, known.world.vehicle, 1, {});
    benchmark::DoNotOptimize(all.decisions.data());
  }
}

BENCHMARK(LibjpegTurbo)->Unit(benchmark::kMillisecond);
BENCHMARK(ObservesPictures)->Unit(benchmark::kMillisecond);
BENCHMARK(LabelsSights)->Unit(benchmark::kMillisecond);
BENCHMARK(MakesModel)->Unit(benchmark::kMillisecond);
BENCHMARK(FromPicturesToModel)->Unit(benchmark::kMillisecond);
BENCHMARK(BuildsScene)->Unit(benchmark::kMillisecond);
BENCHMARK(DecidesClearance)->Unit(benchmark::kMillisecond);
BENCHMARK(FromPicturesToDecisions)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace soffit::bench
