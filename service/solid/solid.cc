#include "service/solid/solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "service/facade/wall.h"
#include "service/solid/boolean.h"

namespace soffit {
namespace {

constexpr double kOvercut_m = 0.01;   // Cuts reach this far out of the solid, so that no faces coincide.
constexpr double kMinOverlap = 0.5;   // Of the smaller mouth's width: less is no counterpart.
constexpr double kAgreeSigmas = 6.0;  // By more, the mouths of one passage do not differ.

struct Extent {
  double left = 0.0, right = 0.0, bottom = 0.0, top = 0.0;
};

Extent ExtentOf(const Ring& ring) {
  Extent extent{ring.front().x(), ring.front().x(), ring.front().y(), ring.front().y()};
  for (const Eigen::Vector2d& p : ring) {
    extent = {std::min(extent.left, p.x()), std::max(extent.right, p.x()), std::min(extent.bottom, p.y()),
              std::max(extent.top, p.y())};
  }
  return extent;
}

bool Agree(const Extent& a, const Extent& b, double reach) {
  return std::abs(a.left - b.left) <= reach && std::abs(a.right - b.right) <= reach &&
         std::abs(a.bottom - b.bottom) <= reach && std::abs(a.top - b.top) <= reach;
}

double AreaOf(const Extent& e) { return (e.right - e.left) * (e.top - e.bottom); }

/// The outline of an opening as heights over a horizontal coordinate; openings are x-monotone.
struct Profile {
  Ring ring;
  /// Lowest and highest point at `u`; none outside.
  std::optional<Eigen::Vector2d> At(double u) const {
    std::optional<Eigen::Vector2d> span;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d& a = ring[i];
      const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
      if ((a.x() < u && b.x() < u) || (a.x() > u && b.x() > u)) continue;
      const double share = a.x() == b.x() ? 0.0 : (u - a.x()) / (b.x() - a.x());
      for (const double v :
           {a.y() + share * (b.y() - a.y()), a.x() == b.x() ? b.y() : a.y() + share * (b.y() - a.y())}) {
        if (!span) span = Eigen::Vector2d(v, v);
        span->x() = std::min(span->x(), v);
        span->y() = std::max(span->y(), v);
      }
    }
    return span;
  }
};

/// Common part of two x-monotone openings, sampled at the corners of both; empty when they do not overlap.
Ring CommonPart(const Ring& a, const Ring& b) {
  const Extent of_a = ExtentOf(a);
  const Extent of_b = ExtentOf(b);
  const double left = std::max(of_a.left, of_b.left);
  const double right = std::min(of_a.right, of_b.right);
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
    const auto in_a = Profile{a}.At(u);
    const auto in_b = Profile{b}.At(u);
    if (!in_a || !in_b) return {};
    const double low = std::max(in_a->x(), in_b->x());
    const double high = std::min(in_a->y(), in_b->y());
    if (!(high > low)) return {};
    lower.emplace_back(stations[i], low);
    upper.emplace_back(stations[i], high);
  }
  Ring ring = lower;
  ring.insert(ring.end(), upper.rbegin(), upper.rend());
  Ring corners;  // Without those on straight lines.
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& before = corners.empty() ? ring.back() : corners.back();
    if (DistanceToSegment(ring[i], before, ring[(i + 1) % ring.size()]) > 1e-6) corners.push_back(ring[i]);
  }
  return corners;
}

/// An opening of the opposite wall in coordinates of this one: seen from the other side, so mirrored.
Ring Carry(const Ring& ring, const Wall& from, const Wall& to) {
  Ring carried;
  for (auto p = ring.rbegin(); p != ring.rend(); ++p) carried.emplace_back(to.U(from.InPlan(p->x())), p->y());
  return carried;
}

Eigen::Vector3d Up(const Eigen::Vector2d& plan, double z) { return {plan.x(), plan.y(), z}; }

/// What to take out for an opening: its outline swept inward; a standing one is cut through the ground plane.
Prism CutFor(const Wall& wall, Ring ring, double from_m, double to_m) {
  for (Eigen::Vector2d& p : ring) {
    if (p.y() <= 0.0) p.y() = -kOvercut_m;
  }
  const Eigen::Vector2d start = wall.first_corner_m - from_m * wall.outward;
  return {std::move(ring), Up(start, 0.0), Up(wall.along, 0.0), Eigen::Vector3d::UnitZ(),
          Up(-(to_m - from_m) * wall.outward, 0.0)};
}

