#include "test/bench/scanned.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>

#include "test/sim/draw/shapes.h"
#include "test/sim/world/city_gml.h"
#include "test/sim/world/mesh_file.h"

namespace soffit::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using sim::Finish;
using sim::Part;
using sim::Pattern;
using sim::Prism;
using sim::Structure;
using sim::World;

constexpr VehicleEnvelope kVehicle{0.35, 0.30, 0.25};
const sim::PoseNoise kNoise{0.2, 1.5 * std::numbers::pi / 180.0};
constexpr double kLining_m = 0.25;
constexpr double kBeyond_m = 100.0;
constexpr double kTight_m = 0.12;
const Finish kWalls{{0.72, 0.16, 0.12}, Pattern::kMottled, 0.8, 0.15};
const Finish kPanes{{0.13, 0.14, 0.16}, Pattern::kPlain, 1.0, 0.0};
const Finish kGrey{{0.45, 0.45, 0.46}, Pattern::kMottled, 0.3, 0.1};

/// Where the scan of a passage ends, in the frame of the mesh.
struct Closure {
  Vector2d center;
  Vector2d inward;  ///< Unit; along the passage, on into the building.
  Vector2d right;   ///< As seen by who looks inward.
  Ring outline;     ///< (right, up) from the centre, counter-clockwise.
  double width_m = 0.0;
  double top_m = 0.0;

  Vector2d Place(double right_m, double inward_m) const {
    return center + right_m * right + inward_m * inward;
  }
};

Vector3d Level(const Vector2d& direction) { return {direction.x(), direction.y(), 0.0}; }

/// As long as twice the ring's area (M. Newell).
Vector3d NormalOf(const std::vector<Vector3d>& ring) {
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i)
    normal += (ring[i] - ring[0]).cross(ring[(i + 1) % ring.size()] - ring[0]);
  return normal;
}

std::vector<Vector3d> FindClosureRing(const std::vector<sim::CitySurface>& surfaces, const Vector3d& origin) {
  std::vector<Vector3d> largest;
  for (const sim::CitySurface& surface : surfaces) {
    if (surface.kind != "ClosureSurface") continue;
    const Vector3d normal = NormalOf(surface.rings[0]);
    const bool is_upright = std::abs(normal.z()) < 0.1 * normal.norm();
    if (is_upright && (largest.empty() || normal.norm() > NormalOf(largest).norm()))
      largest = surface.rings[0];
  }
  for (Vector3d& corner : largest) corner -= origin;
  return largest;
}

/// How far the building's surfaces are from a point in a direction, nearest first.
std::vector<double> FindHits(const sim::Mesh& mesh, const Vector3d& from, const Vector3d& ray) {
  constexpr double kTouching_m = 0.01;
  std::vector<double> hits;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d p = mesh.vertices_m[static_cast<std::size_t>(a)];
    Eigen::Matrix3d sides;
    sides << mesh.vertices_m[static_cast<std::size_t>(b)] - p,
        mesh.vertices_m[static_cast<std::size_t>(c)] - p, -ray;
    if (std::abs(sides.determinant()) < 1e-12) continue;
    const Vector3d at = sides.inverse() * (from - p);
    if (at.x() >= 0.0 && at.y() >= 0.0 && at.x() + at.y() <= 1.0 && at.z() > kTouching_m)
      hits.push_back(at.z());
  }
  std::sort(hits.begin(), hits.end());
  return hits;
}

/// How far the passage has a ceiling, from the closure outward.
double FindNearMouth_m(const sim::Mesh& mesh, const Closure& closure) {
  constexpr double kStep_m = 0.1;
  double near_m = 0.0;
  for (;; near_m -= kStep_m) {
    const Vector2d at = closure.Place(0.0, near_m - kStep_m);
    if (FindHits(mesh, {at.x(), at.y(), 0.5 * closure.top_m}, Vector3d::UnitZ()).empty()) return near_m;
  }
}

Closure Describe(const std::vector<Vector3d>& ring, const sim::Mesh& mesh) {
  Closure closure;
  Eigen::AlignedBox3d box;
  for (const Vector3d& corner : ring) box.extend(corner);
  closure.center = box.center().head<2>();
  closure.top_m = box.max().z();
  closure.inward = NormalOf(ring).head<2>().normalized();
  const auto count_hits = [&](const Vector2d& way) {
    return FindHits(mesh, box.center(), Level(way)).size();
  };
  if (count_hits(closure.inward) < count_hits(-closure.inward)) closure.inward *= -1.0;
  closure.right = {closure.inward.y(), -closure.inward.x()};
  for (const Vector3d& corner : ring)
    closure.outline.emplace_back((corner.head<2>() - closure.center).dot(closure.right), corner.z());
  if (SignedArea(closure.outline) < 0.0) std::reverse(closure.outline.begin(), closure.outline.end());
  for (const Vector2d& corner : closure.outline)
    closure.width_m = std::max(closure.width_m, 2.0 * std::abs(corner.x()));
  return closure;
}

