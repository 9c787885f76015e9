#include "service/edge/ros/camera_messages.h"

#include "service/edge/ros/frame_messages.h"

namespace soffit::ros {
namespace {

std::string CameraFrame(const Capture& capture) {
  return VehicleFrame(capture.vehicle_id, "camera_optical_frame");
}

}  // namespace

CompressedImage_ MakeCompressedImage(const Capture& capture) {
  const bool is_png = !capture.bytes.empty() && capture.bytes.front() == 0x89;
  CompressedImage_ image;
  image.header_(MakeHeader(capture.exposure_utc_ns, CameraFrame(capture)));
  image.format_(is_png ? "bgr8; png compressed bgr8" : "bgr8; jpeg compressed bgr8");
  image.data_(capture.bytes);
  return image;
}

CameraInfo_ MakeCameraInfo(const Capture& capture) {
  const Intrinsics& camera = capture.intrinsics;
  CameraInfo_ info;
  info.header_(MakeHeader(capture.exposure_utc_ns, CameraFrame(capture)));
  info.width_(static_cast<std::uint32_t>(camera.width_px));
  info.height_(static_cast<std::uint32_t>(camera.height_px));
  info.distortion_model_("plumb_bob");
  info.d_().assign(camera.distortion.begin(), camera.distortion.end());
  info.k_({camera.fx_px, 0.0, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0});
  info.r_({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0});
  info.p_({camera.fx_px, 0.0, camera.cx_px, 0.0, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 0.0, 1.0, 0.0});
  return info;
}

TFMessage_ MakeCameraTransform(const Capture& capture) {
  TFMessage_ message;
  message.transforms_(
      {MakeTransform(capture.exposure_utc_ns, kMapFrame, CameraFrame(capture),
                     capture.map_from_camera.translation_m, capture.map_from_camera.rotation)});
  return message;
}

}  // namespace soffit::ros