struct Assembly {
  const Footprint& footprint;
  const std::vector<Facade>& facades;
  Solid solid;
  std::vector<Prism> cuts;
  std::map<std::pair<int, std::size_t>, std::size_t> listed = {};  ///< Facade opening -> Solid::openings.

  const Facade* FacadeOf(int side) const {
    for (const Facade& facade : facades) {
      if (facade.side == side) return &facade;
    }
    return nullptr;
  }

  std::size_t List(int side, const Ring& ring, const Opening& opening, bool is_through) {
    const Wall wall = WallOf(footprint.polygon_in_map_m.outer, side);
    SolidOpening entry;
    entry.wall = side;
    for (const Eigen::Vector2d& p : ring) entry.polygon_in_map_m.push_back(wall.InMap(p));
    entry.is_through = is_through;
    if (!is_through && opening.recess) entry.depth_m = opening.recess->depth_m;
    entry.std_m = opening.std_m;
    solid.openings.push_back(std::move(entry));
    return solid.openings.size() - 1;
  }

  struct Counterpart {
    std::size_t index = 0;
    Ring section;
  };
  /// The opening of `facade` that shows something beyond and shares most with this one of `wall`. Both are
  /// the section of one passage, so they should be alike; when they are not, something beyond one of them
  /// that looks like the building hides a part of it, and the larger one is the passage's. Whether all of
  /// that is free is for the scene to tell.
  std::optional<Counterpart> FindCounterpart(const Facade& facade, const Wall& wall,
                                             const Opening& opening) const {
    const Ring& ring = opening.ring_in_wall_m;
    const Wall other = WallOf(footprint.polygon_in_map_m.outer, facade.side);
    std::optional<Counterpart> best;
    double widest = 0.0;
    for (std::size_t i = 0; i < facade.openings.size(); ++i) {
      if (!facade.openings[i].shows_background) continue;
      const Ring carried = Carry(facade.openings[i].ring_in_wall_m, other, wall);
      Ring common = CommonPart(ring, carried);
      if (common.size() < 3) continue;
      const Extent a = ExtentOf(ring), b = ExtentOf(carried), c = ExtentOf(common);
      const double overlap = (c.right - c.left) / std::min(a.right - a.left, b.right - b.left);
      if (overlap < kMinOverlap || c.right - c.left <= widest) continue;
      widest = c.right - c.left;
      const double std_m = std::hypot(opening.std_m, facade.openings[i].std_m);
      if (Agree(a, b, kAgreeSigmas * std_m)) {
        best = Counterpart{i, std::move(common)};
      } else {
        best = Counterpart{i, AreaOf(a) > AreaOf(b) ? ring : carried};
      }
    }
    return best;
  }

  void AddRecess(const Facade& facade, std::size_t index) {
    const Opening& opening = facade.openings[index];
    const Ring& ring = opening.recess ? opening.recess->ring_in_wall_m : opening.ring_in_wall_m;
    listed[{facade.side, index}] = List(facade.side, ring, opening, false);
    if (!opening.recess) return;
    const Wall wall = WallOf(footprint.polygon_in_map_m.outer, facade.side);
    cuts.push_back(CutFor(wall, ring, -kOvercut_m, opening.recess->depth_m));
  }

  void AddThrough(const Facade& facade, std::size_t index) {
    if (listed.count({facade.side, index}) > 0) return;
    const Opening& opening = facade.openings[index];
    const Wall wall = WallOf(footprint.polygon_in_map_m.outer, facade.side);
    const Extent extent = ExtentOf(opening.ring_in_wall_m);
    const auto way = FindWayOut(footprint.polygon_in_map_m, facade.side, 0.5 * (extent.left + extent.right));
    const Facade* exit = way ? FacadeOf(way->side) : nullptr;
    std::optional<Counterpart> counterpart;
    if (exit != nullptr && exit->was_seen) counterpart = FindCounterpart(*exit, wall, opening);
    const bool may_be_inferred = exit != nullptr && !exit->was_seen;
    if (!counterpart && !may_be_inferred) return AddRecess(facade, index);
    Passage passage;
    passage.entry_wall = facade.side;
    passage.exit_wall = way->side;
    passage.length_m = way->length_m;
    passage.std_m = opening.std_m;
    passage.section_m = counterpart ? counterpart->section : opening.ring_in_wall_m;
    passage.entry_opening = List(facade.side, opening.ring_in_wall_m, opening, true);
    listed[{facade.side, index}] = passage.entry_opening;
    const Wall other = WallOf(footprint.polygon_in_map_m.outer, way->side);
    if (counterpart) {
      const Opening& beyond = exit->openings[counterpart->index];
      passage.std_m = std::max(opening.std_m, beyond.std_m);
      passage.exit_opening = List(way->side, beyond.ring_in_wall_m, beyond, true);
      listed[{way->side, counterpart->index}] = passage.exit_opening;
    } else {
      passage.exit_opening = List(way->side, Carry(opening.ring_in_wall_m, wall, other), opening, true);
    }
    double reach = way->length_m;  // The exit wall may be slanted: cut as far as its farther end.
    for (const double u : {extent.left, extent.right}) {
      if (const auto end = FindWayOut(footprint.polygon_in_map_m, facade.side, u);
          end && end->side == way->side) {
        reach = std::max(reach, end->length_m);
      }
    }
    cuts.push_back(CutFor(wall, passage.section_m, -kOvercut_m, reach + kOvercut_m));
    solid.passages.push_back(std::move(passage));
  }
};

}  // namespace

