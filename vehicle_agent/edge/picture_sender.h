#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "shared/dds/writer.h"
#include "shared/wire/topics.h"
#include "vehicle_agent/edge/mailbox.h"
#include "vehicle_agent/edge/picture_budget.h"

namespace soffit {

/// Hands pictures over to the service, one after another, on its own thread: makes them as small as the link
/// needs, waits for someone to read them and for the link to have room, and until they are acknowledged. A
/// service that is lost and found meanwhile gets the picture anew. The outcome comes as PictureDelivered.
class PictureSender {
 public:
  PictureSender(const Participant& radio, const LinkProfile& profile, double timeout_s, Mailbox& mailbox);
  ~PictureSender();
  PictureSender(const PictureSender&) = delete;
  PictureSender& operator=(const PictureSender&) = delete;

  void Send(std::uint64_t request_id, Capture capture);

 private:
  struct Parcel {
    std::uint64_t request_id = 0;
    Capture capture;
  };
  void Work();
  PictureDelivered Deliver(Parcel parcel);
  std::string Transmit(const Capture& capture,
                       DeliveryReport& report);  ///< What kept it from arriving; empty: nothing.

  Participant radio_;
  Writer<CaptureTopic> writer_;
  int quality_;
  PictureBudget budget_;
  double timeout_s_;
  Mailbox& mailbox_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Parcel> parcels_;
  std::atomic<bool> is_stopping_ = false;
  std::thread thread_;
};

}  // namespace soffit
