#pragma once

#include <cstdint>

/// The MAVLink enumerations that we use, as plain numbers under their MAVLink names without the MAV_ prefix.
namespace soffit::mavlink {

enum Autopilot : std::uint8_t { kAutopilotArduPilot = 3, kAutopilotInvalid = 8, kAutopilotPx4 = 12 };

enum VehicleType : std::uint8_t {
  kTypeQuadrotor = 2,
  kTypeGcs = 6,
  kTypeOnboardController = 18,
  kTypeGimbal = 26,
  kTypeCamera = 30
};

enum ComponentId : std::uint8_t {
  kComponentAll = 0,
  kComponentAutopilot = 1,
  kComponentGimbal = 154,
  kComponentMissionPlanner = 190,
  kComponentOnboardComputer = 191,
};

/// HEARTBEAT.base_mode.
enum ModeFlag : std::uint8_t {
  kModeFlagCustomModeEnabled = 1,
  kModeFlagAutoEnabled = 4,
  kModeFlagGuidedEnabled = 8,
  kModeFlagStabilizeEnabled = 16,
  kModeFlagManualInputEnabled = 64,
  kModeFlagSafetyArmed = 128,
};

/// HEARTBEAT.system_status.
enum SystemState : std::uint8_t {
  kStateBoot = 1,
  kStateCalibrating = 2,
  kStateStandby = 3,
  kStateActive = 4,
  kStateCritical = 5,
  kStateEmergency = 6,
};

/// HEARTBEAT.custom_mode of ArduPilot Copter.
enum CopterMode : std::uint32_t {
  kCopterStabilize = 0,
  kCopterAltHold = 2,
  kCopterAuto = 3,
  kCopterGuided = 4,
  kCopterLoiter = 5,
  kCopterRtl = 6,
  kCopterLand = 9,
  kCopterPosHold = 16,
  kCopterBrake = 17,
};

/// PX4's custom_mode: main mode in bits 16 to 23, sub mode in bits 24 to 31.
enum Px4MainMode : std::uint8_t {
  kPx4Manual = 1,
  kPx4AltCtl = 2,
  kPx4PosCtl = 3,
  kPx4Auto = 4,
  kPx4Acro = 5,
  kPx4Offboard = 6,
  kPx4Stabilized = 7,
};
enum Px4AutoMode : std::uint8_t {
  kPx4AutoReady = 1,
  kPx4AutoTakeoff = 2,
  kPx4AutoLoiter = 3,
  kPx4AutoMission = 4,
  kPx4AutoRtl = 5,
  kPx4AutoLand = 6,
};
constexpr std::uint32_t Px4CustomMode(Px4MainMode main_mode, std::uint8_t sub_mode = 0) {
  return std::uint32_t{main_mode} << 16 | std::uint32_t{sub_mode} << 24;
}

/// COMMAND_LONG.command and COMMAND_INT.command.
enum Command : std::uint16_t {
  kCmdNavReturnToLaunch = 20,
  kCmdNavLand = 21,
  kCmdNavTakeoff = 22,
  kCmdConditionYaw = 115,
  kCmdDoSetMode = 176,
  kCmdDoChangeSpeed = 178,
  kCmdDoSetHome = 179,
  kCmdDoReposition = 192,
  kCmdDoSetRoi = 201,
  kCmdDoMountControl = 205,
  kCmdPreflightRebootShutdown = 246,
  kCmdComponentArmDisarm = 400,
  kCmdGetHomePosition = 410,
  kCmdGetMessageInterval = 510,
  kCmdSetMessageInterval = 511,
  kCmdRequestMessage = 512,
  kCmdRequestAutopilotCapabilities = 520,
  kCmdDoGimbalManagerPitchyaw = 1000,
  kCmdDoGimbalManagerConfigure = 1001,
};

/// COMMAND_LONG.param2 of kCmdComponentArmDisarm: do it whatever the checks say.
constexpr float kForceArmDisarm = 21196.0F;

/// COMMAND_ACK.result.
enum CommandResult : std::uint8_t {
  kResultAccepted = 0,
  kResultTemporarilyRejected = 1,
  kResultDenied = 2,
  kResultUnsupported = 3,
  kResultFailed = 4,
  kResultInProgress = 5,
};

enum CoordinateFrame : std::uint8_t {
  kFrameGlobal = 0,
  kFrameLocalNed = 1,
  kFrameGlobalRelativeAlt = 3,
  kFrameGlobalInt = 5,
  kFrameGlobalRelativeAltInt = 6,
  kFrameLocalOffsetNed = 7,
  kFrameBodyNed = 8,
  kFrameBodyOffsetNed = 9,
  kFrameBodyFrd = 12,
};

/// SET_POSITION_TARGET_LOCAL_NED.type_mask: a set bit means that the field is ignored.
enum TypeMask : std::uint16_t {
  kIgnorePosition = 0x007,
  kIgnoreVelocity = 0x038,
  kIgnoreAcceleration = 0x1c0,
  kIsForce = 0x200,
  kIgnoreYaw = 0x400,
  kIgnoreYawRate = 0x800,
};
/// Go to a point with a heading. ArduPilot and PX4 both take it.
constexpr std::uint16_t kPositionAndYaw = kIgnoreVelocity | kIgnoreAcceleration | kIgnoreYawRate;
/// Fly at a velocity with a heading.
constexpr std::uint16_t kVelocityAndYaw = kIgnorePosition | kIgnoreAcceleration | kIgnoreYawRate;

/// EXTENDED_SYS_STATE.landed_state.
enum LandedState : std::uint8_t {
  kLandedUndefined = 0,
  kLandedOnGround = 1,
  kLandedInAir = 2,
  kLandedTakeoff = 3,
  kLandedLanding = 4,
};

/// STATUSTEXT.severity.
enum Severity : std::uint8_t {
  kSeverityEmergency = 0,
  kSeverityAlert = 1,
  kSeverityCritical = 2,
  kSeverityError = 3,
  kSeverityWarning = 4,
  kSeverityNotice = 5,
  kSeverityInfo = 6,
  kSeverityDebug = 7,
};

/// EKF_STATUS_REPORT.flags (ArduPilot) and ESTIMATOR_STATUS.flags (PX4) mean the same up to 0x200.
enum EstimatorFlag : std::uint16_t {
  kEstimatorAttitude = 0x001,
  kEstimatorVelocityHorizontal = 0x002,
  kEstimatorVelocityVertical = 0x004,
  kEstimatorPositionHorizontalRelative = 0x008,
  kEstimatorPositionHorizontalAbsolute = 0x010,
  kEstimatorPositionVerticalAbsolute = 0x020,
  kEstimatorPositionVerticalAboveGround = 0x040,
  kEstimatorConstantPosition = 0x080,
  kEstimatorPredictedPositionRelative = 0x100,
  kEstimatorPredictedPositionAbsolute = 0x200,
  kEstimatorUninitialized = 0x400,
};

/// SYS_STATUS.onboard_control_sensors_*.
constexpr std::uint32_t kSensorGps = 0x20;
constexpr std::uint32_t kSensorBattery = 0x2000000;
constexpr std::uint32_t kSensorPrearmCheck = 0x10000000;

/// GIMBAL_MANAGER_SET_PITCHYAW.flags.
enum GimbalFlag : std::uint32_t { kGimbalRollLock = 4, kGimbalPitchLock = 8, kGimbalYawLock = 16 };

/// REQUEST_DATA_STREAM.req_stream_id.
enum DataStream : std::uint8_t {
  kStreamAll = 0,
  kStreamRawSensors = 1,
  kStreamExtendedStatus = 2,
  kStreamRcChannels = 3,
  kStreamRawController = 4,
  kStreamPosition = 6,
  kStreamExtra1 = 10,
  kStreamExtra2 = 11,
  kStreamExtra3 = 12,
};

/// PARAM_VALUE.param_type.
enum ParamType : std::uint8_t {
  kParamUint8 = 1,
  kParamInt8 = 2,
  kParamInt16 = 4,
  kParamInt32 = 6,
  kParamReal32 = 9
};

/// GPS_RAW_INT.fix_type.
enum GpsFix : std::uint8_t { kGpsNoGps = 0, kGpsNoFix = 1, kGps3dFix = 3, kGpsRtkFixed = 6 };

/// BATTERY_STATUS.charge_state.
enum BatteryChargeState : std::uint8_t { kBatteryOk = 1, kBatteryLow = 2, kBatteryCritical = 3 };

}  // namespace soffit::mavlink
