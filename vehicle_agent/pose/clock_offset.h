#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace soffit {

/// Where the zero of a remote clock lies in UTC, from messages that took an unknown time to arrive.
///
/// A question and its answer (MAVLink TIMESYNC) bound the offset to half their round trip: the quickest of
/// the last three seconds counts. Without any, the quickest one-way arrival does, which is late by its
/// unknown delay. A clock that falls behind, as that of a simulator on a busy machine, is followed within
/// these seconds.
class ClockOffset {
 public:
  /// A question that was sent at `sent_utc_ns` and answered by `remote_ns`.
  void AddExchange(std::int64_t sent_utc_ns, std::int64_t remote_ns, std::int64_t received_utc_ns);
  void AddArrival(std::int64_t remote_ns, std::int64_t received_utc_ns);
  void Reset() { *this = {}; }

  /// None before anything was heard.
  std::optional<std::int64_t> ToUtc(std::int64_t remote_ns) const;

  /// Half the round trip of the exchange that counts; none without one.
  std::optional<std::int64_t> Uncertainty_ns() const;

 private:
  struct Sample {
    std::int64_t received_utc_ns = 0;
    std::int64_t offset_ns = 0;
    std::int64_t cost_ns = 0;  ///< The least one counts: half the round trip, or the offset itself.
  };
  using Window = std::deque<Sample>;

  static void Add(Window& window, const Sample& sample);
  const Sample* Best() const;

  Window exchanges_;  ///< Costs rise from the front to the back.
  Window arrivals_;
};

}  // namespace soffit
