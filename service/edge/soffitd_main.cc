#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <exception>
#include <iostream>
#include <thread>

#include "service/edge/live/live_service.h"
#include "service/edge/live/service_options.h"
#include "shared/options/yaml.h"

namespace soffit {
namespace {

struct Arguments {
  std::string config;
  std::string data_folder;
  bool prints_config = false;
  bool only_checks = false;
};

Result<ServiceOptions> ReadServiceOptions(const Arguments& arguments) {
  Result<ServiceOptions> options = ServiceOptions();
  if (!arguments.config.empty()) options = ReadOptionsFile<ServiceOptions>(arguments.config);
  if (options.ok() && !arguments.data_folder.empty()) options.value().data_folder = arguments.data_folder;
  return options;
}

Stages StagesOf(const PipelineOptions& options) {
  return {[options](const Capture& capture) { return Observe(capture, options); },
          [options](const std::vector<Observation>& observations, const Reference& reference,
                    const VehicleEnvelope& vehicle, std::uint64_t revision) {
            return Understand(observations, reference, vehicle, revision, options);
          }};
}

/// Signals are taken by one thread that does nothing else, so that nothing has to be safe in a handler.
sigset_t BlockStopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

int Fail(const std::string& message) {
  std::cerr << "soffitd: " << message << '\n';
  return 1;
}

int Run(const Arguments& arguments) {
  const Result<ServiceOptions> options = ReadServiceOptions(arguments);
  if (!options.ok()) return Fail(options.error().message);
  if (arguments.prints_config) {
    std::cout << DescribeOptions(options.value());
    return 0;
  }
  spdlog::set_default_logger(spdlog::stderr_color_mt("soffitd"));
  const sigset_t signals = BlockStopSignals();
  const auto service = LiveService::Start(options.value(), StagesOf(options.value().pipeline));
  if (!service.ok()) return Fail(service.error().message);
  if (arguments.only_checks) {
    std::cout << "soffitd: the configuration is good and both DDS domains can be joined\n";
    return 0;
  }
  spdlog::info("soffitd is ready: radio domain {}, local domain {}, data in {}",
               options.value().radio.domain_id, options.value().local.domain_id, options.value().data_folder);
  std::jthread waiter([&](const std::stop_token& stop) {
    const timespec slice{0, 200'000'000};
    while (!stop.stop_requested()) {
      if (sigtimedwait(&signals, nullptr, &slice) > 0) return service.value()->Stop();
    }
  });
  service.value()->Run();
  spdlog::info("soffitd has stopped");
  return 0;
}

}  // namespace
}  // namespace soffit

int main(int argc, char** argv) try {
  soffit::Arguments arguments;
  CLI::App app("Leads drones through missions: sees, models, decides, commands.", "soffitd");
  app.add_option("--config", arguments.config, "YAML file with the options; see --print-config");
  app.add_option("--data", arguments.data_folder, "Folder for the missions' pictures and results");
  app.add_flag("--print-config", arguments.prints_config,
               "Print all options as YAML, with unit, bounds and help, and end");
  app.add_flag("--check", arguments.only_checks, "Check configuration and DDS, and end");
  CLI11_PARSE(app, argc, argv);
  return soffit::Run(arguments);
} catch (const std::exception& error) {
  std::cerr << "soffitd: " << error.what() << '\n';
  return 1;
}
