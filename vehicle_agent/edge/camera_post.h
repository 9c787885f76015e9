#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "vehicle_agent/camera/camera.h"
#include "vehicle_agent/edge/mailbox.h"

namespace soffit {

/// One camera on its own thread. It is tried when the post is opened and whenever it failed, until it
/// answers, so that a missing camera is known before it is needed.
class CameraPost {
 public:
  CameraPost(CameraId id, const CameraOptions& options, Mailbox& mailbox);
  ~CameraPost();
  CameraPost(const CameraPost&) = delete;
  CameraPost& operator=(const CameraPost&) = delete;

  /// The answer comes as PictureTaken. A request that is still waiting is replaced.
  void Ask(const ExposureRequest& request);

 private:
  void Work();
  std::string Open();
  std::string Try();  ///< What is wrong with the camera; empty: it works.
  Result<Picture> Take();

  CameraId id_;
  CameraOptions options_;
  Mailbox& mailbox_;
  std::unique_ptr<CameraDevice> camera_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<ExposureRequest> request_;
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace soffit
