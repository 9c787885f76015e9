#include "service/mission/mission.h"

namespace soffit {

const char* ToString(MissionState state) {
  switch (state) {
    case MissionState::kNone:
      return "none";
    case MissionState::kWaiting:
      return "waiting";
    case MissionState::kFlying:
      return "flying";
    case MissionState::kPaused:
      return "paused";
    case MissionState::kReturning:
      return "returning";
    case MissionState::kEnded:
      return "ended";
  }
  return "none";
}

const char* ToString(MissionStep step) {
  switch (step) {
    case MissionStep::kNone:
      return "none";
    case MissionStep::kWaitForVehicle:
      return "wait for vehicle";
    case MissionStep::kTakeOff:
      return "take off";
    case MissionStep::kOverview:
      return "overview";
    case MissionStep::kRecognize:
      return "recognize";
    case MissionStep::kTop:
      return "top";
    case MissionStep::kWalls:
      return "walls";
    case MissionStep::kDecide:
      return "decide";
    case MissionStep::kLookAgain:
      return "look again";
    case MissionStep::kEnter:
      return "enter";
    case MissionStep::kReturn:
      return "return";
    case MissionStep::kLand:
      return "land";
    case MissionStep::kDone:
      return "done";
  }
  return "none";
}

const char* ToString(MissionOutcome outcome) {
  switch (outcome) {
    case MissionOutcome::kNone:
      return "none";
    case MissionOutcome::kFlown:
      return "flown";
    case MissionOutcome::kBlocked:
      return "blocked";
    case MissionOutcome::kInsufficientData:
      return "insufficient data";
    case MissionOutcome::kNoMatch:
      return "no match";
    case MissionOutcome::kAmbiguous:
      return "ambiguous";
    case MissionOutcome::kAborted:
      return "aborted";
    case MissionOutcome::kFailed:
      return "failed";
  }
  return "none";
}

}  // namespace soffit
