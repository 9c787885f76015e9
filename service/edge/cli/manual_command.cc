#include <iostream>

#include "service/edge/cli/commands.h"
#include "service/edge/cli/manual.h"

namespace soffit {

void AddManualCommands(CLI::App& app) {
  app.add_subcommand("manual", "Prints this program's manual page: soffit manual | man -l -")
      ->callback([&app] { std::cout << WriteManual(app); });
  app.add_subcommand("completion",
                     "Prints what completes this program's words in bash: source <(soffit completion)")
      ->callback([&app] { std::cout << WriteBashCompletion(app); });
}

}  // namespace soffit
