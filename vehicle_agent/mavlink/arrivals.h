#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>

namespace soffit::mavlink {

/// When messages of one kind came lately, to find out whether a stream is still what was asked for: an
/// autopilot forgets it when it is restarted, and another ground station on the same link may slow it down.
class Arrivals {
 public:
  void Add(std::int64_t time_ns) {
    times_ns_.push_back(time_ns);
    if (times_ns_.size() > kMostKept) times_ns_.pop_front();
  }

  bool IsEmpty() const { return times_ns_.empty(); }
  std::int64_t newest_ns() const { return times_ns_.empty() ? 0 : times_ns_.back(); }

  /// Whether at least half as many came lately as at `rate_hz`, which must be positive.
  bool KeepUpWith(double rate_hz, std::int64_t now_ns) const {
    const double window_s = std::max(kLeastWindow_s, kLeastCount / rate_hz);
    const std::int64_t since_ns = now_ns - static_cast<std::int64_t>(window_s * 1e9);
    const auto count = std::count_if(times_ns_.begin(), times_ns_.end(),
                                     [since_ns](std::int64_t time_ns) { return time_ns > since_ns; });
    return static_cast<double>(count) >= std::min(0.5 * rate_hz * window_s, 0.5 * kMostKept);
  }

 private:
  static constexpr double kLeastWindow_s = 1.5;
  static constexpr double kLeastCount = 3.0;
  static constexpr std::size_t kMostKept = 256;

  std::deque<std::int64_t> times_ns_;
};

}  // namespace soffit::mavlink
