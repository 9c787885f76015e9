#pragma once

#include <deque>
#include <mutex>
#include <utility>
#include <variant>

#include "shared/dds/participant.h"
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

/// What became of a picture that was to be sent.
struct DeliveryReport {
  std::uint32_t capture_id = 0;
  int width_px = 0;  ///< As it was sent.
  int height_px = 0;
  std::size_t size_bytes = 0;
  double latency_s = 0.0;  ///< From the first byte to the acknowledgement.
  int tries = 0;           ///< More than one when the service was lost and found meanwhile.
  FragmentCounts fragments;
};
struct PictureDelivered {
  PictureOutcome outcome;
  DeliveryReport report;
};

using Letter =
    std::variant<FlightCommand, ServiceHeartbeat, RivalHeard, PictureTaken, CameraTried, PictureDelivered>;

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
