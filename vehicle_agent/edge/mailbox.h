#pragma once

#include <deque>
#include <mutex>
#include <utility>
#include <variant>

#include "shared/result/result.h"
#include "vehicle_agent/agent/agent.h"
#include "vehicle_agent/camera/camera.h"

namespace soffit {

/// A camera answered a request.
struct PictureTaken {
  ExposureRequest request;
  Result<Picture> picture;
};

/// A camera was tried without being asked for a picture; `problem` is empty when it answered.
struct CameraTried {
  CameraId camera = CameraId::kForward;
  std::string problem;
};

using Letter =
    std::variant<FlightCommand, ServiceHeartbeat, RivalHeard, PictureTaken, CameraTried, PictureOutcome>;

/// From the threads of bus, cameras and sender to the one that thinks.
class Mailbox {
 public:
  void Put(Letter letter) {
    const std::lock_guard lock(mutex_);
    letters_.push_back(std::move(letter));
    if (letters_.size() > kMaxLetters) letters_.pop_front();
  }
  std::deque<Letter> TakeAll() {
    const std::lock_guard lock(mutex_);
    return std::exchange(letters_, {});
  }

 private:
  static constexpr std::size_t kMaxLetters = 1024;
  std::mutex mutex_;
  std::deque<Letter> letters_;
};

}  // namespace soffit
