#include "vehicle_agent/edge/agent_config.h"

#include "shared/dds/link_profile.h"
#include "shared/geometry/polygon.h"

namespace soffit {

std::string FindConfigProblem(const AgentConfig& config) {
  for (const auto& [id, options] : ListCameras(config)) {
    const std::string name = std::string("cameras.") + ToString(id);
    if (!options->pipeline.empty() && !options->folder.empty()) {
      return name + ": pipeline and folder are both set, only one can be";
    }
    const Result<Intrinsics> intrinsics = MakeIntrinsics(*options);
    if (!intrinsics.ok()) return name + "." + intrinsics.error().message;
  }
  if (const auto profile = FindLinkProfile(config.radio); !profile.ok()) {
    return "radio." + profile.error().message;
  }
  if (!config.guard.fence.empty()) {
    Ring ring;
    for (const FenceCorner& corner : config.guard.fence) ring.emplace_back(corner.east_m, corner.north_m);
    if (!IsSimple(ring))
      return "guard.fence: must have three corners or more, and no two of its sides may cross";
    if (!Contains(ring, Eigen::Vector2d::Zero())) return "guard.fence: home, at (0, 0), must be inside";
  }
  if (config.agent.return_after_silence_s <= config.agent.hold_after_silence_s) {
    return "agent.return_after_silence_s: must be longer than hold_after_silence_s";
  }
  if (const std::string problem = FindPolicyProblem(config.agent.on_failure); !problem.empty()) {
    return "agent.on_failure." + problem;
  }
  if (config.guard.floor_m >= config.guard.ceiling_m) return "guard.floor_m: must be below ceiling_m";
  return {};
}

AgentIdentity MakeIdentity(const AgentConfig& config, std::uint64_t epoch) {
  AgentIdentity identity;
  identity.vehicle_id = static_cast<std::uint32_t>(config.vehicle.id);
  identity.epoch = epoch;
  identity.name = config.vehicle.name;
  identity.envelope = {config.vehicle.radius_m, config.vehicle.height_m, config.vehicle.safety_margin_m};
  for (const auto& [id, options] : ListCameras(config)) {
    identity.cameras.push_back(id);
    // The list ends with the gimbal's camera, which is used for all looks when there is one.
    if (id != CameraId::kDown || identity.cameras.size() == 1)
      identity.camera = MakeIntrinsics(*options).value();
  }
  return identity;
}

}  // namespace soffit
