#include "service/solid/passage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "service/facade/wall.h"
#include "shared/geometry/heights.h"

namespace soffit {
namespace {

constexpr double kMinOverlap = 0.5;  // Of the smaller mouth's width or height: less does not lie opposite.
constexpr double kAgreeSigmas = 6.0;     // By more, the mouths of one passage differ.
constexpr double kLeastCosine = 0.34;    // Between a passage and the normals of its walls (70 degrees).
constexpr double kStraightDrift = 0.12;  // By less, a jamb leads to the far mouth's corner.
constexpr double kLeastKnee_m = 0.08;    // Off the straight way; a jamb with less has none.
constexpr double kTurnCost = 0.1;        // Of a way that leaves its wall at 45 degrees.
constexpr double kContradicted = 1.0;    // Costs a way that the jambs do not lead along.
constexpr double kLeastShare = 0.05;     // Of a side's length, from its ends to where the other one bends.
constexpr double kLeastSide_m = 1e-3;    // Of a passage, from one section to the next.
constexpr double kSameStation = 1e-6;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

struct Extent {
  double left = 0.0, right = 0.0, bottom = 0.0, top = 0.0;
  double Width() const { return right - left; }
  double Height() const { return top - bottom; }
  double Area() const { return Width() * Height(); }
};

Extent ExtentOf(const Ring& ring) {
  Extent extent{ring.front().x(), ring.front().x(), ring.front().y(), ring.front().y()};
  for (const Eigen::Vector2d& p : ring) {
    extent = {std::min(extent.left, p.x()), std::max(extent.right, p.x()), std::min(extent.bottom, p.y()),
              std::max(extent.top, p.y())};
  }
  return extent;
}

/// An opening in the wall that it is in.
struct Gate {
  Wall wall;
  Ring ring;
  Extent extent;
  double std_m = 0.0;
  std::optional<double> left_drift, right_drift;

