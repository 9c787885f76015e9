#include <filesystem>
#include <iostream>
#include <memory>

#include "service/edge/cli/analyze_folder.h"
#include "service/edge/cli/commands.h"
#include "service/edge/files/outputs.h"
#include "service/edge/files/report.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  fs::path folder;
  fs::path out;
  fs::path config;
  fs::path mission;
  fs::path truth;
  fs::path track;
};

[[noreturn]] void Fail(const Error& error) {
  std::cerr << "soffit report: " << error.message << '\n';
  throw CLI::RuntimeError(1);
}

template <class T>
T Take(Result<T> result) {
  if (!result.ok()) Fail(result.error());
  return std::move(result).value();
}

FlightRecord ReadFlight(const ReportArguments& arguments) {
  FlightRecord flight;
  if (!arguments.mission.empty()) flight.mission = Take(ReadJsonFile(arguments.mission));
  if (!arguments.truth.empty()) flight.truth = Take(ReadJsonFile(arguments.truth));
  if (!arguments.track.empty()) flight.track_in_map_m = Take(ReadTrackFile(arguments.track));
  return flight;
}

/// A mission that ended before its first usable picture has a report, too, which says so.
FolderAnalysis AnalyzeWhatIsThere(const ReportArguments& arguments) {
  Result<FolderAnalysis> all = AnalyzeFolder(arguments.folder, arguments.config);
  const bool is_empty = !all.ok() && all.error().code == Error::Code::kNotFound && !arguments.mission.empty();
  if (!is_empty) return Take(std::move(all));
  FolderAnalysis none;
  none.analysis.understanding.problems.push_back(all.error().message);
  return none;
}

/// The report shows the pictures as they were taken, so they go along.
void CopyInputs(const fs::path& from, const fs::path& to, const Survey& survey) {
  if (survey.captures.empty() || (fs::exists(to) && fs::equivalent(from, to))) return;
  std::vector<std::string> files = {"survey.json", survey.reference_file};
  for (const Capture& capture : survey.captures) files.push_back(capture.name);
  for (const std::string& file : files) {
    fs::create_directories((to / file).parent_path());
    fs::copy_file(from / file, to / file, fs::copy_options::overwrite_existing);
  }
}

void RunReport(const ReportArguments& arguments) {
  FlightRecord flight = ReadFlight(arguments);
  const auto [survey, analysis] = AnalyzeWhatIsThere(arguments);
  flight.origin = survey.origin;
  flight.map_origin_m = survey.map_origin_m;
  for (Eigen::Vector3d& point : flight.track_in_map_m) point -= survey.map_origin_m;
  const fs::path out = arguments.out.empty() ? arguments.folder : arguments.out;
  CopyInputs(arguments.folder, out, survey);
  Take(WriteOutputs(out, analysis, flight));
  Take(WriteReport(out, analysis.understanding, analysis.observations, flight, survey.reference_file));
  std::cout << (out / "report.html").string() << '\n';
}

}  // namespace

void AddReportCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("report", "Writes a report with pictures about a mission's folder");
  const auto arguments = std::make_shared<ReportArguments>();
  command->add_option("folder", arguments->folder, "Folder with survey.json and its pictures")->required();
  command->add_option("--out", arguments->out, "Folder for the report; without it the same folder");
  command->add_option("--config", arguments->config, "YAML file with options of the stages");
  command->add_option("--mission", arguments->mission, "JSON file with the outcome and steps of the mission");
  command->add_option("--truth", arguments->truth, "JSON file with the simulator's ground truth");
  command->add_option("--track", arguments->track, "CSV file with the flown track: columns x_m, y_m, z_m");
  command->callback([arguments] { RunReport(*arguments); });
}

}  // namespace soffit
