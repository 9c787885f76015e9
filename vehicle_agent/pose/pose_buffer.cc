#include "vehicle_agent/pose/pose_buffer.h"

#include <cmath>

namespace soffit {
namespace {

constexpr std::int64_t kMaxGap_ns = 300'000'000;

std::optional<Eigen::Quaterniond> Interpolate(const TimeSeries<Eigen::Quaterniond>& series,
                                              std::int64_t utc_ns) {
  const auto pair = series.Find(utc_ns, kMaxGap_ns);
  if (!pair) return std::nullopt;
  return pair->before.slerp(pair->share, pair->after).normalized();
}

}  // namespace

std::optional<Pose<Map, Body>> PoseBuffer::FindBody(std::int64_t utc_ns) const {
  const auto position = positions_.Find(utc_ns, kMaxGap_ns);
  const auto attitude = Interpolate(attitudes_, utc_ns);
  if (!position || !attitude) return std::nullopt;
  return Pose<Map, Body>{*attitude,
                         position->before + position->share * (position->after - position->before)};
}

std::optional<double> PoseBuffer::FindRate_radps(std::int64_t utc_ns) const {
  const auto rate = rates_.Find(utc_ns, kMaxGap_ns);
  if (!rate) return std::nullopt;
  return std::lerp(rate->before, rate->after, rate->share);
}

std::optional<Eigen::Quaterniond> PoseBuffer::FindGimbal(std::int64_t utc_ns) const {
  return Interpolate(gimbals_, utc_ns);
}

}  // namespace soffit