/// A scanned building and its passage, which has to be led on to where `far_m` is.
struct Scan {
  sim::MeshFile walls;
  sim::MeshFile panes;  ///< Windows and doors; its mesh may be empty.
  Closure closure;
  double near_m = 0.0;  ///< Of the near mouth, inward from the closure: negative.
  double far_m = 0.0;   ///< Of the far mouth.
  double radius_m = 0.0;
  double height_m = 0.0;
};

/// The sides and the ceiling of the passage that is led through a hollow scan.
std::vector<Part> Line(const Scan& scan) {
  const Closure& closure = scan.closure;
  const double half_m = 0.5 * closure.width_m;
  const auto end_at = [&](double right_m) {
    const Vector2d from = closure.Place(right_m, 0.0);
    const auto hits =
        FindHits(scan.walls.mesh, {from.x(), from.y(), 0.5 * closure.top_m}, Level(closure.inward));
    return hits.empty() ? 0.0 : hits.back();
  };
  const auto slab = [&](double left_m, double right_m, double low_m, double high_m) {
    const Ring ring = {closure.Place(left_m, 0.0), closure.Place(right_m, 0.0),
                       closure.Place(right_m, end_at(right_m)), closure.Place(left_m, end_at(left_m))};
    return sim::UprightPart(ring, low_m, high_m);
  };
  if (end_at(0.0) < kLining_m) return {};
  return {slab(-half_m - kLining_m, -half_m, 0.0, closure.top_m),
          slab(half_m, half_m + kLining_m, 0.0, closure.top_m),
          slab(-half_m - kLining_m, half_m + kLining_m, closure.top_m, closure.top_m + kLining_m)};
}

Prism CutThrough(const Closure& closure) {
  Prism cut;
  cut.section.outer = closure.outline;
  cut.low_m = 0.005;
  cut.high_m = kBeyond_m;
  cut.is_lying = true;
  cut.axis = closure.inward;
  cut.at = closure.center;
  return cut;
}

Result<Scan> ReadScan(const std::filesystem::path& file) {
  const Result<std::vector<sim::CitySurface>> surfaces = sim::ReadCityGml(file);
  if (!surfaces.ok()) return surfaces.error();
  Scan scan;
  Eigen::AlignedBox3d box;
  std::set<std::string> kinds;
  for (const sim::CitySurface& surface : surfaces.value()) {
    kinds.insert(surface.kind);
    for (const auto& ring : surface.rings) {
      for (const Vector3d& corner : ring) box.extend(corner);
    }
  }
  for (const char* kind : {"Window", "Door"}) {
    if (kinds.count(kind) > 0) scan.panes.only.push_back(kind);
  }
  scan.walls.without = scan.panes.only;
  for (sim::MeshFile* mesh : {&scan.walls, &scan.panes}) {
    mesh->file = std::filesystem::absolute(file).string();
    mesh->origin = Vector3d(box.center().x(), box.center().y(), box.min().z());
    if (mesh != &scan.walls && mesh->only.empty()) continue;
    Result<sim::Mesh> read = sim::ReadMesh(*mesh, "");
    if (!read.ok()) return read.error();
    mesh->mesh = std::move(read).value();
  }
  const auto ring = FindClosureRing(surfaces.value(), *scan.walls.origin);
  if (ring.empty()) return InvalidInput(file.string() + ": has no upright ClosureSurface");
  scan.closure = Describe(ring, scan.walls.mesh);
  const Vector3d middle(scan.closure.center.x(), scan.closure.center.y(), 0.5 * scan.closure.top_m);
  const std::vector<double> hits = FindHits(scan.walls.mesh, middle, Level(scan.closure.inward));
  scan.near_m = FindNearMouth_m(scan.walls.mesh, scan.closure);
  scan.far_m = hits.empty() ? 0.0 : hits.back();
  scan.radius_m = 0.5 * box.sizes().head<2>().norm();
  scan.height_m = box.sizes().z();
  return scan;
}

/// A thing in the passage, in the frame of the building.
Structure Thing(const Scan& scan, const Vector2d& middle, const Vector2d& size, double low_m, double high_m) {
  const Closure& closure = scan.closure;
  const Vector2d half = size / 2;
  Structure thing;
  thing.id = "thing";
  thing.finish = kGrey;
  thing.parts = {sim::UprightPart({closure.Place(middle.x() - half.x(), middle.y() - half.y()),
                                   closure.Place(middle.x() + half.x(), middle.y() - half.y()),
                                   closure.Place(middle.x() + half.x(), middle.y() + half.y()),
                                   closure.Place(middle.x() - half.x(), middle.y() + half.y())},
                                  low_m, high_m)};
  return thing;
}

