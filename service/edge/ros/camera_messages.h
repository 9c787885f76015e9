#pragma once

#include "service/edge/ros/ros_types.h"
#include "shared/capture/capture.h"

namespace soffit::ros {

/// The picture as it was received; its format is told by its first bytes.
CompressedImage_ MakeCompressedImage(const Capture& capture);

/// The camera that took it, with the same header.
CameraInfo_ MakeCameraInfo(const Capture& capture);

/// `map` to the optical frame of that header, at the exposure.
TFMessage_ MakeCameraTransform(const Capture& capture);

}  // namespace soffit::ros
