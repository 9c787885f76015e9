#pragma once

#include <cstdint>
#include <string>

#include "vehicle_agent/mavlink/messages.h"

namespace soffit {

/// The autopilot's make, which the heartbeat tells. The zero value is no autopilot that we can command.
enum class Dialect { kUnknown, kArduPilot, kPx4 };
const char* ToString(Dialect dialect);  ///< "ArduPilot", "PX4", "".
Dialect DialectOf(std::uint8_t autopilot);

// Where the makes differ.
std::string DescribeMode(Dialect dialect,
                         std::uint32_t custom_mode);  ///< "GUIDED"; "mode 42" when it has no name here.
bool IsCommandMode(Dialect dialect, std::uint32_t custom_mode);  ///< GUIDED or OFFBOARD.
bool IsLandMode(Dialect dialect, std::uint32_t custom_mode);
mavlink::CommandLong MakeEnterCommandMode(Dialect dialect);
mavlink::CommandLong MakeLand(Dialect dialect);

}  // namespace soffit
