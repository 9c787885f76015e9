#include "vehicle_agent/edge/camera_post.h"

#include <chrono>

namespace soffit {
namespace {

constexpr std::chrono::seconds kTryAgainAfter(3);
constexpr std::chrono::milliseconds kBreath(
    300);  // A camera that just failed is given time before the next request.

}  // namespace

CameraPost::CameraPost(CameraId id, const CameraOptions& options, Mailbox& mailbox)
    : id_(id), options_(options), mailbox_(mailbox), thread_([this] { Work(); }) {}

CameraPost::~CameraPost() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void CameraPost::Ask(const ExposureRequest& request) {
  {
    const std::lock_guard lock(mutex_);
    request_ = request;
  }
  changed_.notify_all();
}

std::string CameraPost::Open() {
  if (camera_) return {};
  Result<std::unique_ptr<CameraDevice>> opened = OpenCamera(options_);
  if (!opened.ok()) return opened.error().message;
  camera_ = std::move(opened).value();
  return {};
}

Result<Picture> CameraPost::Take() {
  const std::string problem = Open();
  if (!problem.empty()) return Error{Error::Code::kUnavailable, problem};
  return camera_->Take();
}

std::string CameraPost::Try() {
  if (!options_.folder.empty()) return Open();  // A picture of a folder can be taken only once.
  const Result<Picture> picture = Take();
  return picture.ok() ? "" : picture.error().message;
}

void CameraPost::Work() {
  bool works = false;
  std::unique_lock lock(mutex_);
  while (!is_stopping_) {
    const std::optional<ExposureRequest> request = std::exchange(request_, std::nullopt);
    lock.unlock();
    if (request) {
      Result<Picture> picture = Take();
      works = picture.ok();
      if (!works) std::this_thread::sleep_for(kBreath);
      mailbox_.Put(PictureTaken{*request, std::move(picture)});
    } else if (!works) {
      const std::string problem = Try();
      works = problem.empty();
      mailbox_.Put(CameraTried{id_, problem});
    }
    lock.lock();
    const auto is_wanted = [this] { return is_stopping_ || request_.has_value(); };
    if (works) {
      changed_.wait(lock, is_wanted);
    } else {
      changed_.wait_for(lock, kTryAgainAfter, is_wanted);
    }
  }
}

}  // namespace soffit
