#include "shared/flight/flight.h"

#include <cmath>

namespace soffit {

bool IsValid(const VehicleEnvelope& e) {
  return std::isfinite(e.radius_m) && std::isfinite(e.height_m) && std::isfinite(e.safety_margin_m) &&
         e.radius_m > 0.0 && e.height_m > 0.0 && e.safety_margin_m >= 0.0;
}

const char* ToString(VehiclePhase phase) {
  switch (phase) {
    case VehiclePhase::kNotReady:
      return "not ready";
    case VehiclePhase::kOnGround:
      return "on ground";
    case VehiclePhase::kTakingOff:
      return "taking off";
    case VehiclePhase::kHolding:
      return "holding";
    case VehiclePhase::kInTransit:
      return "in transit";
    case VehiclePhase::kLooking:
      return "looking";
    case VehiclePhase::kInCorridor:
      return "in corridor";
    case VehiclePhase::kLanding:
      return "landing";
    case VehiclePhase::kPilotInControl:
      return "pilot in control";
  }
  return "not ready";
}

const char* ToString(CommandKind kind) {
  switch (kind) {
    case CommandKind::kHold:
      return "hold";
    case CommandKind::kTakeOff:
      return "take off";
    case CommandKind::kLook:
      return "look";
    case CommandKind::kFlyCorridor:
      return "fly corridor";
    case CommandKind::kGoTo:
      return "go to";
    case CommandKind::kLand:
      return "land";
    case CommandKind::kAbort:
      return "abort";
  }
  return "hold";
}

const char* ToString(AckStatus status) {
  switch (status) {
    case AckStatus::kAccepted:
      return "accepted";
    case AckStatus::kRefused:
      return "refused";
    case AckStatus::kDone:
      return "done";
    case AckStatus::kFailed:
      return "failed";
    case AckStatus::kUnknown:
      break;
  }
  return "unknown";
}

}  // namespace soffit
