#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "service/edge/cli/commands.h"

int main(int argc, char** argv) try {
  CLI::App app("Finds a building from the air, models it, and says whether a drone may fly through it.",
               "soffit");
  soffit::AddAnalyzeCommand(app);
  soffit::AddRecognizeCommand(app);
  soffit::AddCompareCommand(app);
  soffit::AddReportCommand(app);
  soffit::AddExportCommand(app);
  soffit::AddMissionCommand(app);
  soffit::AddQueryCommand(app);
  soffit::AddSceneCommand(app);
  soffit::AddTopicsCommand(app);
  soffit::AddEchoCommand(app);
  soffit::AddDoctorCommand(app);
  soffit::AddManualCommands(app);
  app.require_subcommand(1);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Error& error) {
    return app.exit(error);
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << "soffit: " << error.what() << '\n';
  return 1;
}
