#pragma once

#include "shared/capture/capture.h"
#include "shared/dds/topic.h"
#include "shared/flight/flight.h"
#include "shared/result/result.h"
#include "soffitPubSubTypes.h"

namespace soffit {

// The topics between vehicle and service, as Reader and Writer take them.
//
// ToWire never fails: texts that are too long are cut. FromWire takes anything and gives an error unless
// every number is finite and in its range, every enumerator is known and every size is within its limit.

struct VehicleStateTopic {
  using Value = VehicleState;
  using Support = wire::VehicleStatePubSubType;
  static constexpr const char* kName = "soffit/vehicle_state/v1";
  static constexpr TopicKind kKind = TopicKind::kState;
  static wire::VehicleState ToWire(const VehicleState& value);
  static Result<VehicleState> FromWire(const wire::VehicleState& message);
};

struct CaptureTopic {
  using Value = Capture;
  using Support = wire::CapturePubSubType;
  static constexpr const char* kName = "soffit/capture/v1";
  static constexpr TopicKind kKind = TopicKind::kPicture;
  static wire::Capture ToWire(const Capture& value);
  static Result<Capture> FromWire(const wire::Capture& message);
};

struct FlightCommandTopic {
  using Value = FlightCommand;
  using Support = wire::FlightCommandPubSubType;
  static constexpr const char* kName = "soffit/flight_command/v1";
  static constexpr TopicKind kKind = TopicKind::kCommand;
  static wire::FlightCommand ToWire(const FlightCommand& value);
  static Result<FlightCommand> FromWire(const wire::FlightCommand& message);
};

struct CommandAckTopic {
  using Value = CommandAck;
  using Support = wire::CommandAckPubSubType;
  static constexpr const char* kName = "soffit/command_ack/v1";
  static constexpr TopicKind kKind = TopicKind::kCommand;
  static wire::CommandAck ToWire(const CommandAck& value);
  static Result<CommandAck> FromWire(const wire::CommandAck& message);
};

struct MissionHeartbeatTopic {
  using Value = MissionHeartbeat;
  using Support = wire::MissionHeartbeatPubSubType;
  static constexpr const char* kName = "soffit/mission_heartbeat/v1";
  static constexpr TopicKind kKind = TopicKind::kState;
  static wire::MissionHeartbeat ToWire(const MissionHeartbeat& value);
  static Result<MissionHeartbeat> FromWire(const wire::MissionHeartbeat& message);
};

}  // namespace soffit
