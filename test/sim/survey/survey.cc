#include "test/sim/survey/survey.h"

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "test/sim/survey/reference.h"
#include "test/sim/survey/truth_file.h"

namespace soffit::sim {
namespace {

constexpr std::int64_t kBegin_utc_ns = 1'750'000'000'000'000'000;
constexpr std::int64_t kBetweenFrames_ns = 2'500'000'000;

Status WriteBytes(const std::filesystem::path& file, const char* data, std::size_t size) {
  std::ofstream out(file, std::ios::binary);
  out.write(data, static_cast<std::streamsize>(size));
  out.flush();
  if (!out) return Error{Error::Code::kUnavailable, file.string() + ": cannot be written"};
  return OkStatus();
}

Status WriteBytes(const std::filesystem::path& file, const std::vector<std::uint8_t>& bytes) {
  return WriteBytes(file, reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

Status WriteText(const std::filesystem::path& file, const std::string& text) {
  return WriteBytes(file, text.data(), text.size());
}

}  // namespace

Survey RenderSurvey(const World& world, const Renderer& renderer, std::uint64_t seed) {
  Dice dice(seed);
  Survey survey;
  survey.truth = FindTruth(world);
  survey.frames = PlanFrames(world, survey.truth, dice);
  for (std::size_t i = 0; i < survey.frames.size(); ++i) {
    const cv::Mat3b picture = renderer.Render({{survey.frames[i].map_from_camera}, Mix(seed) + i});
    survey.jpegs.push_back(EncodeJpeg(picture, world.camera.jpeg_quality,
                                      kBegin_utc_ns + static_cast<std::int64_t>(i) * kBetweenFrames_ns));
  }
  return survey;
}

Status WriteSurvey(const World& world, const Survey& survey, const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem)
    return Error{Error::Code::kUnavailable, folder.string() + ": cannot be made: " + problem.message()};
  for (std::size_t i = 0; i < survey.frames.size(); ++i) {
    if (const Status written = WriteBytes(folder / survey.frames[i].file, survey.jpegs[i]); !written.ok())
      return written;
  }
  std::vector<std::uint8_t> png;
  cv::imencode(".png", DrawReference(world), png);
  if (const Status written = WriteBytes(folder / "reference.png", png); !written.ok()) return written;
  if (const Status written = WriteText(folder / "survey.json", DescribeSurvey(world, survey.frames).dump(1));
      !written.ok())
    return written;
  return WriteText(folder / "truth.json", DescribeTruth(world, survey.truth, survey.frames).dump(1));
}

Status WriteSurvey(const World& world, std::uint64_t seed, const std::filesystem::path& folder, int threads) {
  return WriteSurvey(world, RenderSurvey(world, Renderer(world, threads), seed), folder);
}

}  // namespace soffit::sim
