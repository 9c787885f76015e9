#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "shared/frames/frames.h"

namespace soffit {

/// Values of the last seconds with their times, for interpolation between neighbours.
template <class T>
class TimeSeries {
 public:
  /// A value takes the place of those that are not older: the clock was set back.
  void Add(std::int64_t utc_ns, const T& value) {
    while (!values_.empty() && values_.back().first >= utc_ns) values_.pop_back();
    values_.emplace_back(utc_ns, value);
    while (values_.front().first < utc_ns - kKept_ns) values_.pop_front();
  }

  /// The neighbours of a moment and how far it is from the first to the second, 0 to 1. None when the moment
  /// is not between two values, or these are more than `max_gap_ns` apart.
  struct Neighbours {
    T before;
    T after;
    double share;
  };
  std::optional<Neighbours> Find(std::int64_t utc_ns, std::int64_t max_gap_ns) const {
    for (std::size_t i = values_.size(); i-- > 1;) {
      const auto& [from_ns, from] = values_[i - 1];
      const auto& [to_ns, to] = values_[i];
      if (utc_ns > to_ns) return std::nullopt;
      if (utc_ns < from_ns) continue;
      if (to_ns - from_ns > max_gap_ns) return std::nullopt;
      return Neighbours{from, to,
                        static_cast<double>(utc_ns - from_ns) / static_cast<double>(to_ns - from_ns)};
    }
    return std::nullopt;
  }

  std::int64_t newest_utc_ns() const { return values_.empty() ? 0 : values_.back().first; }
  void Clear() { values_.clear(); }

 private:
  static constexpr std::int64_t kKept_ns = 20'000'000'000;
  std::deque<std::pair<std::int64_t, T>> values_;
};

/// Where the vehicle was and how it was turned, for the last 20 seconds.
///
/// Positions and attitudes come in separate messages, each with its own times; both are interpolated
/// (attitudes on the shortest arc), never extrapolated.
class PoseBuffer {
 public:
  void AddPosition(std::int64_t utc_ns, const Eigen::Vector3d& in_map_m) { positions_.Add(utc_ns, in_map_m); }
  void AddAttitude(std::int64_t utc_ns, const Eigen::Quaterniond& map_from_body) {
    attitudes_.Add(utc_ns, map_from_body);
  }
  void AddRate(std::int64_t utc_ns, double rate_radps) { rates_.Add(utc_ns, rate_radps); }
  void AddGimbal(std::int64_t utc_ns, const Eigen::Quaterniond& map_from_gimbal) {
    gimbals_.Add(utc_ns, map_from_gimbal);
  }
  void Clear() { *this = {}; }

  /// None when there is no pair of values around the moment less than 0.3 s apart.
  std::optional<Pose<Map, Body>> FindBody(std::int64_t utc_ns) const;

  /// Attitude of the gimbal's camera platform (FLU, x along the optical axis).
  std::optional<Eigen::Quaterniond> FindGimbal(std::int64_t utc_ns) const;

  /// How fast the body turned. None as for FindBody.
  std::optional<double> FindRate_radps(std::int64_t utc_ns) const;

  /// Up to this moment poses can be found; 0: not at all.
  std::int64_t newest_utc_ns() const {
    return std::min(positions_.newest_utc_ns(), attitudes_.newest_utc_ns());
  }

 private:
  TimeSeries<Eigen::Vector3d> positions_;
  TimeSeries<Eigen::Quaterniond> attitudes_;
  TimeSeries<double> rates_;
  TimeSeries<Eigen::Quaterniond> gimbals_;
};

}  // namespace soffit
