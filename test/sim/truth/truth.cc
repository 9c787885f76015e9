#include "test/sim/truth/truth.h"

#include <algorithm>

#include "test/sim/truth/passage.h"
#include "test/sim/world/geos.h"
#include "test/sim/world/space.h"

namespace soffit::sim {
namespace {

void AddTriangles(const Mesh& mesh, std::vector<Triangle>& triangles) {
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]});
  }
}

std::vector<Polygon> ProjectDown(const std::vector<Triangle>& triangles) {
  std::vector<std::array<Eigen::Vector2d, 3>> flat;
  for (const auto& [a, b, c] : triangles) flat.push_back({a.head<2>(), b.head<2>(), c.head<2>()});
  return Union(flat);
}

ObjectTruth Describe(const Structure& building, const World& world, const Space& space,
                     const std::vector<Triangle>& all) {
  ObjectTruth object;
  object.id = building.id;
  object.is_absent = building.is_absent;
  object.is_wanted = std::count(world.mission.wanted.begin(), world.mission.wanted.end(), building.id) > 0;
  Site site{{}, all, {}, world.vehicle, &space};
  AddTriangles(BuildMesh(building), site.building);
  for (const Triangle& triangle : site.building) {
    for (const Eigen::Vector3d& vertex : triangle) object.height_m = std::max(object.height_m, vertex.z());
  }
  object.footprint_in_map_m = site.footprint = ProjectDown(site.building);
  if (!object.is_absent) object.passages = FindPassages(site);
  return object;
}

std::string InWords(const Passage& passage, const VehicleEnvelope& vehicle) {
  char text[200];
  std::snprintf(text, sizeof(text), "%.2f x %.2f m free, %.2f x %.2f m needed", passage.free_width_m,
                passage.free_height_m, vehicle.NeededWidth_m(), vehicle.NeededHeight_m());
  return text;
}

void Conclude(const World& world, Truth& truth) {
  truth.expected = Outcome::kNotFlown;
  truth.reason = "no way leads under or through what is wanted";
  double best_ratio = 0.0;
  for (const ObjectTruth& object : truth.objects) {
    if (!object.is_wanted) continue;
    if (object.is_absent) {
      truth.expected = Outcome::kNoMatch;
      truth.reason = object.id + " is not there";
      return;
    }
    if (object.passages.empty()) continue;
    const Passage& best = object.passages.front();
    if (!best.is_passable && (truth.expected == Outcome::kFlown || best.ratio <= best_ratio)) continue;
    if (best.is_passable) truth.expected = Outcome::kFlown;
    best_ratio = best.ratio;
    truth.reason = object.id + ": " + InWords(best, world.vehicle);
  }
}

nlohmann::json ToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json ToJson(const Ring& ring) {
  nlohmann::json corners = nlohmann::json::array();
  for (const Eigen::Vector2d& corner : ring) corners.push_back({corner.x(), corner.y()});
  return corners;
}

nlohmann::json ToJson(const Passage& passage) {
  return {{"entry", ToJson(passage.entry_m)},
          {"exit", ToJson(passage.exit_m)},
          {"free_width_m", passage.free_width_m},
          {"free_height_m", passage.free_height_m},
          {"ratio", passage.ratio},
          {"spare_m", passage.spare_m},
          {"passable", passage.is_passable}};
}

nlohmann::json ToJson(const ObjectTruth& object) {
  nlohmann::json footprints = nlohmann::json::array(), passages = nlohmann::json::array();
  for (const Polygon& polygon : object.footprint_in_map_m) {
    nlohmann::json holes = nlohmann::json::array();
    for (const Ring& hole : polygon.holes) holes.push_back(ToJson(hole));
    footprints.push_back({{"outer", ToJson(polygon.outer)}, {"holes", holes}});
  }
  for (const Passage& passage : object.passages) passages.push_back(ToJson(passage));
  return {{"id", object.id},
          {"wanted", object.is_wanted},
          {"absent", object.is_absent},
          {"height_m", object.height_m},
          {"footprint", footprints},
          {"passages", passages}};
}

}  // namespace

std::vector<Polygon> FindFootprint(const Structure& building) {
  std::vector<Triangle> triangles;
  AddTriangles(BuildMesh(building), triangles);
  return ProjectDown(triangles);
}

const char* ToString(Outcome outcome) {
  switch (outcome) {
    case Outcome::kNotFlown:
      return "not-flown";
    case Outcome::kFlown:
      return "flown";
    case Outcome::kNoMatch:
      return "no-match";
  }
  return "not-flown";
}

Truth FindTruth(const World& world) {
  const Space space(world);
  std::vector<Triangle> all;
  for (const WorldBody& body : BuildBodies(world)) AddTriangles(body.mesh_in_map, all);
  Truth truth;
  for (const Structure& building : world.buildings)
    truth.objects.push_back(Describe(building, world, space, all));
  Conclude(world, truth);
  return truth;
}

nlohmann::json ToJson(const Truth& truth) {
  nlohmann::json objects = nlohmann::json::array();
  for (const ObjectTruth& object : truth.objects) objects.push_back(ToJson(object));
  return {{"expected", ToString(truth.expected)}, {"reason", truth.reason}, {"objects", objects}};
}

}  // namespace soffit::sim
