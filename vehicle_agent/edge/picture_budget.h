#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "shared/dds/link_profile.h"

namespace soffit {

/// How large a picture may be to arrive in the time of the link's profile, by what the link did so far. Pure.
class PictureBudget {
 public:
  explicit PictureBudget(const LinkProfile& profile)
      : time_s_(profile.picture_time_s), rate_Bps_(profile.Rate_Bps()) {}

  std::size_t Bytes() const {
    constexpr double kLargest = 64.0 * (1 << 20);  // What the wire takes.
    return static_cast<std::size_t>(std::min(rate_Bps_ * time_s_, kLargest));
  }

  void NoteArrival(std::size_t bytes, double took_s) {
    if (std::isinf(rate_Bps_)) return;  // Nothing is limited.
    rate_Bps_ += kNews * (static_cast<double>(bytes) / std::max(took_s, kShortest_s) - rate_Bps_);
  }
  void NoteLoss() { rate_Bps_ *= 1.0 - kNews; }

 private:
  static constexpr double kNews = 0.5;
  static constexpr double kShortest_s = 1e-3;
  double time_s_;
  double rate_Bps_;
};

}  // namespace soffit
