#include "vehicle_agent/pose/clock_offset.h"

#include <cmath>

namespace soffit {
namespace {

constexpr std::int64_t kWindow_ns = 3'000'000'000;

}  // namespace

void ClockOffset::Add(Window& window, const Sample& sample) {
  while (!window.empty() && window.back().cost_ns >= sample.cost_ns) window.pop_back();
  window.push_back(sample);
  while (window.front().received_utc_ns < sample.received_utc_ns - kWindow_ns) window.pop_front();
}

void ClockOffset::AddExchange(std::int64_t sent_utc_ns, std::int64_t remote_ns,
                              std::int64_t received_utc_ns) {
  if (received_utc_ns < sent_utc_ns || received_utc_ns - sent_utc_ns > kWindow_ns) return;
  const std::int64_t half_ns = (received_utc_ns - sent_utc_ns) / 2;
  Add(exchanges_, {received_utc_ns, sent_utc_ns + half_ns - remote_ns, half_ns});
}

void ClockOffset::AddArrival(std::int64_t remote_ns, std::int64_t received_utc_ns) {
  const std::int64_t offset_ns = received_utc_ns - remote_ns;
  Add(arrivals_, {received_utc_ns, offset_ns, offset_ns});
}

const ClockOffset::Sample* ClockOffset::Best() const {
  if (!exchanges_.empty()) return &exchanges_.front();
  return arrivals_.empty() ? nullptr : &arrivals_.front();
}

std::optional<std::int64_t> ClockOffset::ToUtc(std::int64_t remote_ns) const {
  const Sample* best = Best();
  if (best == nullptr) return std::nullopt;
  return remote_ns + best->offset_ns;
}

std::optional<std::int64_t> ClockOffset::Uncertainty_ns() const {
  if (exchanges_.empty()) return std::nullopt;
  return exchanges_.front().cost_ns;
}

}  // namespace soffit
