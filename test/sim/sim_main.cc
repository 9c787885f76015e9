/// soffit-sim: a world, pictures of it, a vehicle in it and its autopilot, for trying and judging everything
/// else.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <functional>

#include "test/sim/command/run.h"
#include "test/sim/command/worlds.h"

namespace {

using soffit::Status;

// Each adds a subcommand and gives what to do when it is chosen.

std::function<Status()> AddRun(CLI::App& app, soffit::sim::RunOptions& options) {
  CLI::App* run = app.add_subcommand("run", "Fly in a world, in real time, until SIGINT or SIGTERM");
  run->add_option("WORLD", options.world_file, "World file (YAML)")->required()->check(CLI::ExistingFile);
  run->add_option(
         "--mavlink", options.mavlink_urls,
         "Link: udpout:HOST:PORT, udpin:HOST:PORT, tcpin:HOST:PORT, tcp:HOST:PORT, serial:DEVICE:BAUD; "
         "a simulated autopilot may have several")
      ->allow_extra_args(false)
      ->capture_default_str();
  run->add_option("--autopilot", options.autopilot,
                  "Simulated autopilot; none: only cameras, for an autopilot that flies elsewhere")
      ->check(CLI::IsMember({"ardupilot", "px4", "none"}))
      ->capture_default_str();
  run->add_option("--camera-port", options.camera_port, "HTTP port of the cameras; 0: a free one")
      ->check(CLI::Range(0, 65535));
  run->add_option("--control-port", options.control_port, "HTTP port for disturbances; 0: a free one")
      ->check(CLI::Range(0, 65535));
  run->add_option("--out", options.out_folder, "Folder for truth.json and track.csv")->capture_default_str();
  run->add_option("--seed", options.seed, "Of wind and noise");
  run->add_flag("--quick-start", options.is_quick_start, "Ready after 3 s instead of after 41 s");
  run->add_option("--broken-pictures", options.broken_picture_ratio, "Share of pictures that arrive cut off")
      ->check(CLI::Range(0.0, 1.0));
  run->add_option("--late-pictures", options.late_picture_ratio, "Share of pictures that arrive late")
      ->check(CLI::Range(0.0, 1.0));
  return [run, &options] { return run->parsed() ? soffit::sim::Run(options) : soffit::OkStatus(); };
}

struct WorldOptions {
  std::string world_file;
  std::string out_file;
  std::uint64_t seed = 0;
};

std::function<Status()> AddTruth(CLI::App& app, WorldOptions& options) {
  CLI::App* truth =
      app.add_subcommand("truth", "Print what is truly passable in a world, and how a mission has to end");
  truth->add_option("WORLD", options.world_file, "World file (YAML)")->required()->check(CLI::ExistingFile);
  return [truth, &options] {
    return truth->parsed() ? soffit::sim::PrintTruth(options.world_file) : soffit::OkStatus();
  };
}

std::function<Status()> AddDescribe(CLI::App& app, WorldOptions& options) {
  CLI::App* describe = app.add_subcommand("describe", "Print camera, vehicle and mission of a world");
  describe->add_option("WORLD", options.world_file, "World file (YAML)")
      ->required()
      ->check(CLI::ExistingFile);
  return [describe, &options] {
    return describe->parsed() ? soffit::sim::PrintDescription(options.world_file) : soffit::OkStatus();
  };
}

std::function<Status()> AddReference(CLI::App& app, WorldOptions& options) {
  CLI::App* reference = app.add_subcommand("reference", "Write the reference bitmap of what is wanted");
  reference->add_option("WORLD", options.world_file, "World file (YAML)")
      ->required()
      ->check(CLI::ExistingFile);
  reference->add_option("--out", options.out_file, "PNG to write")->required();
  return [reference, &options] {
    return reference->parsed() ? soffit::sim::WriteReference(options.world_file, options.out_file)
                               : soffit::OkStatus();
  };
}

std::function<Status()> AddSurvey(CLI::App& app, WorldOptions& options) {
  CLI::App* survey = app.add_subcommand("survey", "Render a survey of a world, with the truth beside it");
  survey->add_option("WORLD", options.world_file, "World file (YAML)")->required()->check(CLI::ExistingFile);
  survey->add_option("--out", options.out_file, "Folder to write")->required();
  survey->add_option("--seed", options.seed, "Of places, noise and errors of the poses");
  return [survey, &options] {
    return survey->parsed() ? soffit::sim::WriteSurveyOf(options.world_file, options.seed, options.out_file)
                            : soffit::OkStatus();
  };
}

std::function<Status()> AddDraw(CLI::App& app, WorldOptions& options) {
  CLI::App* draw = app.add_subcommand("draw", "Write a random world, always the same for a seed");
  draw->add_option("--seed", options.seed)->required();
  draw->add_option("--out", options.out_file, "World file to write (YAML)")->required();
  return [draw, &options] {
    return draw->parsed() ? soffit::sim::WriteRandomWorld(options.seed, options.out_file)
                          : soffit::OkStatus();
  };
}

}  // namespace

int main(int argc, char** argv) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("soffit-sim"));
  CLI::App app("Simulated world, vehicle and autopilot for Soffit", "soffit-sim");
  app.require_subcommand(1);
  soffit::sim::RunOptions run_options;
  WorldOptions world_options;
  const std::vector<std::function<Status()>> commands = {
      AddRun(app, run_options),         AddDescribe(app, world_options), AddTruth(app, world_options),
      AddReference(app, world_options), AddDraw(app, world_options),     AddSurvey(app, world_options)};
  CLI11_PARSE(app, argc, argv);
  for (const auto& command : commands) {
    if (const Status status = command(); !status.ok()) {
      spdlog::error("{}", status.error().message);
      return 1;
    }
  }
  return 0;
}
