#pragma once

#include <filesystem>

#include "service/edge/files/survey.h"
#include "service/pipeline/pipeline.h"
#include "shared/result/result.h"

namespace soffit {

struct Analysis {
  std::vector<Observation> observations;  ///< Of the pictures that could be used, in the order of the survey.
  Understanding understanding;            ///< Its `problems` name the pictures that could not.
};

/// Runs the service's stages on a survey, pictures in parallel; the answer does not depend on the number of
/// threads. Each picture is read from `folder` when its turn comes. An error when none can be used.
Result<Analysis> Analyze(const std::filesystem::path& folder, const Survey& survey,
                         const Reference& reference, const PipelineOptions& options);

}  // namespace soffit
