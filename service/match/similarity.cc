#include "service/match/similarity.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace soffit {
namespace {

using Eigen::Vector2d;

constexpr int kStretches = 16;

struct Sample {
  Vector2d point;
  bool is_on_hole = false;
};

void SampleRing(const Ring& ring, double step, bool is_on_hole, std::vector<Sample>& samples) {
  const double perimeter = Perimeter(ring);
  const int count = std::max(8, static_cast<int>(std::lround(perimeter / step)));
  const double own_step = perimeter / count;
  double at = 0.5 * own_step;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
    const double length = side.norm();
    for (; at < length; at += own_step) samples.push_back({ring[i] + side * (at / length), is_on_hole});
    at -= length;
  }
}

std::vector<Sample> SampleOutline(const Polygon& polygon, int count) {
  double length = Perimeter(polygon.outer);
  for (const Ring& hole : polygon.holes) length += Perimeter(hole);
  std::vector<Sample> samples;
  SampleRing(polygon.outer, length / count, false, samples);
  for (const Ring& hole : polygon.holes) SampleRing(hole, length / count, true, samples);
  return samples;
}

struct Foot {
  Vector2d point = Vector2d::Zero();
  Vector2d outward = Vector2d::Zero();  ///< Unit normal, out of the region.
  double distance = std::numeric_limits<double>::infinity();
};

void FindFootOnRing(const Vector2d& p, const Ring& ring, Foot& best) {
  double least2 = best.distance * best.distance;
  const Vector2d* start = nullptr;
  Vector2d nearest_side;
  double share = 0.0;
  for (std::size_t i = 0, last = ring.size() - 1; i < ring.size(); last = i++) {
    const Vector2d& a = ring[last];
    const Vector2d side = ring[i] - a;
    const double length2 = side.squaredNorm();
    if (length2 <= 0.0) continue;
    const double t = std::clamp((p - a).dot(side) / length2, 0.0, 1.0);
    const double distance2 = (p - a - t * side).squaredNorm();
    if (distance2 >= least2) continue;
    least2 = distance2;
    start = &a;
    nearest_side = side;
    share = t;
  }
  if (start == nullptr) return;
  const Vector2d normal(nearest_side.y(), -nearest_side.x());
  best = {*start + share * nearest_side, normal / normal.norm(), std::sqrt(least2)};
}

/// Outer rings answer for samples of outer rings, holes for those of holes; none when there is no hole.
Foot FindFoot(const Sample& sample, const Polygon& polygon) {
  Foot foot;
  if (!sample.is_on_hole) FindFootOnRing(sample.point, polygon.outer, foot);
  if (sample.is_on_hole) {
    for (const Ring& hole : polygon.holes) FindFootOnRing(sample.point, hole, foot);
  }
  return foot;
}

double SideLength(const Polygon& polygon) { return std::sqrt(std::max(1e-300, Area(polygon))); }

/// One linear equation: normal . (similarity * source) = normal . target.
struct Constraint {
  Vector2d source;
  Vector2d target;
  Vector2d normal;
  double distance;
};

Similarity Inverse(const Similarity& s) {
  const double scale2 = s.a * s.a + s.b * s.b;
  Similarity inverse{s.a / scale2, -s.b / scale2, Vector2d::Zero()};
  inverse.translation = -(inverse * s.translation);
  return inverse;
}

void AddConstraints(const ShapePair& pair, const std::vector<Sample>& of_source,
                    const std::vector<Sample>& of_target, const Similarity& similarity,
                    std::vector<Constraint>& constraints) {
  for (const Sample& s : of_source) {
    const Vector2d moved = similarity * s.point;
    const Foot foot = FindFoot({moved, s.is_on_hole}, *pair.second);
    if (!std::isfinite(foot.distance)) continue;
    constraints.push_back({s.point, foot.point, foot.outward, foot.outward.dot(moved - foot.point)});
  }
  const Similarity inverse = Inverse(similarity);
  const Similarity turn{similarity.a / similarity.Scale(), similarity.b / similarity.Scale(),
                        Vector2d::Zero()};
  for (const Sample& s : of_target) {
    const Foot foot = FindFoot({inverse * s.point, s.is_on_hole}, *pair.first);
    if (!std::isfinite(foot.distance)) continue;
    const Vector2d normal = turn * foot.outward;
    constraints.push_back({foot.point, s.point, normal, normal.dot(similarity * foot.point - s.point)});
  }
}

