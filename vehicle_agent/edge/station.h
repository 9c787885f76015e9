#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shared/dds/reader.h"
#include "shared/dds/writer.h"
#include "shared/wire/topics.h"
#include "vehicle_agent/agent/agent.h"
#include "vehicle_agent/autopilot/autopilot_client.h"
#include "vehicle_agent/edge/agent_config.h"
#include "vehicle_agent/edge/autopilot_line.h"
#include "vehicle_agent/edge/camera_post.h"
#include "vehicle_agent/edge/mailbox.h"
#include "vehicle_agent/edge/picture_sender.h"
#include "vehicle_agent/edge/supervisor.h"

namespace soffit {

/// The running agent: autopilot, cameras and bus on one side, the agent's mind on the other.
class Station {
 public:
  /// @param epoch  UTC nanoseconds of the start.
  /// An error when the link cannot be opened or the domain cannot be entered.
  static Result<std::unique_ptr<Station>> Open(const AgentConfig& config, std::uint64_t epoch);

  /// Works until `stop` is set. A missing autopilot, camera or service is waited for and told in the
  /// vehicle's state.
  void Run(const std::atomic<bool>& stop);

 private:
  struct Negative {  ///< A picture that waits for the pose of its exposure.
    PictureTaken taken;
    Instant since;
  };

  Station(const AgentConfig& config, const LinkProfile& profile, std::uint64_t epoch, AutopilotLine line,
          Participant radio);

  void ExchangeWithAutopilot(Instant now);
  void OpenLetters(Instant now);
  void Open(const FlightCommand& command, Instant now) { Tell(command, now); }
  void Open(const ServiceHeartbeat& heartbeat, Instant now) { Tell(heartbeat, now); }
  void Open(const RivalHeard& rival, Instant now) { Tell(rival, now); }
  void Open(const PictureDelivered& delivered, Instant now);
  void Open(const CameraTried& tried, Instant now);
  void Open(const PictureTaken& taken, Instant now);
  void DevelopPictures(Instant now);
  void PublishState(Instant now);
  void Tell(const AgentEvent& event, Instant now);

  AgentConfig config_;
  AutopilotLine line_;
  AutopilotClient autopilot_;
  Agent agent_;
  Mailbox mailbox_;
  Participant radio_;
  Writer<VehicleStateTopic> states_;
  Writer<CommandAckTopic> acks_;
  PictureSender sender_;
  Reader<FlightCommandTopic> commands_;
  Reader<MissionHeartbeatTopic> heartbeats_;
  Reader<VehicleStateTopic> others_;
  std::map<CameraId, std::unique_ptr<CameraPost>> cameras_;
  CameraHealth health_;
  std::vector<Negative> negatives_;
  Supervisor supervisor_;
  Instant published_;
  std::string told_message_;
  VehiclePhase told_phase_ = VehiclePhase::kNotReady;
};

/// Both clocks, read together.
Instant ReadClocks();

}  // namespace soffit
