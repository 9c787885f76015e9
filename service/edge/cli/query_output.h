#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "service/edge/dds/messages.h"

namespace soffit {

/// What the reply says about a question of that kind, for programs.
nlohmann::json AnswerToJson(SceneQueryKind kind, const SceneReply& reply);

/// The same for people, in lines.
std::string DescribeAnswer(SceneQueryKind kind, const SceneReply& reply);

}  // namespace soffit
