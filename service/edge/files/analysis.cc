#include "service/edge/files/analysis.h"

#include <atomic>
#include <optional>
#include <thread>

#include "service/edge/files/file.h"

namespace soffit {
namespace {

Result<Observation> ObserveFile(const std::filesystem::path& folder, Capture capture,
                                const PipelineOptions& options) {
  Result<std::vector<std::uint8_t>> bytes = ReadFile(folder / capture.name, options.image.max_bytes);
  if (!bytes.ok()) return bytes.error();
  capture.bytes = std::move(bytes).value();
  return Observe(capture, options);
}

std::vector<std::optional<Result<Observation>>> ObserveAll(const std::filesystem::path& folder,
                                                           const std::vector<Capture>& captures,
                                                           const PipelineOptions& options) {
  std::vector<std::optional<Result<Observation>>> seen(captures.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < captures.size(); i = next++)
      seen[i] = ObserveFile(folder, captures[i], options);
  };
  std::vector<std::jthread> helpers;
  const std::size_t threads =
      std::min<std::size_t>(captures.size(), std::max(1U, std::thread::hardware_concurrency()));
  for (std::size_t i = 1; i < threads; ++i) helpers.emplace_back(work);
  work();
  helpers.clear();
  return seen;
}

}  // namespace

Result<Analysis> Analyze(const std::filesystem::path& folder, const Survey& survey,
                         const Reference& reference, const PipelineOptions& options) try {
  Analysis analysis;
  std::vector<std::string> problems;
  for (std::optional<Result<Observation>>& seen : ObserveAll(folder, survey.captures, options)) {
    if (seen->ok()) {
      analysis.observations.push_back(std::move(*seen).value());
    } else {
      problems.push_back(seen->error().message);
    }
  }
  if (analysis.observations.empty()) {
    return Error{Error::Code::kNotFound, "no picture of the survey can be used: " +
                                             (problems.empty() ? "it has none" : problems.front())};
  }
  analysis.understanding =
      Understand(analysis.observations, reference, survey.vehicle, 1, options, survey.map_origin_m);
  problems.insert(problems.end(), analysis.understanding.problems.begin(),
                  analysis.understanding.problems.end());
  analysis.understanding.problems = std::move(problems);
  return analysis;
} catch (const std::exception& failure) {
  return Error{Error::Code::kInternal, failure.what()};
}

}  // namespace soffit
