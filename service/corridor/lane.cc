#include "service/corridor/lane.h"

#include <algorithm>
#include <limits>

#include "shared/geometry/heights.h"

namespace soffit {
namespace {

constexpr double kWider_m = 1e-9;

Span ExtentOf(const Ring& ring) {
  Span extent;
  for (const Eigen::Vector2d& p : ring) extent.Include(p.x());
  return extent;
}

/// Common part of two x-monotone outlines, sampled at the corners of both; empty when they do not overlap.
Ring CommonPart(const Ring& a, const Ring& b) {
  const Span of_a = ExtentOf(a);
  const Span of_b = ExtentOf(b);
  const double left = std::max(of_a.low, of_b.low);
  const double right = std::min(of_a.high, of_b.high);
  if (!(right > left)) return {};
  std::vector<double> stations = {left, right};
  for (const Ring* ring : {&a, &b}) {
    for (const Eigen::Vector2d& p : *ring) {
      if (p.x() > left && p.x() < right) stations.push_back(p.x());
    }
  }
  std::sort(stations.begin(), stations.end());
  const double tiny = 1e-6 * (right - left);
  stations.erase(
      std::unique(stations.begin(), stations.end(), [&](double p, double q) { return q - p < tiny; }),
      stations.end());
  if (stations.size() < 2) return {};
  Ring lower, upper;
  for (std::size_t i = 0; i < stations.size(); ++i) {
    double u = stations[i];
    if (i == 0) u += tiny;
    if (i + 1 == stations.size()) u -= tiny;
    const Span in_a = HeightsAt(a, u);
    const Span in_b = HeightsAt(b, u);
    const double low = std::max(in_a.low, in_b.low);
    const double high = std::min(in_a.high, in_b.high);
    if (!(high > low)) return {};
    lower.emplace_back(stations[i], low);
    upper.emplace_back(stations[i], high);
  }
  lower.insert(lower.end(), upper.rbegin(), upper.rend());
  return lower;
}

/// The outermost corners of a section in plan.
Eigen::Vector2d LeftOf(const Section& section) { return section.front().head<2>(); }
Eigen::Vector2d RightOf(const Section& section) { return section[section.size() / 2 - 1].head<2>(); }

/// In plan.
Eigen::Vector2d MiddleOf(const Section& section) { return 0.5 * (LeftOf(section) + RightOf(section)); }

/// To the right of a way; one of them gives the widest lane.
std::vector<Eigen::Vector2d> ListDirections(const std::vector<Eigen::Vector2d>& widths) {
  std::vector<Eigen::Vector2d> directions;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    directions.push_back(widths[i]);
    for (std::size_t j = 0; j < i; ++j) {
      const Eigen::Vector2d difference = widths[i] - widths[j];
      directions.emplace_back(-difference.y(), difference.x());
      directions.emplace_back(difference.y(), -difference.x());
    }
  }
  return directions;
}

/// A unit vector to the right of the widest lane from the first section to the last; none when there is none.
std::optional<Eigen::Vector2d> FindWidestDirection(const std::vector<Section>& sections) {
  const Eigen::Vector2d through = MiddleOf(sections.back()) - MiddleOf(sections.front());
  std::vector<Eigen::Vector2d> widths;  // From each left end to each right one.
  for (const Section& a : sections) {
    for (const Section& b : sections) widths.push_back(RightOf(a) - LeftOf(b));
  }
  std::vector<Eigen::Vector2d> directions = ListDirections(widths);
  directions.emplace_back(through.y(), -through.x());
  double widest = 0.0;
  std::optional<Eigen::Vector2d> best;
  for (const Eigen::Vector2d& direction : directions) {
    const Eigen::Vector2d right = direction.normalized();
    if (!(through.dot(Eigen::Vector2d(-right.y(), right.x())) > 0.0)) continue;
    double width = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& end_to_end : widths) width = std::min(width, end_to_end.dot(right));
    if (width <= widest + kWider_m) continue;
    widest = width;
    best = right;
  }
  return best;
}

}  // namespace

std::optional<Lane> FindWidestLane(const std::vector<Section>& sections) {
  const auto right = FindWidestDirection(sections);
  if (!right) return std::nullopt;
  Lane lane;
  lane.way = {-right->y(), right->x()};
  lane.left_m = -std::numeric_limits<double>::infinity();
  lane.right_m = std::numeric_limits<double>::infinity();
  for (const Section& section : sections) {
    Ring seen;
    for (const Eigen::Vector3d& p : section) seen.emplace_back(lane.U(p.head<2>()), p.z());
    lane.section = &section == &sections.front() ? seen : CommonPart(lane.section, seen);
    lane.left_m = std::max(lane.left_m, lane.U(LeftOf(section)));
    lane.right_m = std::min(lane.right_m, lane.U(RightOf(section)));
  }
  const auto along = [&](const Section& section) {
    return std::minmax({lane.Along(LeftOf(section)), lane.Along(RightOf(section))});
  };
  lane.from_m = along(sections.front()).first;
  lane.to_m = along(sections.back()).second;
  return lane;
}

}  // namespace soffit