  bool Stands() const { return extent.bottom <= 0.0; }
  Eigen::Vector2d Left() const { return wall.InPlan(extent.left); }
  Eigen::Vector2d Right() const { return wall.InPlan(extent.right); }
  Eigen::Vector2d Middle() const { return 0.5 * (Left() + Right()); }
  /// Into the building.
  Eigen::Vector2d Along(double drift) const { return (drift * wall.along - wall.outward).normalized(); }
};

Gate GateOf(const Polygon& footprint, const Facade& facade, const Opening& opening) {
  return {WallOf(footprint.outer, facade.side),
          opening.ring_in_wall_m,
          ExtentOf(opening.ring_in_wall_m),
          opening.std_m,
          opening.left_drift,
          opening.right_drift};
}

/// Where the corners of an outline are: shares of its width, from its left end as seen by who enters.
std::vector<double> SharesOf(const Ring& ring, bool is_mirrored) {
  const Extent extent = ExtentOf(ring);
  std::vector<double> shares;
  for (const Eigen::Vector2d& p : ring) {
    const double share = (p.x() - extent.left) / extent.Width();
    shares.push_back(is_mirrored ? 1.0 - share : share);
  }
  return shares;
}

std::vector<double> Stations(std::vector<double> shares) {
  std::sort(shares.begin(), shares.end());
  std::vector<double> stations;
  for (const double share : shares) {
    if (stations.empty() || share - stations.back() > kSameStation) stations.push_back(share);
  }
  stations.front() = 0.0;
  stations.back() = 1.0;
  return stations;
}

/// The heights of an outline at each station, from its left end as seen by who enters.
std::vector<Span> ProfileOf(const Ring& ring, const std::vector<double>& stations, bool is_mirrored) {
  const Extent extent = ExtentOf(ring);
  std::vector<Span> heights;
  for (const double station : stations) {
    const double share = std::clamp(is_mirrored ? 1.0 - station : station, kSameStation, 1.0 - kSameStation);
    heights.push_back(HeightsAt(ring, extent.left + share * extent.Width()));
  }
  return heights;
}

Section Raise(const std::vector<Span>& heights, const std::vector<double>& stations,
              const Eigen::Vector2d& left, const Eigen::Vector2d& right) {
  Section section;
  const auto add = [&](std::size_t i, double z) {
    const Eigen::Vector2d plan = left + stations[i] * (right - left);
    section.emplace_back(plan.x(), plan.y(), z);
  };
  for (std::size_t i = 0; i < stations.size(); ++i) add(i, heights[i].low);
  for (std::size_t i = stations.size(); i-- > 0;) add(i, heights[i].high);
  return section;
}

/// Where the line from `from` along `direction` meets the wall's plane.
Eigen::Vector2d Carry(const Eigen::Vector2d& from, const Eigen::Vector2d& direction, const Wall& to) {
  return from - to.Front(from) / direction.dot(to.outward) * direction;
}

/// One side of a passage, from its corner at the entry to that at the exit.
struct Side {
  bool is_possible = true;
  std::optional<Eigen::Vector2d> knee;
  double knee_m = 0.0;  ///< From the straight line.
};

/// @param into      From either end along its jamb into the building; none: not known.
/// @param supposed  What is taken for that.
Side JoinSide(const std::array<Eigen::Vector2d, 2>& end,
              const std::array<std::optional<Eigen::Vector2d>, 2>& into,
              const std::array<Eigen::Vector2d, 2>& supposed, double least_knee_m) {
  const Eigen::Vector2d chord = end[1] - end[0];
  const double length = chord.norm();
  if (!(length > 0.0)) return {};
  const auto leads_across = [&](std::size_t i) {
    return into[i] && (std::abs(Cross(*into[i], chord)) > kStraightDrift * length ||
                       into[i]->dot(i == 0 ? chord : Eigen::Vector2d(-chord)) <= 0.0);
  };
  if (!leads_across(0) && !leads_across(1)) return {};
  const Eigen::Vector2d from = into[0].value_or(supposed[0]);
  const Eigen::Vector2d back = into[1].value_or(supposed[1]);
  const double sine = Cross(from, back);
  if (std::abs(sine) < 1e-3) return {false, std::nullopt, 0.0};
  const double there = Cross(chord, back) / sine;
  const double here = Cross(chord, from) / sine;
  if (!(there > 0.0) || !(here > 0.0)) return {false, std::nullopt, 0.0};
  const Eigen::Vector2d knee = end[0] + there * from;
  const double knee_m = std::abs(Cross(knee - end[0], chord)) / length;
  if (knee_m < least_knee_m) return {};
  return {true, knee, knee_m};
}

bool IsInside(const Polygon& footprint, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d from = a + 1e-6 * (b - a);
  const Eigen::Vector2d to = b + 1e-6 * (a - b);
  return Contains(footprint, 0.5 * (from + to)) && !Crosses(footprint.outer, from, to) &&
         std::none_of(footprint.holes.begin(), footprint.holes.end(),
                      [&](const Ring& hole) { return Crosses(hole, from, to); });
}

/// Whether the openings overlap in height, by most of the smaller one: ways through buildings hardly climb.
bool LieAtOneHeight(const Gate& a, const Gate& b) {
  const double shared = std::min(a.extent.top, b.extent.top) - std::max(a.extent.bottom, b.extent.bottom);
  return shared > kMinOverlap * std::min(a.extent.Height(), b.extent.Height());
}

/// Whether most of the smaller opening lies straight opposite the other one.
bool LieOpposite(const Polygon& footprint, const Gate& a, int side, const Gate& b, int other_side) {
  const auto way = FindWayOut(footprint, side, 0.5 * (a.extent.left + a.extent.right));
  if (!way || way->side != other_side) return false;
  const double left = a.wall.U(b.Right()), right = a.wall.U(b.Left());
  const double common = std::min(a.extent.right, right) - std::max(a.extent.left, left);
  return common >= kMinOverlap * std::min(a.extent.Width(), right - left);
}

/// Whether one mouth shows less than the other. What is moved but as large is slanted instead.
bool DifferInSize(const Gate& a, const Gate& b) {
  const double reach = kAgreeSigmas * std::hypot(a.std_m, b.std_m);
  return std::abs(a.wall.U(b.Left()) - a.wall.U(b.Right()) - a.extent.Width()) > reach ||
         std::abs(b.extent.Height() - a.extent.Height()) > reach;
}

/// A mouth, and what it becomes when it is swept along `direction` to another wall. Mirrored: it is where
/// the passage ends, and what enters comes from there.
std::array<Section, 2> Sweep(const Gate& gate, bool is_mirrored, const Eigen::Vector2d& direction,
                             const Wall& to) {
  const std::vector<double> stations = Stations(SharesOf(gate.ring, is_mirrored));
  const std::vector<Span> heights = ProfileOf(gate.ring, stations, is_mirrored);
  const Eigen::Vector2d left = is_mirrored ? gate.Right() : gate.Left();
  const Eigen::Vector2d right = is_mirrored ? gate.Left() : gate.Right();
  return {Raise(heights, stations, left, right),
          Raise(heights, stations, Carry(left, direction, to), Carry(right, direction, to))};
}

/// The larger of two mouths, swept straight to the other one's wall.
std::vector<Section> SweepLarger(const Gate& a, const Gate& b) {
  if (a.extent.Area() > b.extent.Area()) {
    const auto [entry, exit] = Sweep(a, false, -a.wall.outward, b.wall);
    return {entry, exit};
  }
  const auto [exit, entry] = Sweep(b, true, -b.wall.outward, a.wall);
  return {entry, exit};
}

/// Both sides, left and right as seen by who enters at `a`.
struct Sides {
  Side left, right;
  bool IsStraight() const { return !left.knee && !right.knee; }
};

std::optional<Sides> JoinSides(const Gate& a, const Gate& b) {
  const auto along = [](const Gate& gate, const std::optional<double>& drift) {
    return drift ? std::optional(gate.Along(*drift)) : std::nullopt;
  };
  const auto like = [](const Gate& gate, const std::optional<double>& other_jamb) {
    return gate.Along(other_jamb.value_or(0.0));
  };
  const double least_knee_m = std::max(kLeastKnee_m, kAgreeSigmas * std::hypot(a.std_m, b.std_m));
  const Sides sides = {JoinSide({a.Left(), b.Right()}, {along(a, a.left_drift), along(b, b.right_drift)},
                                {like(a, a.right_drift), like(b, b.left_drift)}, least_knee_m),
                       JoinSide({a.Right(), b.Left()}, {along(a, a.right_drift), along(b, b.left_drift)},
                                {like(a, a.left_drift), like(b, b.right_drift)}, least_knee_m)};
  if (!sides.left.is_possible || !sides.right.is_possible) return std::nullopt;
  return sides;
}

/// Where a side of a passage is when the other one bends: at its own knee, or as far along.
Eigen::Vector2d Beside(const Side& own, const std::array<Eigen::Vector2d, 2>& own_ends, const Side& other,
                       const std::array<Eigen::Vector2d, 2>& other_ends) {
  if (own.knee) return *own.knee;
  const Eigen::Vector2d chord = other_ends[1] - other_ends[0];
  const double share = (*other.knee - other_ends[0]).dot(chord) / chord.squaredNorm();
  return own_ends[0] + std::clamp(share, kLeastShare, 1.0 - kLeastShare) * (own_ends[1] - own_ends[0]);
}

std::vector<Section> SectionsOf(const Gate& a, const Gate& b, const Sides& sides) {
  std::vector<double> shares = SharesOf(a.ring, false);
  const std::vector<double> others = SharesOf(b.ring, true);
  shares.insert(shares.end(), others.begin(), others.end());
  const std::vector<double> stations = Stations(std::move(shares));
  const std::vector<Span> at_a = ProfileOf(a.ring, stations, false);
  const std::vector<Span> at_b = ProfileOf(b.ring, stations, true);
  std::vector<Section> sections = {Raise(at_a, stations, a.Left(), a.Right())};
  if (!sides.IsStraight()) {
    std::vector<Span> between;
    for (std::size_t i = 0; i < stations.size(); ++i)
      between.push_back({0.5 * (at_a[i].low + at_b[i].low), 0.5 * (at_a[i].high + at_b[i].high)});
    const std::array left = {a.Left(), b.Right()}, right = {a.Right(), b.Left()};
    sections.push_back(Raise(between, stations, Beside(sides.left, left, sides.right, right),
                             Beside(sides.right, right, sides.left, left)));
  }
  sections.push_back(Raise(at_b, stations, b.Right(), b.Left()));
  return sections;
}

/// In plan.
Eigen::Vector2d MiddleOf(const Section& section) {
  return 0.5 * (section.front() + section[section.size() / 2 - 1]).head<2>();
}

bool LiesAcross(const Section& section, const Eigen::Vector2d& way) {
  const Eigen::Vector2d width = (section[section.size() / 2 - 1] - section.front()).head<2>();
  return Cross(width, way) > kLeastCosine * width.norm();
}

/// Whether the passage has no length on one side: its mouths meet in a corner of the building.
bool HasPoint(const std::vector<Section>& sections) {
  for (std::size_t k = 0; k + 1 < sections.size(); ++k) {
    for (std::size_t i = 0; i < sections[k].size(); ++i) {
      if ((sections[k + 1][i] - sections[k][i]).norm() < kLeastSide_m) return true;
    }
  }
  return false;
}

struct Course {
  double cost = 0.0;
  std::vector<Section> sections;
};

/// The way between two mouths that may be those of one passage; none when it would leave the building.
std::optional<Course> FindCourse(const Polygon& footprint, const Gate& a, const Gate& b, bool lie_opposite) {
  const std::optional<Sides> joined = JoinSides(a, b);
  if (!joined && !lie_opposite) return std::nullopt;
  const bool may_be_hidden = !joined || (!a.Stands() && !b.Stands());
  const double cost = joined ? 0.0 : kContradicted;
  if (lie_opposite && may_be_hidden && DifferInSize(a, b)) return Course{cost, SweepLarger(a, b)};
  const Sides sides = joined.value_or(Sides{});
  Course course{cost, SectionsOf(a, b, sides)};
  if (HasPoint(course.sections)) return std::nullopt;
  std::vector<Eigen::Vector2d> line;
  for (const Section& section : course.sections) line.push_back(MiddleOf(section));
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Eigen::Vector2d way = (line[i + 1] - line[i]).normalized();
    if (!IsInside(footprint, line[i], line[i + 1]) || !LiesAcross(course.sections[i], way) ||
        !LiesAcross(course.sections[i + 1], way)) {
      return std::nullopt;
    }
  }
  course.cost += (sides.left.knee_m + sides.right.knee_m) / (b.Middle() - a.Middle()).norm();
  for (const double cosine : {-(line[1] - line[0]).normalized().dot(a.wall.outward),
                              (line.back() - line[line.size() - 2]).normalized().dot(b.wall.outward)}) {
    if (!(cosine > kLeastCosine)) return std::nullopt;
    course.cost += kTurnCost * std::tan(std::acos(std::min(1.0, cosine)));
  }
  return course;
}

/// One opening that shows something beyond.
struct Candidate {
  Mouth mouth;
  int side = -1;
  Gate gate;
  bool is_through = false;
};

std::vector<Candidate> ListCandidates(const Polygon& footprint, const std::vector<Facade>& facades) {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < facades.size(); ++i) {
    for (std::size_t j = 0; facades[i].was_seen && j < facades[i].openings.size(); ++j) {
      const Opening& opening = facades[i].openings[j];
      if (!opening.shows_background) continue;
      candidates.push_back(
          {{i, j}, facades[i].side, GateOf(footprint, facades[i], opening), opening.is_through});
    }
  }
  return candidates;
}

