#include <filesystem>
#include <iostream>
#include <memory>

#include "service/edge/cli/commands.h"
#include "service/edge/files/analysis.h"
#include "service/edge/files/result.h"
#include "service/edge/files/survey.h"
#include "shared/options/yaml.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;

struct AnalyzeArguments {
  fs::path survey;
  fs::path out;
  fs::path config;
};

Result<Analysis> AnalyzeFolder(const AnalyzeArguments& arguments) {
  PipelineOptions options;
  if (!arguments.config.empty()) {
    const Result<PipelineOptions> read = ReadOptionsFile<PipelineOptions>(arguments.config.string());
    if (!read.ok()) return read.error();
    options = read.value();
  }
  const Result<Survey> survey = ReadSurvey(arguments.survey);
  if (!survey.ok()) return survey.error();
  const Result<Reference> reference = ReadReferenceFile(arguments.survey / survey.value().reference_file);
  if (!reference.ok()) return reference.error();
  if (!survey.value().colors.empty()) options.mask.colors = survey.value().colors;
  return Analyze(survey.value(), reference.value(), options);
}

void PrintSummary(const Understanding& all) {
  for (const std::string& problem : all.problems) std::cerr << "soffit analyze: " << problem << '\n';
  for (const ClearanceDecision& decision : all.decisions) {
    std::cout << "building " << decision.object_id;
    if (decision.side >= 0) std::cout << ", side " << decision.side;
    std::cout << ": " << ToString(decision.verdict) << " (" << decision.reason << ")\n";
  }
}

[[noreturn]] void Fail(const std::string& message) {
  std::cerr << "soffit analyze: " << message << '\n';
  throw CLI::RuntimeError(1);
}

void RunAnalyze(const AnalyzeArguments& arguments) {
  const Result<Analysis> analysis = AnalyzeFolder(arguments);
  if (!analysis.ok()) Fail(analysis.error().message);
  const Status written = WriteResult(arguments.out, analysis.value().understanding, analysis.value().observations);
  if (!written.ok()) Fail(written.error().message);
  PrintSummary(analysis.value().understanding);
}

}  // namespace

void AddAnalyzeCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("analyze", "Runs the service's stages on the pictures of a survey folder");
  const auto arguments = std::make_shared<AnalyzeArguments>();
  command->add_option("survey", arguments->survey, "Folder with survey.json and its pictures")->required();
  command->add_option("--out", arguments->out, "Folder for the results")->required();
  command->add_option("--config", arguments->config, "YAML file with options of the stages");
  command->callback([arguments] { RunAnalyze(*arguments); });
}

}  // namespace soffit
