#include <cmath>
#include <map>
#include <numbers>

#include "test/sim/world/geos.h"
#include "test/sim/world/noise.h"
#include "test/sim/world/prism.h"
#include "test/sim/world/space.h"

namespace soffit::sim {
namespace {

void AddTriangle(Mesh& mesh, bool flip, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                 const Eigen::Vector3d& c) {
  const int first = static_cast<int>(mesh.vertices_m.size());
  mesh.vertices_m.insert(mesh.vertices_m.end(), {a, flip ? c : b, flip ? b : c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

Mesh BuildPrism(const Prism& prism) {
  Mesh mesh;
  const bool flip = prism.is_lying;  // (right, up, axis) is left-handed.
  const auto low = [&](const Eigen::Vector2d& p) { return Place(prism, p, prism.low_m); };
  const auto high = [&](const Eigen::Vector2d& p) { return Place(prism, p, prism.high_m); };
  const Polygon top = prism.top.empty() ? prism.section : Polygon{prism.top, {}};
  for (const auto& [a, b, c] : Triangulate(top)) AddTriangle(mesh, flip, high(a), high(b), high(c));
  for (const auto& [a, b, c] : Triangulate(prism.section)) AddTriangle(mesh, flip, low(c), low(b), low(a));
  const auto add_sides = [&](const Ring& below, const Ring& above) {
    for (std::size_t i = 0; i < below.size(); ++i) {
      const std::size_t j = (i + 1) % below.size();
      AddTriangle(mesh, flip, low(below[i]), low(below[j]), high(above[j]));
      AddTriangle(mesh, flip, low(below[i]), high(above[j]), high(above[i]));
    }
  };
  add_sides(prism.section.outer, top.outer);
  for (std::size_t i = 0; i < top.holes.size(); ++i) add_sides(prism.section.holes[i], top.holes[i]);
  return mesh;
}

Mesh BuildPart(const Part& part, const Structure& structure) {
  const auto* prism = std::get_if<Prism>(&part.shape);
  Mesh mesh = prism ? BuildPrism(*prism) : std::get<MeshFile>(part.shape).mesh;
  const Eigen::Rotation2Dd turn(structure.yaw_rad);
  for (Eigen::Vector3d& vertex : mesh.vertices_m) {
    vertex.head<2>() = (turn * Eigen::Vector2d(vertex.head<2>()) + structure.position_m).eval();
  }
  return mesh;
}

void AddMesh(Mesh& all, const Mesh& mesh) {
  const int first = static_cast<int>(all.vertices_m.size());
  all.vertices_m.insert(all.vertices_m.end(), mesh.vertices_m.begin(), mesh.vertices_m.end());
  for (const auto& [a, b, c] : mesh.triangles) all.triangles.push_back({first + a, first + b, first + c});
}

/// A sphere of unit radius: an octahedron, each triangle split in four, `levels` times.
Mesh BuildSphere(int levels) {
  using Eigen::Vector3d;
  Mesh mesh{{Vector3d::UnitX(), Vector3d::UnitY(), -Vector3d::UnitX(), -Vector3d::UnitY(), Vector3d::UnitZ(),
             -Vector3d::UnitZ()},
            {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices_m.size()));
      if (is_new) mesh.vertices_m.push_back((mesh.vertices_m[a] + mesh.vertices_m[b]).normalized());
      return found->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

/// A clump of bumpy balls, wholly within `radius_m` of the bush's axis and not higher than twice that.
Mesh BuildBush(const Bush& bush) {
  constexpr int kBalls = 4;
  const Mesh sphere = BuildSphere(3);
  const auto seed = static_cast<std::uint64_t>(std::llround(1e4 * bush.position_m.x()) * 7919 +
                                               std::llround(1e4 * bush.position_m.y()));
  Mesh mesh;
  for (std::uint64_t i = 0; i < kBalls; ++i) {
    const double radius_m = bush.radius_m * (0.45 + 0.2 * ToUnit(Mix(seed + 3 * i)));
    const double away_m = (i == 0 ? 0.0 : 1.0) * (0.85 * bush.radius_m - radius_m);
    const double angle =
        2.0 * std::numbers::pi * (ToUnit(Mix(seed + 3 * i + 1)) / kBalls + static_cast<double>(i) / kBalls);
    const Eigen::Vector3d center(bush.position_m.x() + away_m * std::cos(angle),
                                 bush.position_m.y() + away_m * std::sin(angle),
                                 radius_m * (0.7 + 0.5 * ToUnit(Mix(seed + 3 * i + 2))));
    Mesh ball = sphere;
    for (Eigen::Vector3d& vertex : ball.vertices_m) {
      const Eigen::Vector3f at = (4.0 * vertex + center / bush.radius_m * 9.0).cast<float>();
      vertex = center + radius_m * (1.0 + 0.15 * Noise(at)) * vertex;
    }
    AddMesh(mesh, ball);
  }
  return mesh;
}

}  // namespace

Mesh BuildMesh(const Structure& structure) {
  Mesh mesh;
  for (const Part& part : structure.parts) AddMesh(mesh, BuildPart(part, structure));
  return mesh;
}

std::vector<WorldBody> BuildBodies(const World& world) {
  std::vector<WorldBody> bodies;
  for (const auto* structures : {&world.buildings, &world.obstacles, &world.scenery}) {
    for (const Structure& structure : *structures) {
      if (structure.is_absent) continue;
      for (const Part& part : structure.parts) {
        bodies.push_back({structure.id, part.finish.value_or(structure.finish), structure.yaw_rad, false,
                          BuildPart(part, structure)});
      }
    }
  }
  const Finish leaves{{0.10, 0.17, 0.06}, Pattern::kGrass, 0.12, 0.7};
  for (const Bush& bush : world.bushes) bodies.push_back({"bush", leaves, 0.0, true, BuildBush(bush)});
  return bodies;
}

}  // namespace soffit::sim
