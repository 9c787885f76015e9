#pragma once

#include <atomic>

#include "vehicle_agent/edge/agent_config.h"

namespace soffit {

/// Talks to autopilot and cameras for up to `timeout_s` and prints in plain words what works and what does
/// not. Commands nothing. Returns whether all is well.
bool CheckVehicle(const AgentConfig& config, double timeout_s, const std::atomic<bool>& stop);

}  // namespace soffit
