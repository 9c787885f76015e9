#include "shared/geometry/polygon.h"

#include <algorithm>
#include <limits>

namespace soffit {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double Turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return Cross(b - a, c - a);
}

bool OnSegment(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  return (p - a).dot(p - b) <= 0.0;
}

bool SegmentsMeet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                  const Eigen::Vector2d& d) {
  const double abc = Turn(a, b, c);
  const double abd = Turn(a, b, d);
  const double cda = Turn(c, d, a);
  const double cdb = Turn(c, d, b);
  if (((abc > 0) != (abd > 0)) && ((cda > 0) != (cdb > 0)) && abc != 0 && abd != 0 && cda != 0 && cdb != 0) {
    return true;
  }
  return (abc == 0 && OnSegment(a, b, c)) || (abd == 0 && OnSegment(a, b, d)) ||
         (cda == 0 && OnSegment(c, d, a)) || (cdb == 0 && OnSegment(c, d, b));
}

Eigen::Vector2d AreaMoment(const Ring& ring) {
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  if (ring.empty()) return moment;
  const Eigen::Vector2d origin = ring.front();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d a = ring[i] - origin;
    const Eigen::Vector2d b = ring[(i + 1) % ring.size()] - origin;
    moment += Cross(a, b) * (a + b) / 6.0;
  }
  return moment + SignedArea(ring) * origin;
}

}  // namespace

double SignedArea(const Ring& ring) {
  double twice = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    twice += Cross(ring[i] - ring.front(), ring[(i + 1) % ring.size()] - ring.front());
  }
  return 0.5 * twice;
}

double Area(const Polygon& polygon) {
  double area = std::abs(SignedArea(polygon.outer));
  for (const Ring& hole : polygon.holes) area -= std::abs(SignedArea(hole));
  return area;
}

double Perimeter(const Ring& ring) {
  double length = 0.0;
  for (std::size_t i = 0; i < ring.size(); ++i) length += (ring[(i + 1) % ring.size()] - ring[i]).norm();
  return length;
}

Eigen::Vector2d Centroid(const Polygon& polygon) {
  const double sign = SignedArea(polygon.outer) < 0.0 ? -1.0 : 1.0;
  Eigen::Vector2d moment = sign * AreaMoment(polygon.outer);
  for (const Ring& hole : polygon.holes) {
    moment -= (SignedArea(hole) < 0.0 ? -1.0 : 1.0) * AreaMoment(hole);
  }
  return moment / Area(polygon);
}

bool Contains(const Ring& ring, const Eigen::Vector2d& point) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[j];
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()) + a.x()) {
      inside = !inside;
    }
  }
  return inside;
}

bool Contains(const Polygon& polygon, const Eigen::Vector2d& point) {
  return Contains(polygon.outer, point) &&
         std::none_of(polygon.holes.begin(), polygon.holes.end(),
                      [&](const Ring& hole) { return Contains(hole, point); });
}

double DistanceToSegment(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d side = b - a;
  const double length2 = side.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((point - a).dot(side) / length2, 0.0, 1.0) : 0.0;
  return (point - a - t * side).norm();
}

double DistanceToRing(const Eigen::Vector2d& point, const Ring& ring) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    least = std::min(least, DistanceToSegment(point, ring[i], ring[(i + 1) % ring.size()]));
  }
  return least;
}

bool Crosses(const Ring& ring, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& c = ring[i];
    const Eigen::Vector2d& d = ring[(i + 1) % ring.size()];
    if (Turn(a, b, c) * Turn(a, b, d) < 0.0 && Turn(c, d, a) * Turn(c, d, b) < 0.0) return true;
  }
  return false;
}

double DistanceToSegment(const Ring& ring, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  if (Contains(ring, a) || Contains(ring, b) || Crosses(ring, a, b)) return 0.0;
  double least = std::min(DistanceToRing(a, ring), DistanceToRing(b, ring));
  for (const Eigen::Vector2d& corner : ring) least = std::min(least, DistanceToSegment(corner, a, b));
  return least;
}

bool IsSimple(const Ring& ring) {
  const std::size_t n = ring.size();
  if (n < 3) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % n];
    const Eigen::Vector2d& c = ring[(i + 2) % n];
    if (a == b || (Turn(a, b, c) == 0.0 && (a - b).dot(c - b) > 0.0)) return false;
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      if (SegmentsMeet(a, b, ring[j], ring[(j + 1) % n])) return false;
    }
  }
  return true;
}

std::vector<Eigen::Vector2d> GridOver(const Ring& ring) {
  constexpr int kCells = 24;
  std::vector<Eigen::Vector2d> points;
  if (ring.empty()) return points;
  Eigen::Vector2d low = ring.front();
  Eigen::Vector2d high = low;
  for (const Eigen::Vector2d& p : ring) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      points.push_back(low +
                       (high - low).cwiseProduct(Eigen::Vector2d((i + 0.5) / kCells, (j + 0.5) / kCells)));
    }
  }
  return points;
}

double ShareInside(const Ring& inner, const Ring& outer) {
  int inside = 0;
  int both = 0;
  for (const Eigen::Vector2d& p : GridOver(inner)) {
    if (!Contains(inner, p)) continue;
    ++inside;
    if (Contains(outer, p)) ++both;
  }
  return inside > 0 ? static_cast<double>(both) / inside : 0.0;
}

Ring ConvexHull(const std::vector<Eigen::Vector2d>& points) {
  std::vector<Eigen::Vector2d> sorted = points;
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() < 3) return sorted;
  Ring hull;
  const auto add_chain = [&hull](auto begin, auto end) {
    const std::size_t base = hull.size();
    for (auto it = begin; it != end; ++it) {
      while (hull.size() >= base + 2 && Turn(hull[hull.size() - 2], hull.back(), *it) <= 0.0) hull.pop_back();
      hull.push_back(*it);
    }
    hull.pop_back();
  };
  add_chain(sorted.begin(), sorted.end());
  add_chain(sorted.rbegin(), sorted.rend());
  return hull;
}

}  // namespace soffit
