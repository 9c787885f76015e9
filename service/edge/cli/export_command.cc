#include <filesystem>
#include <iostream>
#include <memory>

#include "service/edge/cli/analyze_folder.h"
#include "service/edge/cli/commands.h"
#include "service/edge/export/export.h"
#include "service/edge/files/geopackage.h"
#include "service/edge/store/store.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;

struct ExportArguments {
  std::string source;
  std::string format;
  fs::path out;
  fs::path config;
  std::uint32_t vehicle_id = 0;
};

/// A scene, wherever it comes from.
struct FoundScene {
  std::shared_ptr<const Understanding> understanding;
  std::vector<TakenPicture> pictures;
  std::vector<Eigen::Vector3d> track_in_map_m;
  std::optional<GeodeticOrigin> origin;
};

Result<FoundScene> ReadFolder(const ExportArguments& arguments) {
  Result<FolderAnalysis> all = AnalyzeFolder(arguments.source, arguments.config);
  if (!all.ok()) return all.error();
  auto& [survey, analysis] = all.value();
  return FoundScene{std::make_shared<Understanding>(std::move(analysis.understanding)),
                    PicturesOf(analysis.observations),
                    {},
                    survey.origin};
}

Result<FoundScene> ReadStore(const ExportArguments& arguments) try {
  Result<Store> store = Store::Open(arguments.source, true);
  if (!store.ok()) return store.error();
  for (const KeptRun& run : store.value().ReadNewest()) {
    const Mission& mission = run.mission.mission;
    if (arguments.vehicle_id != 0 && mission.order.vehicle_id != arguments.vehicle_id) continue;
    if (run.scenes.empty()) continue;
    FoundScene found{run.scenes.back()->understanding, {}, {}, {}};
    if (mission.vehicle) found.origin = mission.vehicle->origin;
    for (const Capture& c : run.mission.captures) {
      found.pictures.push_back(
          {c.capture_id, c.name, c.purpose, c.map_from_camera, c.position_std_m, c.has_trusted_pose});
    }
    for (const TrackPoint& point : run.mission.log.track)
      found.track_in_map_m.push_back(point.position_in_map_m);
    return found;
  }
  return Error{Error::Code::kNotFound, arguments.source + ": no mission in it has a scene yet"};
} catch (const std::exception& damage) {
  return Error{Error::Code::kUnavailable, arguments.source + ": " + damage.what()};
}

void RunExport(const ExportArguments& arguments) {
  const auto fail = [](const Error& error) {
    std::cerr << "soffit export: " << error.message << '\n';
    throw CLI::RuntimeError(1);
  };
  const Result<FoundScene> found =
      fs::is_directory(arguments.source) ? ReadFolder(arguments) : ReadStore(arguments);
  if (!found.ok()) return fail(found.error());
  const FoundScene& scene = found.value();
  const std::vector<GisLayer> layers =
      DescribeLayers(*scene.understanding, scene.pictures, scene.track_in_map_m);
  const Status written = WriteExport(arguments.out, arguments.format,
                                     {*scene.understanding, scene.pictures, layers, scene.origin});
  if (!written.ok()) return fail(written.error());
  std::cout << Say(arguments.out.string(), ": revision ", scene.understanding->scene.revision,
                   scene.origin ? "" : ", where the map lies on Earth is not known")
            << '\n';
}

}  // namespace

void AddExportCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("export", "Writes a scene for other programs");
  const auto arguments = std::make_shared<ExportArguments>();
  command
      ->add_option("source", arguments->source,
                   "A store (its .gpkg file, or PG: and a connection string), or a folder with survey.json")
      ->required();
  std::vector<std::string> names;
  std::string help = "What to write:";
  for (const ExportFormat& format : ExportFormats()) {
    names.emplace_back(format.name);
    help += Say("\n", format.name, ": ", format.help);
  }
  command->add_option("--format", arguments->format, help)->required()->check(CLI::IsMember(names));
  command->add_option("--out", arguments->out, "The file")->required();
  command->add_option("--vehicle", arguments->vehicle_id, "Of a store: whose newest mission; 0: any");
  command->add_option("--config", arguments->config, "Of a folder: YAML file with options of the stages");
  command->callback([arguments] { RunExport(*arguments); });
}

}  // namespace soffit