Result<Solid> RaiseSolid(const Footprint& footprint, const std::vector<Facade>& facades) {
  const Polygon& polygon = footprint.polygon_in_map_m;
  if (polygon.outer.size() < 3 || !IsSimple(polygon.outer) || !(SignedArea(polygon.outer) > 0.0)) {
    return InvalidInput("the footprint is not a simple counter-clockwise polygon");
  }
  Assembly assembly{footprint, facades, {}, {}};
  Solid& solid = assembly.solid;
  solid.footprint = footprint;
  for (const Facade& facade : facades) {
    SOFFIT_EXPECT(facade.side >= 0 && facade.side < static_cast<int>(polygon.outer.size()));
    if (!facade.was_seen) solid.unseen_walls.push_back(facade.side);
    if (facade.was_seen && facade.height_m > 0.0) {
      solid.footprint.height_m = facade.height_m;
      solid.footprint.height_std_m = facade.height_std_m;
    }
  }
  if (!(solid.footprint.height_m > 0.0)) {
    return Error{Error::Code::kUnavailable,
                 "its height is not known: a picture of a wall with its upper edge is needed"};
  }
  for (const Ring& hole : polygon.holes) {
    Ring turned(hole.rbegin(), hole.rend());
    assembly.cuts.push_back({std::move(turned), Up({0.0, 0.0}, -kOvercut_m), Eigen::Vector3d::UnitX(),
                             Eigen::Vector3d::UnitY(),
                             (solid.footprint.height_m + 2.0 * kOvercut_m) * Eigen::Vector3d::UnitZ()});
  }
  for (const Facade& facade : facades) {
    if (!facade.was_seen) continue;
    for (std::size_t i = 0; i < facade.openings.size(); ++i) {
      if (facade.openings[i].shows_background) {
        assembly.AddThrough(facade, i);
      } else {
        assembly.AddRecess(facade, i);
      }
    }
  }
  const Prism body{polygon.outer, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                   solid.footprint.height_m * Eigen::Vector3d::UnitZ()};
  Result<Mesh> mesh = Subtract(body, assembly.cuts);
  if (!mesh.ok()) return mesh.error();
  solid.mesh = std::move(mesh).value();
  solid.volume_m3 = VolumeM3(solid.mesh);
  if (!IsClosedManifold(solid.mesh)) {
    return Error{Error::Code::kInternal, "the solid is not a closed 2-manifold"};
  }
  return std::move(solid);
}

bool IsClosedManifold(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> edges;
  const int count = static_cast<int>(mesh.vertices_in_map_m.size());
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = triangle[i];
      const int b = triangle[(i + 1) % 3];
      if (a < 0 || a >= count || a == b) return false;
      if (++edges[{a, b}] > 1) return false;
    }
  }
  for (const auto& [edge, uses] : edges) {
    if (edges.count({edge.second, edge.first}) == 0) return false;
  }
  return !mesh.triangles.empty() && VolumeM3(mesh) > 0.0;
}

double VolumeM3(const Mesh& mesh) {
  if (mesh.vertices_in_map_m.empty()) return 0.0;
  const Eigen::Vector3d origin = mesh.vertices_in_map_m.front();
  double volume = 0.0;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const auto corner = [&](std::size_t i) -> Eigen::Vector3d {
      return mesh.vertices_in_map_m[static_cast<std::size_t>(t[i])] - origin;
    };
    volume += corner(0).dot(corner(1).cross(corner(2))) / 6.0;
  }
  return volume;
}

}  // namespace soffit