/// Weighted linear least squares for (a, b, tx, ty), about the middle of the sources.
Similarity Solve(const std::vector<Constraint>& constraints, double reach) {
  Vector2d middle = Vector2d::Zero();
  for (const Constraint& c : constraints) middle += c.source / static_cast<double>(constraints.size());
  Eigen::Matrix4d normal_matrix = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Constraint& c : constraints) {
    const double ratio = c.distance / reach;
    const double weight = 1.0 / (1.0 + ratio * ratio);
    const Vector2d q = c.source - middle;
    const Eigen::Vector4d row(c.normal.dot(q), c.normal.dot(Vector2d(-q.y(), q.x())), c.normal.x(),
                              c.normal.y());
    normal_matrix += weight * row * row.transpose();
    right += weight * row * c.normal.dot(c.target);
  }
  const Eigen::Vector4d x = normal_matrix.ldlt().solve(right);
  Similarity result{x(0), x(1), Vector2d::Zero()};
  result.translation = Vector2d(x(2), x(3)) - (result * middle);
  return result;
}

/// Greatest mean of `width` neighbouring signed distances of a closed sequence.
double GreatestStretchMean(const std::vector<double>& distances, std::size_t width) {
  const std::size_t count = distances.size();
  double sum = 0.0;
  for (std::size_t k = 0; k < width; ++k) sum += distances[k];
  double greatest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    greatest = std::max(greatest, std::abs(sum) / static_cast<double>(width));
    sum += distances[(i + width) % count] - distances[i];
  }
  return greatest;
}

/// Of a ring from the rings of its kind; infinite when there are none.
double GreatestDistance(const Ring& ring, bool is_hole, const Polygon& to, double step, int stretch) {
  std::vector<Sample> samples;
  SampleRing(ring, step, is_hole, samples);
  std::vector<double> distances;
  for (const Sample& s : samples) {
    const Foot foot = FindFoot(s, to);
    if (!std::isfinite(foot.distance)) return foot.distance;
    distances.push_back(foot.outward.dot(s.point - foot.point) >= 0.0 ? foot.distance : -foot.distance);
  }
  return GreatestStretchMean(distances, std::min(static_cast<std::size_t>(stretch), samples.size() / 2));
}

/// A hole that `to` lacks is filled by moving its sides by half of its width.
double OneWayMisfit(const Polygon& from, const Polygon& to, int count) {
  const double step = Perimeter(from.outer) / (2 * count);
  const int stretch = std::max(3, 2 * count / kStretches);
  double greatest = GreatestDistance(from.outer, false, to, step, stretch);
  for (const Ring& hole : from.holes) {
    const double half_width = std::abs(SignedArea(hole)) / Perimeter(hole);
    greatest = std::max(greatest, std::min(half_width, GreatestDistance(hole, true, to, step, stretch)));
  }
  return greatest / SideLength(to);
}

}  // namespace

Polygon operator*(const Similarity& similarity, const Polygon& polygon) {
  Polygon moved = polygon;
  for (Vector2d& p : moved.outer) p = similarity * p;
  for (Ring& hole : moved.holes) {
    for (Vector2d& p : hole) p = similarity * p;
  }
  return moved;
}

Similarity RefineSimilarity(const std::vector<ShapePair>& pairs, const Similarity& start,
                            const Effort& effort) {
  std::vector<std::pair<std::vector<Sample>, std::vector<Sample>>> samples;
  double side = 0.0;
  for (const ShapePair& pair : pairs) {
    samples.emplace_back(SampleOutline(*pair.first, effort.samples),
                         SampleOutline(*pair.second, effort.samples));
    side = std::max(side, SideLength(*pair.second));
  }
  Similarity current = start;
  for (int iteration = 0; iteration < effort.iterations; ++iteration) {
    std::vector<Constraint> constraints;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      AddConstraints(pairs[i], samples[i].first, samples[i].second, current, constraints);
    }
    std::vector<double> distances;
    for (const Constraint& c : constraints) distances.push_back(std::abs(c.distance));
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    const Similarity next = Solve(constraints, std::max(0.01 * side, 2.0 * *middle));
    if (!std::isfinite(next.a + next.b + next.translation.sum()) || next.Scale() <= 0.0) return current;
    const double change = std::hypot(next.a - current.a, next.b - current.b) / current.Scale();
    current = next;
    if (change < 3e-5) break;
  }
  return current;
}

double Misfit(const ShapePair& pair, const Similarity& similarity, const Effort& effort) {
  const Polygon moved = similarity * *pair.first;
  return std::max(OneWayMisfit(moved, *pair.second, effort.samples),
                  OneWayMisfit(*pair.second, moved, effort.samples));
}

}  // namespace soffit
