#include "vehicle_agent/edge/picture_sender.h"

#include <chrono>
#include <utility>

#include "vehicle_agent/camera/shrink.h"

namespace soffit {
namespace {

using std::chrono::steady_clock;
constexpr std::chrono::milliseconds kPatience(200);  // Between two looks at whether to stop.

}  // namespace

PictureSender::PictureSender(const Participant& radio, const LinkProfile& profile, double timeout_s,
                             Mailbox& mailbox)
    : radio_(radio),
      writer_(radio),
      quality_(profile.picture_quality),
      budget_(profile),
      timeout_s_(timeout_s),
      mailbox_(mailbox),
      thread_([this] { Work(); }) {}

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

PictureDelivered PictureSender::Deliver(Parcel parcel) {
  const Result<Capture> small = ShrinkCapture(std::move(parcel.capture), budget_.Bytes(), quality_);
  if (!small.ok()) return {{parcel.request_id, small.error().message}, {}};
  const Capture& capture = small.value();
  DeliveryReport report;
  report.capture_id = capture.capture_id;
  report.width_px = capture.intrinsics.width_px;
  report.height_px = capture.intrinsics.height_px;
  report.size_bytes = capture.bytes.size();
  const FragmentCounts before = radio_.CountFragments();
  const std::string problem = Transmit(capture, report);
  const FragmentCounts after = radio_.CountFragments();
  report.fragments = {after.sent - before.sent, after.sent_again - before.sent_again};
  if (problem.empty()) {
    budget_.NoteArrival(report.size_bytes, report.latency_s);
  } else if (report.tries > 0) {
    budget_.NoteLoss();
  }
  return {{parcel.request_id, problem}, report};
}

std::string PictureSender::Transmit(const Capture& capture, DeliveryReport& report) {
  const auto deadline = steady_clock::now() + std::chrono::duration_cast<steady_clock::duration>(
                                                  std::chrono::duration<double>(timeout_s_));
  const auto may_wait = [&] { return !is_stopping_ && steady_clock::now() < deadline; };
  while (true) {
    const int departed = writer_.CountDepartedReaders();
    while (!writer_.WaitForReader(kPatience)) {
      if (!may_wait()) return "nobody takes the pictures: no service is connected";
    }
    const auto began = steady_clock::now();
    ++report.tries;
    while (!writer_.Write(capture)) {
      if (!may_wait()) return "the link to the service is full";
      std::this_thread::sleep_for(kPatience);
    }
    while (!writer_.WaitForAcknowledgements(kPatience)) {
      if (!may_wait()) return "the service did not confirm the picture";
    }
    report.latency_s = std::chrono::duration<double>(steady_clock::now() - began).count();
    if (writer_.CountDepartedReaders() == departed) return {};
  }
}

void PictureSender::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return is_stopping_ || !parcels_.empty(); });
    if (is_stopping_) return;
    Parcel parcel = std::move(parcels_.front());
    parcels_.pop_front();
    lock.unlock();
    mailbox_.Put(Deliver(std::move(parcel)));
    lock.lock();
  }
}

}  // namespace soffit
