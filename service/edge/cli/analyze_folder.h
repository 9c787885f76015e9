#pragma once

#include <filesystem>

#include "service/edge/files/analysis.h"
#include "shared/result/result.h"

namespace soffit {

struct FolderAnalysis {
  Survey survey;
  Analysis analysis;
};

/// Reads a survey folder and runs the stages on it, with the options in `config_file` (empty: the defaults).
Result<FolderAnalysis> AnalyzeFolder(const std::filesystem::path& folder,
                                     const std::filesystem::path& config_file);

}  // namespace soffit
