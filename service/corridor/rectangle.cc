#include "service/corridor/rectangle.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace soffit {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kBisections = 30;

struct Span {
  double low = -kInfinity;
  double high = kInfinity;
  double Length() const { return high - low; }
};

/// The polygon as the heights that are free over each stretch of the horizontal axis.
class FreeHeights {
 public:
  explicit FreeHeights(const Ring& ring) : ring_(ring) {
    for (const Eigen::Vector2d& p : ring) stations_.push_back(p.x());
    std::sort(stations_.begin(), stations_.end());
    stations_.erase(std::unique(stations_.begin(), stations_.end()), stations_.end());
    for (const double u : stations_) at_stations_.push_back(Narrow(At(u, -1), At(u, +1)));
  }
  double left() const { return stations_.front(); }
  double right() const { return stations_.back(); }
  const std::vector<double>& stations() const { return stations_; }

  /// Free over all of [from, to]: the bounds are straight between corners, so corners and ends tell.
  Span Over(double from, double to) const {
    Span span = Narrow(At(from, +1), At(to, -1));
    const auto first = std::upper_bound(stations_.begin(), stations_.end(), from) - stations_.begin();
    for (std::size_t i = static_cast<std::size_t>(first); i < stations_.size() && stations_[i] < to; ++i) {
      span = Narrow(span, at_stations_[i]);
    }
    return span;
  }

 private:
  static Span Narrow(const Span& a, const Span& b) {
    return {std::max(a.low, b.low), std::min(a.high, b.high)};
  }

  /// Lower and upper bound at u, coming from the right (+1) or the left (-1) where a side is upright.
  Span At(double u, int from) const {
    double low = kInfinity;
    double high = -kInfinity;
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      Eigen::Vector2d a = ring_[i];
      Eigen::Vector2d b = ring_[(i + 1) % ring_.size()];
      if (a.x() > b.x()) std::swap(a, b);
      const bool covers = from > 0 ? (a.x() <= u && u < b.x()) : (a.x() < u && u <= b.x());
      if (!covers) continue;
      const double v = a.y() + (u - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
      low = std::min(low, v);
      high = std::max(high, v);
    }
    return {low, high};
  }

  const Ring& ring_;
  std::vector<double> stations_;
  std::vector<Span> at_stations_;
};

struct Place {
  double left = 0.0;
  Span span;
};

/// Where a stretch of this width has the greatest free height. Between neighbouring breakpoints, where a
/// corner enters or leaves the stretch, the height is the least of linear functions, hence concave.
Place BestPlace(const FreeHeights& free, double width) {
  std::vector<double> breaks = {free.left(), free.right() - width};
  for (const double u : free.stations()) {
    for (const double at : {u, u - width}) {
      if (at > breaks[0] && at < breaks[1]) breaks.push_back(at);
    }
  }
  std::sort(breaks.begin(), breaks.end());
  const auto at = [&](double left) { return Place{left, free.Over(left, left + width)}; };
  Place best = at(0.5 * (free.left() + free.right() - width));
  const auto keep = [&](const Place& place) {
    if (place.span.Length() > best.span.Length() + 1e-12) best = place;
  };
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    double low = breaks[i];
    double high = breaks[i + 1];
    keep(at(low));
    for (int step = 0; step < 2 * kBisections; ++step) {
      const double a = low + (high - low) / 3.0;
      const double b = high - (high - low) / 3.0;
      const bool rises = at(a).span.Length() < at(b).span.Length();
      (rises ? low : high) = rises ? a : b;
    }
    keep(at(0.5 * (low + high)));
  }
  keep(at(breaks.back()));
  return best;
}

/// Greatest x in [low, high] for which `fits`, which holds at low.
template <class Fits>
double Greatest(double low, double high, Fits&& fits) {
  if (fits(high)) return high;
  for (int step = 0; step < kBisections; ++step) {
    const double middle = 0.5 * (low + high);
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

}  // namespace

std::optional<Rectangle> FitRectangle(const Ring& ring, double width, double height) {
  if (ring.size() < 3 || !(width > 0.0) || !(height > 0.0)) return std::nullopt;
  const FreeHeights free(ring);
  const double full = free.right() - free.left();
  if (!(full > 0.0)) return std::nullopt;
  const auto scaled = [&](double k) {
    return k * width <= full && BestPlace(free, k * width).span.Length() >= k * height;
  };
  const double k = Greatest(0.0, full / width, scaled);
  if (!(k > 0.0)) return std::nullopt;
  const double free_height = BestPlace(free, k * width).span.Length();
  const double free_width = Greatest(
      k * width, full, [&](double w) { return BestPlace(free, w).span.Length() >= free_height - 1e-9; });
  const Place place = BestPlace(free, free_width);
  return Rectangle{place.left, place.left + free_width, place.span.low, place.span.high};
}

}  // namespace soffit
