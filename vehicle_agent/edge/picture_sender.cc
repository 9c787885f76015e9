#include "vehicle_agent/edge/picture_sender.h"

#include <chrono>

namespace soffit {
namespace {

using std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPatience(200);  // Between two looks at whether to stop.

}  // namespace

PictureSender::PictureSender(const Participant& radio, double timeout_s, Mailbox& mailbox)
    : writer_(radio), timeout_s_(timeout_s), mailbox_(mailbox), thread_([this] { Work(); }) {}

PictureSender::~PictureSender() {
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void PictureSender::Send(std::uint64_t request_id, Capture capture) {
  {
    const std::lock_guard lock(mutex_);
    parcels_.push_back({request_id, std::move(capture)});
  }
  changed_.notify_all();
}

std::string PictureSender::Deliver(const Capture& capture) {
  const auto deadline = steady_clock::now() + std::chrono::duration_cast<steady_clock::duration>(
                                                  std::chrono::duration<double>(timeout_s_));
  const auto may_wait = [&] { return !is_stopping_ && steady_clock::now() < deadline; };
  while (!writer_.WaitForReader(kPatience)) {
    if (!may_wait()) return "nobody takes the pictures: no service is connected";
  }
  while (!writer_.Write(capture)) {
    if (!may_wait()) return "the link to the service is full";
    std::this_thread::sleep_for(kPatience);
  }
  while (!writer_.WaitForAcknowledgements(kPatience)) {
    if (!may_wait()) return "the service did not confirm the picture";
  }
  return {};
}

void PictureSender::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_stopping_ || !parcels_.empty(); });
    if (is_stopping_) return;
    const Parcel parcel = std::move(parcels_.front());
    parcels_.pop_front();
    lock.unlock();
    mailbox_.Put(PictureOutcome{parcel.request_id, Deliver(parcel.capture)});
    lock.lock();
  }
}

}  // namespace soffit
