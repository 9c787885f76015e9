#pragma once

#include <memory>
#include <vector>

#include "service/edge/dds/messages.h"
#include "service/pipeline/pipeline.h"

namespace soffit {

/// What one mission knows at one time. Never modified, shared freely between threads.
struct SceneSnapshot {
  Origin origin;
  std::int64_t stamp_utc_ns = 0;
  std::shared_ptr<const Understanding> understanding;  ///< Null: nothing was understood yet.
  std::vector<DecisionReport> decisions;
};

BuildingModelReport ReportModel(const Origin& origin, const Solid& solid);

/// Answers one question. A box of more than 10^7 voxels, or one that is empty, is refused; so is what does
/// not exist. Pure.
SceneReply AnswerQuery(const SceneQuery& query, const SceneSnapshot& scene);

}  // namespace soffit
