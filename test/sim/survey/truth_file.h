#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "test/sim/survey/frames.h"

namespace soffit::sim {

/// The truth of a survey, in the format that the scorer of surveys reads (soffit-truth/1).
nlohmann::json DescribeTruth(const World& world, const Truth& truth, const std::vector<SurveyFrame>& frames);

/// What the analyzer is given (soffit-survey/1).
nlohmann::json DescribeSurvey(const World& world, const std::vector<SurveyFrame>& frames);

}  // namespace soffit::sim
