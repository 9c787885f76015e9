#include "service/edge/cli/analyze_folder.h"

#include "shared/options/yaml.h"

namespace soffit {

Result<FolderAnalysis> AnalyzeFolder(const std::filesystem::path& folder,
                                     const std::filesystem::path& config_file) {
  PipelineOptions options;
  if (!config_file.empty()) {
    const Result<PipelineOptions> read = ReadOptionsFile<PipelineOptions>(config_file.string());
    if (!read.ok()) return read.error();
    options = read.value();
  }
  Result<Survey> survey = ReadSurvey(folder);
  if (!survey.ok()) return survey.error();
  const Result<Reference> reference = ReadReferenceFile(folder / survey.value().reference_file);
  if (!reference.ok()) return reference.error();
  if (!survey.value().colors.empty()) options.mask.colors = survey.value().colors;
  Result<Analysis> analysis = Analyze(folder, survey.value(), reference.value(), options);
  if (!analysis.ok()) return analysis.error();
  return FolderAnalysis{std::move(survey).value(), std::move(analysis).value()};
}

}  // namespace soffit
