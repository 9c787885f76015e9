#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "shared/capture/capture.h"
#include "shared/options/options.h"
#include "shared/result/result.h"
#include "vehicle_agent/pose/camera_mount.h"

namespace soffit {

/// One camera: where its pictures come from, its lens, and how it sits on the vehicle.
struct CameraOptions {
  std::string pipeline;
  std::string folder;
  bool is_stream = false;
  double latency_s = 0.1;
  double shutter_s = 0.02;
  double max_blur_px = 5.0;
  double timeout_s = 10.0;
  int width_px = 1280;
  int height_px = 960;
  double fx_px = 850.0;
  double fy_px = 850.0;
  double cx_px = 639.5;
  double cy_px = 479.5;
  std::vector<double> distortion = {0.0, 0.0, 0.0, 0.0, 0.0};
  CameraMount mount;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("pipeline", self.pipeline,
          OptionInfo{0, 0, "", "GStreamer pipeline that gives JPEG, without a sink; empty: no such camera"});
    field("folder", self.folder,
          OptionInfo{0, 0, "", "Instead: a folder of JPEG pictures, taken in the order of their names"});
    field("is_stream", self.is_stream,
          OptionInfo{0, 1, "",
                     "true: the pipeline runs all the time, each buffer is a picture; false: it is started "
                     "for each picture and runs to its end"});
    field("latency_s", self.latency_s,
          OptionInfo{0.0, 10.0, "s",
                     "From exposure to arrival, where EXIF does not tell the time of exposure"});
    field("shutter_s", self.shutter_s,
          OptionInfo{1e-6, 10.0, "s", "How long the shutter is open, where EXIF does not tell"});
    field("max_blur_px", self.max_blur_px,
          OptionInfo{0.1, 100.0, "px", "A picture during which the vehicle turned by more is taken again"});
    field("timeout_s", self.timeout_s, OptionInfo{0.1, 120.0, "s", "For one picture"});
    field("width_px", self.width_px, OptionInfo{16, 20000, "px", ""});
    field("height_px", self.height_px, OptionInfo{16, 20000, "px", ""});
    field("fx_px", self.fx_px, OptionInfo{1.0, 1e5, "px", "Focal length"});
    field("fy_px", self.fy_px, OptionInfo{1.0, 1e5, "px", ""});
    field("cx_px", self.cx_px,
          OptionInfo{-1e5, 1e5, "px", "Principal point; pixel centres are at whole numbers"});
    field("cy_px", self.cy_px, OptionInfo{-1e5, 1e5, "px", ""});
    field("distortion", self.distortion, OptionInfo{-100.0, 100.0, "", "plumb_bob: k1, k2, p1, p2, k3"});
    field("mount", self.mount);
  }
};

/// Whether there is such a camera.
bool IsPresent(const CameraOptions& options);

/// An error when the distortion does not have five numbers.
Result<Intrinsics> MakeIntrinsics(const CameraOptions& options);

struct Picture {
  std::vector<std::uint8_t> bytes;  ///< A whole JPEG of the camera's size.
  std::int64_t exposure_utc_ns = 0;
  double shutter_s = 0.0;
  bool has_trusted_time = false;  ///< False: it was told by a clock that is not ours.
};

/// Takes pictures. For one thread.
class CameraDevice {
 public:
  virtual ~CameraDevice() = default;

  /// A picture that was exposed after the call, waiting for it for at most the configured time. The error is
  /// for people, and the next call may well succeed.
  virtual Result<Picture> Take() = 0;
};

/// An error when the pipeline cannot be parsed or the folder cannot be read. Whether the camera answers is
/// not tried.
Result<std::unique_ptr<CameraDevice>> OpenCamera(const CameraOptions& options);

/// A picture of the bytes: checked to be whole, of the camera's size, neither black nor white; stamped by
/// EXIF, or else by arrival and latency. An EXIF time after the arrival, or before it by more than latency
/// and timeout, was told by a clock that is not ours.
Result<Picture> MakePicture(std::vector<std::uint8_t> bytes, std::int64_t arrival_utc_ns,
                            const CameraOptions& options);

}  // namespace soffit
