#include "service/edge/cli/manual.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "service/edge/cli/commands.h"

namespace soffit {
namespace {

using ::testing::HasSubstr;

/// What bash would offer for the last of these words.
std::string Complete(const std::string& script, const std::string& words) {
  const auto file =
      std::filesystem::temp_directory_path() / ("soffit_completion_" + std::to_string(getpid()));
  std::ofstream(file) << script << "COMP_WORDS=(" << words
                      << ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_soffit\necho \"${COMPREPLY[@]}\"\n";
  FILE* bash = popen(("bash " + file.string() + " 2>&1").c_str(), "r");
  std::string said;
  for (std::array<char, 256> part; fgets(part.data(), part.size(), bash) != nullptr;) said += part.data();
  pclose(bash);
  std::filesystem::remove(file);
  return said;
}

class Manual : public ::testing::Test {
 protected:
  Manual() {
    AddExportCommand(app_);
    AddMissionCommand(app_);
    AddManualCommands(app_);
  }
  CLI::App app_{"Does things - well.", "soffit"};
};

TEST_F(Manual, TellsEveryCommandWithItsOptions) {
  const std::string page = WriteManual(app_);
  EXPECT_THAT(page, HasSubstr("soffit \\- Does things \\- well."));
  EXPECT_THAT(page, HasSubstr(".SS soffit export\n"));
  EXPECT_THAT(page, HasSubstr(".SS soffit mission start\n"));
  EXPECT_THAT(page, HasSubstr(".B \\-\\-format\n"));
  EXPECT_THAT(page, HasSubstr("(required)"));
}

TEST_F(Manual, CompletesCommandsOptionsAndValues) {
  const std::string script = WriteBashCompletion(app_);
  EXPECT_EQ(Complete(script, "soffit e"), "export\n");
  EXPECT_THAT(Complete(script, "soffit mission ''"), HasSubstr("abort"));
  EXPECT_EQ(Complete(script, "soffit export --form"), "--format\n");
  EXPECT_EQ(Complete(script, "soffit export x.gpkg --format g"), "glb gpkg geojson\n");
  EXPECT_EQ(Complete(script, "soffit nonsense --"), Complete(script, "soffit --"));
}

}  // namespace
}  // namespace soffit