/// An open, empty world about the building, on flat ground, seen from high enough to see all of it.
World AroundBuilding(const Scan& scan) {
  constexpr double kBeforeHome_m = 6.0;
  constexpr double kPixelsAcross = 450.0;
  World world;
  world.vehicle = kVehicle;
  world.camera.intrinsics = {1280, 960, 850, 850, 639.5, 479.5, {}};
  world.sky.haze_m = 1500.0;
  world.mission.wanted = {"scanned"};
  world.mission.reference_m_per_px = 2.0 * scan.radius_m / kPixelsAcross;
  world.mission.reference_rotation_cw_rad = 0.7;
  world.mission.area_center_m = {0.0, scan.radius_m + kBeforeHome_m};
  world.mission.overview_altitude_m = scan.height_m + 1.2 * scan.radius_m * 850.0 / 480.0;
  return world;
}

class Builder {
 public:
  explicit Builder(const Scan& scan) : scan_(scan) {}

  void AddAll() {
    const Closure& closure = scan_.closure;
    const double inside_m = 0.5 * (scan_.near_m + scan_.far_m);
    const double wide_m = closure.width_m;
    const double tall_m = closure.top_m;
    Add("as scanned", false, {});
    Add("led through", true, {});
    Add("wall inside", true, Thing(scan_, {0.0, inside_m}, {wide_m, 0.2}, 0.0, tall_m), kWalls);
    Add("grey door at the far end", true,
        Thing(scan_, {0.0, std::max(0.0, scan_.far_m - 0.3)}, {wide_m, 0.1}, 0.0, tall_m));
    Add("beam", true, Thing(scan_, {0.0, inside_m}, {wide_m, 0.2}, 0.3 * tall_m, 0.3 * tall_m + 0.2));
    Add("box", true, Thing(scan_, {0.1 * wide_m, inside_m}, {0.8 * wide_m, 1.0}, 0.0, 0.8 * tall_m));
    Add("pole", true, Thing(scan_, {0.0, inside_m}, {0.12, 0.12}, 0.0, tall_m));
    Add("low lintel", true,
        Thing(scan_, {0.0, inside_m}, {wide_m, 0.5}, kVehicle.NeededHeight_m() - kTight_m, tall_m), kWalls);
    for (const double spare_m : {-kTight_m, kTight_m}) {
      Add(spare_m > 0.0 ? "wide enough" : "too narrow", true, {});
      worlds_.back().vehicle.radius_m = 0.5 * (wide_m - spare_m) - kVehicle.safety_margin_m;
    }
    const std::size_t exact = worlds_.size();
    for (std::size_t i = 0; i < exact; ++i) AddNoisy(worlds_[i]);
  }

  std::vector<World> Take() { return std::move(worlds_); }

 private:
  void Add(const std::string& kind, bool is_led_through, std::optional<Structure> thing,
           const Finish& finish = kGrey) {
    World world = AroundBuilding(scan_);
    world.name =
        std::filesystem::path(scan_.walls.file).stem().string() + "-" + std::to_string(worlds_.size());
    world.title = kind + ", " + world.name;
    Structure building;
    building.id = "scanned";
    building.position_m = world.mission.area_center_m;
    building.finish = kWalls;
    for (const sim::MeshFile* mesh : {&scan_.walls, &scan_.panes}) {
      if (mesh->mesh.triangles.empty()) continue;
      sim::MeshFile cut = *mesh;
      if (is_led_through) cut.cuts = {CutThrough(scan_.closure)};
      cut.mesh = sim::ReadMesh(cut, "").value();
      building.parts.push_back({cut, mesh == &scan_.panes ? kPanes : kWalls});
    }
    if (is_led_through) {
      for (Part& part : Line(scan_)) building.parts.push_back(std::move(part));
    }
    world.buildings = {building};
    if (thing) {
      thing->position_m = building.position_m;
      thing->finish = finish;
      world.obstacles.push_back(*thing);
    }
    worlds_.push_back(std::move(world));
  }

  void AddNoisy(World world) {
    const std::size_t comma = world.title.find(',');
    world.title.insert(comma, " (poses are noisy)");
    world.name += "-noisy";
    world.pose_noise = kNoise;
    worlds_.push_back(std::move(world));
  }

  const Scan& scan_;
  std::vector<World> worlds_;
};

}  // namespace

Result<std::vector<World>> BuildScannedWorlds(const std::filesystem::path& file) {
  const Result<Scan> scan = ReadScan(file);
  if (!scan.ok()) return scan.error();
  Builder builder(scan.value());
  builder.AddAll();
  return builder.Take();
}

}  // namespace soffit::bench
