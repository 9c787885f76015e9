#include "service/solid/solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "service/facade/wall.h"
#include "service/solid/boolean.h"
#include "service/solid/face.h"
#include "service/solid/passage.h"
#include "service/solid/setback.h"

namespace soffit {
namespace {

constexpr double kKneeStds = 2.0;    // Where jambs meet is told by so much less well than a mouth's sides.
constexpr double kOvercut_m = 0.01;  // Cuts reach this far out of the solid, so that no faces coincide.

Eigen::Vector3d Up(const Eigen::Vector2d& plan, double z) { return {plan.x(), plan.y(), z}; }

/// What stands on the ground is cut through the ground plane.
double Below(double z) { return z <= 0.0 ? -kOvercut_m : z; }

/// What to take out for a recess: its outline swept inward.
Prism CutFor(const Wall& wall, Ring ring, double depth_m) {
  for (Eigen::Vector2d& p : ring) p.y() = Below(p.y());
  return {std::move(ring), Up(wall.first_corner_m + kOvercut_m * wall.outward, 0.0), Up(wall.along, 0.0),
          Eigen::Vector3d::UnitZ(), Up(-(depth_m + kOvercut_m) * wall.outward, 0.0)};
}

/// A section, moved on along the passage until all of it is before the wall.
Section Extend(Section section, const Section& from, const Wall& wall) {
  for (std::size_t i = 0; i < section.size(); ++i) {
    const Eigen::Vector2d way = (section[i] - from[i]).head<2>();
    section[i].head<2>() += kOvercut_m / std::max(0.1 * way.norm(), way.dot(wall.outward)) * way;
  }
  return section;
}

/// What to take out for a passage.
Tube CutFor(const Passage& passage, const Ring& outer) {
  const std::vector<Section>& given = passage.sections_in_map_m;
  std::vector<Section> sections = given;
  sections.front() = Extend(given.front(), given[1], WallOf(outer, passage.entry_wall));
  sections.back() = Extend(given.back(), given[given.size() - 2], WallOf(outer, passage.exit_wall));
  for (Section& section : sections) {
    for (Eigen::Vector3d& p : section) p.z() = Below(p.z());
  }
  return Tube(std::move(sections));
}

struct Assembly {
  const Footprint& footprint;
  const std::vector<Facade>& facades;
  Solid solid;
  std::vector<Tube> cuts = {};
  std::vector<Inside> insides = {};  ///< What each cut leaves.
  std::set<Mouth> mouths = {};       ///< Of passages.

  void Cut(Tube tube, const Inside& inside) {
    cuts.push_back(std::move(tube));
    insides.push_back(inside);
  }

  std::size_t List(int side, const Ring& ring, const Opening& opening, bool is_through) {
    const Wall wall = WallOf(footprint, side);
    SolidOpening entry;
    entry.wall = side;
    for (const Eigen::Vector2d& p : ring) entry.polygon_in_map_m.push_back(wall.InMap(p));
    entry.is_through = is_through;
    if (!is_through && opening.recess) entry.depth_m = opening.recess->depth_m;
    entry.std_m = opening.std_m;
    solid.openings.push_back(std::move(entry));
    return solid.openings.size() - 1;
  }

  std::size_t ListMouth(const Mouth& mouth) {
    const Facade& facade = facades[mouth.facade];
    const Opening& opening = facade.openings[mouth.opening];
    mouths.insert(mouth);
    return List(facade.side, opening.ring_in_wall_m, opening, true);
  }

  /// In a wall that was not seen: like the entry, where that comes out.
  std::size_t ListSupposedExit(const Passage& passage) {
    const Section& end = passage.sections_in_map_m.back();
    SolidOpening exit = solid.openings[passage.entry_opening];
    exit.wall = passage.exit_wall;
    exit.polygon_in_map_m.assign(end.rbegin(), end.rend());
    solid.openings.push_back(std::move(exit));
    return solid.openings.size() - 1;
  }

