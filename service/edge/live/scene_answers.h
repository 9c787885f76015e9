#pragma once

#include <memory>
#include <string>
#include <vector>

#include "service/edge/dds/messages.h"
#include "service/edge/store/kept.h"
#include "service/pipeline/pipeline.h"
#include "service/query/occupancy.h"

namespace soffit {

/// The newest revisions of one mission's scene, oldest first, and what there was of all of them.
struct SceneHistory {
  std::vector<std::shared_ptr<const SceneSnapshot>> kept;
  std::vector<Revision> revisions;
};

/// `revisions` of which only the last are `kept`, oldest first.
SceneHistory MakeHistory(std::vector<Revision> revisions,
                         std::vector<std::shared_ptr<const SceneSnapshot>> kept);

/// The history with one more revision. That of another mission begins anew; one without an understanding is
/// no revision. Pure.
SceneHistory Extend(const SceneHistory& history, std::shared_ptr<const SceneSnapshot> snapshot);

BuildingModelReport ReportModel(const Origin& origin, const Solid& solid);

/// Answers one question from one revision. What is wrong with it, does not exist, is too large or takes too
/// long is said by the reply's status and in words. Pure.
SceneReply AnswerQuery(const SceneQuery& query, const SceneHistory& history, const PipelineOptions& options,
                       const IsLate& is_late);

}  // namespace soffit
