#pragma once

#include <string>

#include "shared/capture/capture.h"
#include "vehicle_agent/agent/agent.h"
#include "vehicle_agent/camera/camera.h"
#include "vehicle_agent/pose/pose_buffer.h"

namespace soffit {

/// What is known of a picture beside its bytes when it is made into a capture.
struct ExposureContext {
  std::uint32_t vehicle_id = 0;
  Telemetry telemetry;  ///< Of now.
  bool trusts_poses = false;
  double clock_uncertainty_s = 0.0;  ///< Of the autopilot's clock.
};

/// The pose of the camera at the exposure by the buffer. Without a pose there, the present one. Trusted when
/// it is there, the estimator is well and the camera's clock is ours. `camera` says how the pose is made up:
/// a fixed mount turns with the body, a gimbal's with the gimbal.
Capture MakeCapture(const ExposureRequest& request, Picture picture, const CameraOptions& options,
                    const PoseBuffer& poses, const ExposureContext& context);

/// How a picture is blurred, as far as the vehicle turned while the shutter was open; empty: it is sharp
/// enough, or the rate is not known.
std::string FindBlurProblem(const Picture& picture, const CameraOptions& options, const PoseBuffer& poses);

}  // namespace soffit
