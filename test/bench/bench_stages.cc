// How long the stages from a picture to the vector map take, on one core. The yardstick is decoding the same
// picture with libjpeg-turbo: seeing is to cost no more than twice that.

#include <benchmark/benchmark.h>
#include <turbojpeg.h>

#include <map>
#include <memory>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "service/footprint/footprint.h"
#include "service/image/image.h"
#include "service/mask/mask.h"
#include "service/mask/median.h"
#include "service/match/match.h"
#include "service/outline/judge.h"
#include "service/outline/outline.h"
#include "test/bench/overview.h"

namespace soffit::bench {
namespace {

constexpr int kWidthsPx[] = {1280, 4000};  // 1.2 and 12 megapixels.

/// The overview that a benchmark works on, and what every stage makes of it.
struct Stages {
  explicit Stages(const Capture& overview)
      : capture(overview),
        image(DecodeImage(capture, {}).value()),
        mask(SegmentBuildings(image, {})),
        outlines(TraceOutlines(mask, image.seen, {})) {}

  Capture capture;
  Image image;
  Mask mask;
  std::vector<Outline> outlines;
};

const Stages& StagesOf(int width_px) {
  static std::map<int, Stages> known;
  auto found = known.find(width_px);
  if (found == known.end()) found = known.emplace(width_px, Stages(MakeOverview(width_px, false))).first;
  return found->second;
}

/// Runs `stage(stages)` on the overview of the benchmark's width.
template <class Stage>
void Run(benchmark::State& state, const Stage& stage) {
  const Stages& stages = StagesOf(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(stage(stages));
  state.counters["MP/s"] = benchmark::Counter(static_cast<double>(stages.image.bgr.total()) * 1e-6,
                                              benchmark::Counter::kIsIterationInvariantRate);
}

/// Decoding alone, into memory that is there already.
void LibjpegTurbo(benchmark::State& state) {
  const std::unique_ptr<void, decltype(&tjDestroy)> decoder(tjInitDecompress(), tjDestroy);
  std::vector<std::uint8_t> pixels;
  Run(state, [&](const Stages& stages) {
    const std::vector<std::uint8_t>& jpeg = stages.capture.bytes;
    const cv::Size size = stages.image.bgr.size();
    pixels.resize(3 * stages.image.bgr.total());
    if (tjDecompress2(decoder.get(), jpeg.data(), jpeg.size(), pixels.data(), size.width, 0, size.height,
                      TJPF_BGR, 0) != 0) {
      state.SkipWithError(tjGetErrorStr2(decoder.get()));
    }
    return pixels.data();
  });
}

void DecodesImage(benchmark::State& state) {
  Run(state, [](const Stages& stages) { return DecodeImage(stages.capture, {}); });
}

void DecodesImageThroughLens(benchmark::State& state) {
  const Capture capture = MakeOverview(static_cast<int>(state.range(0)), true);
  Run(state, [&](const Stages&) { return DecodeImage(capture, {}); });
}

void FiltersMedian(benchmark::State& state) {
  Run(state, [](const Stages& stages) { return FilterMedian(stages.image.bgr, 7); });
}

void FiltersMedianWithOpenCv(benchmark::State& state) {
  Run(state, [](const Stages& stages) {
    cv::Mat filtered;
    cv::medianBlur(stages.image.bgr, filtered, 7);
    return filtered;
  });
}

void SegmentsBuildings(benchmark::State& state) {
  Run(state, [](const Stages& stages) { return SegmentBuildings(stages.image, {}); });
}

void TracesOutlines(benchmark::State& state) {
  Run(state, [](const Stages& stages) { return TraceOutlines(stages.mask, stages.image.seen, {}); });
}

void JudgesOutlines(benchmark::State& state) {
  Run(state, [](const Stages& stages) { return JudgeOutlines(stages.outlines, stages.image); });
}

void TracesFootprints(benchmark::State& state) {
  Run(state, [](const Stages& stages) { return TraceFootprints(stages.image, stages.outlines, {}); });
}

std::vector<Footprint> SeeFootprints(const Capture& capture) {
  const Result<Image> image = DecodeImage(capture, {});
  const Mask mask = SegmentBuildings(image.value(), {});
  const JudgedOutlines judged = JudgeOutlines(TraceOutlines(mask, image.value().seen, {}), image.value());
  return TraceFootprints(image.value(), judged.buildings, {});
}

void FromPictureToFootprints(benchmark::State& state) {
  std::size_t found = 0;
  Run(state, [&](const Stages& stages) {
    const std::vector<Footprint> footprints = SeeFootprints(stages.capture);
    found = footprints.size();
    return footprints;
  });
  state.counters["footprints"] = static_cast<double>(found);
}

void FromPictureThroughLensToFootprints(benchmark::State& state) {
  const Capture capture = MakeOverview(static_cast<int>(state.range(0)), true);
  Run(state, [&](const Stages&) { return SeeFootprints(capture); });
}

/// A building, or one with its neighbours, among as many as the argument says.
void FindsReference(benchmark::State& state, std::initializer_list<std::size_t> wanted) {
  std::vector<TracedShape> map;
  for (Polygon& polygon : MakeVectorMap(static_cast<std::size_t>(state.range(0)))) {
    map.push_back({std::move(polygon), 0.05});
  }
  const Eigen::Rotation2Dd turn(-0.7);
  Reference reference;
  for (const std::size_t index : wanted) {
    reference.shapes.push_back(map[index]);
    for (Eigen::Vector2d& corner : reference.shapes.back().polygon.outer) corner = turn * (corner * 3.0);
  }
  std::vector<Match> matches;
  for (auto _ : state) benchmark::DoNotOptimize(matches = FindMatches(map, reference, {}));
  if (matches.empty() || matches.front().shapes != std::vector<std::size_t>(wanted))
    state.SkipWithError("not found");
}

void FindsBuilding(benchmark::State& state) { FindsReference(state, {57}); }
void FindsGroup(benchmark::State& state) { FindsReference(state, {57, 58, 89}); }

void AtBothSizes(benchmark::internal::Benchmark* benchmark) {
  for (const int width_px : kWidthsPx) benchmark->Arg(width_px);
  benchmark->ArgName("width_px")->Unit(benchmark::kMillisecond);
}

BENCHMARK(LibjpegTurbo)->Apply(AtBothSizes);
BENCHMARK(DecodesImage)->Apply(AtBothSizes);
BENCHMARK(DecodesImageThroughLens)->Apply(AtBothSizes);
BENCHMARK(FiltersMedian)->Apply(AtBothSizes);
BENCHMARK(FiltersMedianWithOpenCv)->Apply(AtBothSizes);
BENCHMARK(SegmentsBuildings)->Apply(AtBothSizes);
BENCHMARK(TracesOutlines)->Apply(AtBothSizes);
BENCHMARK(JudgesOutlines)->Apply(AtBothSizes);
BENCHMARK(TracesFootprints)->Apply(AtBothSizes);
BENCHMARK(FromPictureToFootprints)->Apply(AtBothSizes);
BENCHMARK(FromPictureThroughLensToFootprints)->Apply(AtBothSizes);
BENCHMARK(FindsBuilding)->ArgName("shapes")->Arg(1000)->Unit(benchmark::kMillisecond);
BENCHMARK(FindsGroup)->ArgName("shapes")->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace soffit::bench