  void AddPassage(Tunnel tunnel) {
    Passage passage;
    passage.entry_wall = facades[tunnel.entry.facade].side;
    passage.exit_wall = tunnel.exit_wall;
    passage.sections_in_map_m = std::move(tunnel.sections_in_map_m);
    Tube cut = CutFor(passage, footprint.polygon_in_map_m.outer);
    if (!IsSound(cut)) return;  // The two mouths are not of one passage.
    passage.entry_opening = ListMouth(tunnel.entry);
    passage.exit_opening = tunnel.exit ? ListMouth(*tunnel.exit) : ListSupposedExit(passage);
    const bool bends = passage.sections_in_map_m.size() > 2;
    passage.std_m = (bends ? kKneeStds : 1.0) * std::max(solid.openings[passage.entry_opening].std_m,
                                                         solid.openings[passage.exit_opening].std_m);
    Cut(std::move(cut), {passage.entry_wall, static_cast<int>(passage.entry_opening)});
    solid.passages.push_back(std::move(passage));
  }

  void AddRecess(const Mouth& mouth) {
    if (mouths.count(mouth) > 0) return;
    const Facade& facade = facades[mouth.facade];
    const Opening& opening = facade.openings[mouth.opening];
    const Ring& ring = opening.recess ? opening.recess->ring_in_wall_m : opening.ring_in_wall_m;
    const std::size_t listed = List(facade.side, ring, opening, false);
    if (!opening.recess) return;
    const Wall wall = WallOf(footprint.polygon_in_map_m.outer, facade.side);
    Cut(CutFor(wall, ring, opening.recess->depth_m), {facade.side, static_cast<int>(listed)});
  }
};

}  // namespace

Result<Solid> RaiseSolid(const Footprint& footprint, const std::vector<Facade>& facades) {
  const Polygon& polygon = footprint.polygon_in_map_m;
  if (polygon.outer.size() < 3 || !IsSimple(polygon.outer) || !(SignedArea(polygon.outer) > 0.0)) {
    return InvalidInput("the footprint is not a simple counter-clockwise polygon");
  }
  Assembly assembly{footprint, facades, {}};
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
  for (int side = 0; side < static_cast<int>(polygon.outer.size()); ++side) {
    if (const std::optional<Prism> cut = CutAbove(footprint, side)) assembly.Cut(*cut, {side, -1});
  }
  for (const Ring& hole : polygon.holes) {
    Ring turned(hole.rbegin(), hole.rend());
    assembly.Cut(Prism{std::move(turned), Up({0.0, 0.0}, -kOvercut_m), Eigen::Vector3d::UnitX(),
                       Eigen::Vector3d::UnitY(),
                       (solid.footprint.height_m + 2.0 * kOvercut_m) * Eigen::Vector3d::UnitZ()},
                 {-1, -1});
  }
  for (Tunnel& tunnel : FindTunnels(polygon, facades)) assembly.AddPassage(std::move(tunnel));
  for (std::size_t i = 0; i < facades.size(); ++i) {
    for (std::size_t j = 0; facades[i].was_seen && j < facades[i].openings.size(); ++j)
      assembly.AddRecess({i, j});
  }
  const Prism body{polygon.outer, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                   solid.footprint.height_m * Eigen::Vector3d::UnitZ()};
  Result<Difference> mesh = Subtract(body, assembly.cuts);
  if (!mesh.ok()) return mesh.error();
  solid.faces = GatherFaces(mesh.value(), assembly.insides);
  solid.mesh = std::move(mesh).value();
  solid.volume_m3 = VolumeM3(solid.mesh);
  if (!IsClosedManifold(solid.mesh)) {
    return Error{Error::Code::kInternal, "the solid is not a closed 2-manifold"};
  }
  return std::move(solid);
}

const char* ToString(FaceKind kind) {
  switch (kind) {
    case FaceKind::kGround:
      return "GroundSurface";
    case FaceKind::kRoof:
      return "RoofSurface";
    case FaceKind::kCeiling:
      return "OuterCeilingSurface";
    case FaceKind::kFloor:
      return "OuterFloorSurface";
    case FaceKind::kBack:
      return "Window";
    case FaceKind::kWall:
      break;
  }
  return "WallSurface";
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
