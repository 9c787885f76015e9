#include <filesystem>
#include <iostream>
#include <memory>

#include "service/clearance/describe.h"
#include "service/edge/cli/analyze_folder.h"
#include "service/edge/cli/commands.h"
#include "service/edge/files/outputs.h"

namespace soffit {
namespace {

struct AnalyzeArguments {
  std::filesystem::path survey;
  std::filesystem::path out;
  std::filesystem::path config;
};

[[noreturn]] void Fail(const Error& error) {
  std::cerr << "soffit analyze: " << error.message << '\n';
  throw CLI::RuntimeError(1);
}

void RunAnalyze(const AnalyzeArguments& arguments) {
  const Result<FolderAnalysis> read = AnalyzeFolder(arguments.survey, arguments.config);
  if (!read.ok()) Fail(read.error());
  const Understanding& all = read.value().analysis.understanding;
  for (const std::string& problem : all.problems) std::cerr << "soffit analyze: " << problem << '\n';
  for (const ClearanceDecision& decision : all.decisions) std::cout << Describe(decision) << '\n';
  FlightRecord flight;
  flight.map_origin_m = read.value().survey.map_origin_m;
  const Status written = WriteOutputs(arguments.out, read.value().analysis, flight);
  if (!written.ok()) Fail(written.error());
}

}  // namespace

void AddAnalyzeCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("analyze", "Runs the service's stages on the pictures of a survey folder");
  const auto arguments = std::make_shared<AnalyzeArguments>();
  command->add_option("survey", arguments->survey, "Folder with survey.json and its pictures")->required();
  command->add_option("--out", arguments->out, "Folder for the results")->required();
  command->add_option("--config", arguments->config, "YAML file with options of the stages");
  command->callback([arguments] { RunAnalyze(*arguments); });
}

}  // namespace soffit
