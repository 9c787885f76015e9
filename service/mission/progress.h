#pragma once

#include "service/mission/mission.h"

namespace soffit {

/// Brings the progress in the status up to date, from the step, its views and the errand. It never falls.
void TellProgress(Mission& mission);

}  // namespace soffit