/// From a mouth along its jambs to the wall opposite, when that was not seen.
std::optional<Tunnel> Suppose(const Polygon& footprint, const std::vector<Facade>& facades,
                              const Candidate& entry) {
  const Gate& gate = entry.gate;
  const double drift = gate.left_drift && gate.right_drift
                           ? 0.5 * (*gate.left_drift + *gate.right_drift)
                           : gate.left_drift.value_or(gate.right_drift.value_or(0.0));
  const auto out = FindWayOut(footprint, entry.side, 0.5 * (gate.extent.left + gate.extent.right), drift);
  const bool is_unseen = out && std::any_of(facades.begin(), facades.end(), [&](const Facade& other) {
                           return other.side == out->side && !other.was_seen;
                         });
  if (!is_unseen) return std::nullopt;
  const auto [near, far] = Sweep(gate, false, gate.Along(drift), WallOf(footprint.outer, out->side));
  return Tunnel{entry.mouth, std::nullopt, out->side, {near, far}};
}

}  // namespace

std::vector<Tunnel> FindTunnels(const Polygon& footprint, const std::vector<Facade>& facades) {
  const std::vector<Candidate> candidates = ListCandidates(footprint, facades);
  std::vector<std::pair<double, Tunnel>> by_cost;
  for (auto a = candidates.begin(); a != candidates.end(); ++a) {
    for (auto b = std::next(a); b != candidates.end(); ++b) {
      if (a->side == b->side || !LieAtOneHeight(a->gate, b->gate)) continue;
      const bool lie_opposite = LieOpposite(footprint, a->gate, a->side, b->gate, b->side);
      if (!lie_opposite && !(a->is_through && b->is_through)) continue;
      if (auto course = FindCourse(footprint, a->gate, b->gate, lie_opposite))
        by_cost.push_back({course->cost, {a->mouth, b->mouth, b->side, std::move(course->sections)}});
    }
  }
  std::stable_sort(by_cost.begin(), by_cost.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::set<Mouth> used;
  std::vector<Tunnel> tunnels;
  for (auto& [cost, tunnel] : by_cost) {
    if (used.count(tunnel.entry) > 0 || used.count(*tunnel.exit) > 0) continue;
    used.insert({tunnel.entry, *tunnel.exit});
    tunnels.push_back(std::move(tunnel));
  }
  for (const Candidate& candidate : candidates) {
    if (used.count(candidate.mouth) > 0) continue;
    if (auto tunnel = Suppose(footprint, facades, candidate)) tunnels.push_back(std::move(*tunnel));
  }
  std::stable_sort(tunnels.begin(), tunnels.end(),
                   [](const Tunnel& a, const Tunnel& b) { return a.entry < b.entry; });
  return tunnels;
}

}  // namespace soffit
