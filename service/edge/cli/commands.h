#pragma once

#include <CLI/CLI.hpp>

namespace soffit {

// One function for each subcommand of `soffit`, each in its own file. It adds its options and a callback to
// the program. A callback that fails tells the person why on standard error and throws CLI::RuntimeError(exit
// code).

void AddAnalyzeCommand(CLI::App& app);
void AddReportCommand(CLI::App& app);
void AddRecognizeCommand(CLI::App& app);
void AddCompareCommand(CLI::App& app);
void AddExportCommand(CLI::App& app);
void AddMissionCommand(CLI::App& app);
void AddQueryCommand(CLI::App& app);
void AddTopicsCommand(CLI::App& app);
void AddEchoCommand(CLI::App& app);
void AddSceneCommand(CLI::App& app);
void AddDoctorCommand(CLI::App& app);
void AddManualCommands(CLI::App& app);  ///< The last one: it describes all others.

}  // namespace soffit
