#pragma once

#include <string>
#include <vector>

#include "shared/dds/participant.h"
#include "shared/options/options.h"
#include "vehicle_agent/agent/agent.h"
#include "vehicle_agent/autopilot/autopilot_client.h"
#include "vehicle_agent/camera/camera.h"
#include "vehicle_agent/guard/guard.h"

namespace soffit {

struct VehicleOptions {
  int id = 1;
  std::string name = "vehicle";
  double radius_m = 0.35;
  double height_m = 0.30;
  double safety_margin_m = 0.25;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("id", self.id, OptionInfo{1, 1e9, "", "Differs for every vehicle in the domain"});
    field("name", self.name, OptionInfo{0, 0, "", "For people"});
    field("radius_m", self.radius_m,
          OptionInfo{0.01, 50.0, "m", "Of the upright cylinder that holds the whole vehicle"});
    field("height_m", self.height_m,
          OptionInfo{0.01, 50.0, "m", "Of that cylinder, about the vehicle's centre"});
    field("safety_margin_m", self.safety_margin_m, OptionInfo{0.0, 50.0, "m", "Kept from everything"});
  }
};

struct CameraSetOptions {
  CameraOptions forward;
  CameraOptions down;
  CameraOptions gimbal;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("forward", self.forward);
    field("down", self.down);
    field("gimbal", self.gimbal);
  }
};

/// Everything that can be set of soffit-agent.
struct AgentConfig {
  VehicleOptions vehicle;
  std::string mavlink = "udpin:127.0.0.1:14550";
  std::string mavlink_key_file;
  double state_rate_hz = 10.0;
  double pose_wait_s = 0.5;
  double send_timeout_s = 40.0;
  std::string log_level = "info";
  DdsOptions radio = DefaultRadioOptions();
  AutopilotOptions autopilot;
  AgentOptions agent;
  GuardOptions guard;
  CameraSetOptions cameras;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("vehicle", self.vehicle);
    field("mavlink", self.mavlink,
          OptionInfo{
              0, 0, "",
              "Link to the autopilot: udpin:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT, serial:DEVICE:BAUD"});
    field(
        "mavlink_key_file", self.mavlink_key_file,
        OptionInfo{0, 0, "",
                   "64 hexadecimal digits: what is sent is signed, what is not signed is refused; empty: no "
                   "signatures"});
    field("state_rate_hz", self.state_rate_hz,
          OptionInfo{2.0, 50.0, "Hz", "How often the vehicle's state is published"});
    field("pose_wait_s", self.pose_wait_s,
          OptionInfo{0.0, 5.0, "s", "How long a picture waits for the pose of its exposure"});
    field("send_timeout_s", self.send_timeout_s,
          OptionInfo{1.0, 300.0, "s", "For one picture to arrive at the service"});
    field("log_level", self.log_level, OptionInfo{0, 0, "", "trace, debug, info, warning, error"});
    field("radio", self.radio);
    field("autopilot", self.autopilot);
    field("agent", self.agent);
    field("guard", self.guard);
    field("cameras", self.cameras);
  }
};

/// The cameras that the vehicle has, with their options.
inline std::vector<std::pair<CameraId, const CameraOptions*>> ListCameras(const AgentConfig& config) {
  std::vector<std::pair<CameraId, const CameraOptions*>> cameras;
  for (const auto& [id, options] : {std::pair{CameraId::kForward, &config.cameras.forward},
                                    std::pair{CameraId::kDown, &config.cameras.down},
                                    std::pair{CameraId::kGimbal, &config.cameras.gimbal}}) {
    if (IsPresent(*options)) cameras.emplace_back(id, options);
  }
  return cameras;
}

/// What the bounds of single options cannot say; empty when all is well.
std::string FindConfigProblem(const AgentConfig& config);

AgentIdentity MakeIdentity(const AgentConfig& config, std::uint64_t epoch);

}  // namespace soffit
