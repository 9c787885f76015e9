#include "vehicle_agent/edge/develop.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shared/result/say.h"

namespace soffit {
namespace {

std::string MakeName(const ExposureRequest& request) {
  char number[16];
  std::snprintf(number, sizeof number, "%03u", request.capture_id);
  return std::string(number) + "_" + ToString(request.purpose) + ".jpg";
}

}  // namespace

Capture MakeCapture(const ExposureRequest& request, Picture picture, const CameraOptions& options,
                    const PoseBuffer& poses, const ExposureContext& context) {
  const Telemetry& telemetry = context.telemetry;
  std::optional<Pose<Map, Body>> map_from_body = poses.FindBody(picture.exposure_utc_ns);
  bool is_trusted = map_from_body.has_value() && context.trusts_poses && picture.has_trusted_time;
  if (!map_from_body) map_from_body = Pose<Map, Body>{telemetry.map_from_body, telemetry.position_in_map_m};
  const Pose<Body, Camera> mount = BodyFromCamera(options.mount);

  Capture capture;
  capture.vehicle_id = context.vehicle_id;
  capture.mission_id = request.mission_id;
  capture.capture_id = request.capture_id;
  capture.name = MakeName(request);
  capture.purpose = request.purpose;
  capture.exposure_utc_ns = picture.exposure_utc_ns;
  capture.intrinsics = MakeIntrinsics(options).value();
  capture.map_from_camera = *map_from_body * mount;
  if (request.camera == CameraId::kGimbal) {
    const std::optional<Eigen::Quaterniond> map_from_gimbal = poses.FindGimbal(picture.exposure_utc_ns);
    is_trusted = is_trusted && map_from_gimbal.has_value();
    if (map_from_gimbal) capture.map_from_camera.rotation = (*map_from_gimbal * mount.rotation).normalized();
  }
  capture.has_trusted_pose = is_trusted;
  capture.position_std_m = std::hypot(telemetry.position_std_m,
                                      telemetry.velocity_in_map_mps.norm() * context.clock_uncertainty_s);
  capture.orientation_std_rad =
      std::hypot(telemetry.orientation_std_rad, telemetry.rotation_rate_radps * context.clock_uncertainty_s);
  capture.bytes = std::move(picture.bytes);
  return capture;
}

std::string FindBlurProblem(const Picture& picture, const CameraOptions& options, const PoseBuffer& poses) {
  const auto rate_radps = poses.FindRate_radps(picture.exposure_utc_ns);
  if (!rate_radps) return {};
  const double blur_px = *rate_radps * picture.shutter_s * std::max(options.fx_px, options.fy_px);
  if (blur_px <= options.max_blur_px) return {};
  return Say("the picture is blurred: the vehicle turned by ", blur_px, " px in ", picture.shutter_s, " s");
}

}  // namespace soffit
