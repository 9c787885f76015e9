#pragma once

#include "service/mission/mission.h"
#include "service/pipeline/pipeline.h"

namespace soffit {

/// What a mission has to know of what all pictures together show.
Findings MakeFindings(const Understanding& understanding);

}  // namespace soffit
