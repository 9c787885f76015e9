#pragma once

#include <memory>
#include <string>
#include <vector>

#include "service/edge/dds/messages.h"
#include "service/pipeline/pipeline.h"
#include "service/query/occupancy.h"

namespace soffit {

/// What one mission knows at one time. Never modified, shared freely between threads.
struct SceneSnapshot {
  Origin origin;
  std::int64_t stamp_utc_ns = 0;
  std::shared_ptr<const Understanding> understanding;  ///< Null: nothing was understood yet.
  std::vector<DecisionReport> decisions;
  VehicleEnvelope vehicle;     ///< The mission's.
  std::string reference_name;  ///< What it looks for.
};

/// The newest revisions of one mission's scene, oldest first, and what there was of all of them.
struct SceneHistory {
  std::vector<std::shared_ptr<const SceneSnapshot>> kept;
  std::vector<Revision> revisions;
};

/// The history with one more revision. That of another mission begins anew; one without an understanding is
/// no revision. Pure.
SceneHistory Extend(const SceneHistory& history, std::shared_ptr<const SceneSnapshot> snapshot);

BuildingModelReport ReportModel(const Origin& origin, const Solid& solid);

/// Answers one question from one revision. What is wrong with it, does not exist, is too large or takes too
/// long is said by the reply's status and in words. Pure.
SceneReply AnswerQuery(const SceneQuery& query, const SceneHistory& history, const PipelineOptions& options,
                       const IsLate& is_late);

}  // namespace soffit
