#include <spdlog/sinks/systemd_sink.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <exception>

#include "shared/options/yaml.h"
#include "vehicle_agent/edge/agent_config.h"
#include "vehicle_agent/edge/check.h"
#include "vehicle_agent/edge/station.h"
#include "vehicle_agent/edge/supervisor.h"

namespace {

std::atomic<bool> stop = false;

extern "C" void StopOnSignal(int) { stop = true; }

soffit::Result<soffit::AgentConfig> ReadConfig(const std::string& path) {
  if (path.empty()) return soffit::AgentConfig{};
  soffit::Result<soffit::AgentConfig> config = soffit::ReadOptionsFile<soffit::AgentConfig>(path);
  if (!config.ok()) return config;
  const std::string problem = soffit::FindConfigProblem(config.value());
  if (!problem.empty()) return soffit::InvalidInput(path + ": " + problem);
  return config;
}

int Fail(const std::string& message) {
  std::fprintf(stderr, "soffit-agent: %s\n", message.c_str());
  return 1;
}

int RunAgent(const soffit::AgentConfig& config) {
  const auto epoch = static_cast<std::uint64_t>(soffit::ReadClocks().utc_ns);
  soffit::Result<std::unique_ptr<soffit::Station>> station = soffit::Station::Open(config, epoch);
  if (!station.ok()) return Fail(station.error().message);
  station.value()->Run(stop);
  spdlog::info("stopped; the autopilot keeps to its last setpoint");
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app{"soffit-agent: flies one vehicle for the ground service, and refuses what is not safe"};
  std::string path;
  bool prints = false;
  bool checks = false;
  double timeout_s = 60.0;
  app.add_option("--config", path, "YAML file; without it, the defaults");
  app.add_flag("--print-config", prints, "Print the configuration with units, bounds and help, and end");
  app.add_flag("--check", checks, "Talk to autopilot and cameras, say what does not work, and end");
  app.add_option("--timeout", timeout_s, "How long --check waits for the autopilot [s]")
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  const soffit::Result<soffit::AgentConfig> config = ReadConfig(path);
  if (!config.ok()) return Fail(config.error().message);
  if (prints) {
    std::fputs(soffit::DescribeOptions(config.value()).c_str(), stdout);
    return 0;
  }
  std::signal(SIGINT, StopOnSignal);
  std::signal(SIGTERM, StopOnSignal);
  if (soffit::LogsToJournal()) {
    spdlog::set_default_logger(spdlog::systemd_logger_mt("soffit-agent"));
  }
  spdlog::set_level(spdlog::level::from_str(config.value().log_level));
  spdlog::set_pattern("%Y-%m-%d %H:%M:%S.%e %^%l%$ %v");
  spdlog::flush_on(spdlog::level::info);
  if (checks) return soffit::CheckVehicle(config.value(), timeout_s, stop) ? 0 : 1;
  return RunAgent(config.value());
} catch (const std::exception& problem) {
  return Fail(problem.what());
}
