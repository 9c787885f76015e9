#include "vehicle_agent/autopilot/dialect.h"

#include "vehicle_agent/mavlink/constants.h"

namespace soffit {
namespace {

using namespace mavlink;

std::uint8_t MainMode(std::uint32_t custom_mode) { return static_cast<std::uint8_t>(custom_mode >> 16); }
std::uint8_t SubMode(std::uint32_t custom_mode) { return static_cast<std::uint8_t>(custom_mode >> 24); }

const char* FindCopterName(std::uint32_t mode) {
  switch (mode) {
    case kCopterStabilize:
      return "STABILIZE";
    case kCopterAltHold:
      return "ALT_HOLD";
    case kCopterAuto:
      return "AUTO";
    case kCopterGuided:
      return "GUIDED";
    case kCopterLoiter:
      return "LOITER";
    case kCopterRtl:
      return "RTL";
    case kCopterLand:
      return "LAND";
    case kCopterPosHold:
      return "POSHOLD";
    case kCopterBrake:
      return "BRAKE";
    default:
      return nullptr;
  }
}

const char* FindPx4Name(std::uint32_t mode) {
  switch (MainMode(mode)) {
    case kPx4Manual:
      return "MANUAL";
    case kPx4AltCtl:
      return "ALTCTL";
    case kPx4PosCtl:
      return "POSCTL";
    case kPx4Acro:
      return "ACRO";
    case kPx4Offboard:
      return "OFFBOARD";
    case kPx4Stabilized:
      return "STABILIZED";
    case kPx4Auto:
      break;
    default:
      return nullptr;
  }
  switch (SubMode(mode)) {
    case kPx4AutoReady:
      return "AUTO.READY";
    case kPx4AutoTakeoff:
      return "AUTO.TAKEOFF";
    case kPx4AutoLoiter:
      return "AUTO.LOITER";
    case kPx4AutoMission:
      return "AUTO.MISSION";
    case kPx4AutoRtl:
      return "AUTO.RTL";
    case kPx4AutoLand:
      return "AUTO.LAND";
    default:
      return nullptr;
  }
}

}  // namespace

const char* ToString(Dialect dialect) {
  switch (dialect) {
    case Dialect::kArduPilot:
      return "ArduPilot";
    case Dialect::kPx4:
      return "PX4";
    case Dialect::kUnknown:
      break;
  }
  return "";
}

Dialect DialectOf(std::uint8_t autopilot) {
  if (autopilot == kAutopilotArduPilot) return Dialect::kArduPilot;
  return autopilot == kAutopilotPx4 ? Dialect::kPx4 : Dialect::kUnknown;
}

std::string DescribeMode(Dialect dialect, std::uint32_t custom_mode) {
  const char* name = dialect == Dialect::kPx4 ? FindPx4Name(custom_mode) : FindCopterName(custom_mode);
  return name != nullptr ? name : "mode " + std::to_string(custom_mode);
}

bool IsCommandMode(Dialect dialect, std::uint32_t custom_mode) {
  if (dialect == Dialect::kPx4) return MainMode(custom_mode) == kPx4Offboard;
  return dialect == Dialect::kArduPilot && custom_mode == kCopterGuided;
}

bool IsLandMode(Dialect dialect, std::uint32_t custom_mode) {
  if (dialect == Dialect::kPx4) return custom_mode == Px4CustomMode(kPx4Auto, kPx4AutoLand);
  return dialect == Dialect::kArduPilot && custom_mode == kCopterLand;
}

CommandLong MakeEnterCommandMode(Dialect dialect) {
  CommandLong command;
  command.command = kCmdDoSetMode;
  command.param1 = kModeFlagCustomModeEnabled;
  command.param2 = dialect == Dialect::kPx4 ? float{kPx4Offboard} : static_cast<float>(kCopterGuided);
  return command;
}

CommandLong MakeLand(Dialect dialect) {
  CommandLong command;
  if (dialect == Dialect::kPx4) {
    command.command = kCmdNavLand;
    return command;
  }
  command.command = kCmdDoSetMode;
  command.param1 = kModeFlagCustomModeEnabled;
  command.param2 = static_cast<float>(kCopterLand);
  return command;
}

}  // namespace soffit
