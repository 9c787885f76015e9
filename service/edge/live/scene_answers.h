#pragma once

#include <vector>

#include "service/edge/dds/messages.h"
#include "service/pipeline/pipeline.h"

namespace soffit {

/// All that can be asked about one mission's scene.
struct KnownScene {
  Origin origin;
  const Understanding* understanding = nullptr;  ///< Null: nothing was understood yet.
  std::vector<DecisionReport> decisions;
};

BuildingModelReport ReportModel(const Origin& origin, const Solid& solid);

/// Answers one question. A box of more than 10^7 voxels, or one that is empty, is refused; so is what does
/// not exist. Pure.
SceneReply AnswerQuery(const SceneQuery& query, const KnownScene& scene);

}  // namespace soffit
