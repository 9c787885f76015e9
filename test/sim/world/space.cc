#include "test/sim/world/space.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "test/sim/world/embree.h"

namespace soffit::sim {
namespace {

double DistanceToPoint(const Cylinder& cylinder, const Eigen::Vector3d& point) {
  const Eigen::Vector3d offset = point - cylinder.center_m;
  const double beside = std::max(0.0, offset.head<2>().norm() - cylinder.radius_m);
  const double above = std::max(0.0, std::abs(offset.z()) - 0.5 * cylinder.height_m);
  return std::hypot(beside, above);
}

/// The distance along a segment is a convex function of the place: golden section search.
double DistanceToSegment(const Cylinder& cylinder, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSteps = 48;  // 0.618^48 = 1e-10 of the length.
  double low = 0.0, high = 1.0;
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = DistanceToPoint(cylinder, a + left * (b - a));
  double at_right = DistanceToPoint(cylinder, a + right * (b - a));
  for (int i = 0; i < kSteps && std::min(at_left, at_right) > 0.0; ++i) {
    if (at_left < at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = DistanceToPoint(cylinder, a + left * (b - a));
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = DistanceToPoint(cylinder, a + right * (b - a));
    }
  }
  return std::min({at_left, at_right, DistanceToPoint(cylinder, a), DistanceToPoint(cylinder, b)});
}

/// The point of the cylinder that is farthest along `direction`; the middle of the farthest points when there
/// are many.
Eigen::Vector3d FarthestAlong(const Cylinder& cylinder, const Eigen::Vector3d& direction) {
  constexpr double kTiny = 1e-9;
  Eigen::Vector3d point = cylinder.center_m;
  const double across = direction.head<2>().norm();
  if (across > kTiny) point.head<2>() += cylinder.radius_m / across * direction.head<2>();
  if (std::abs(direction.z()) > kTiny) point.z() += std::copysign(0.5 * cylinder.height_m, direction.z());
  return point;
}

/// Whether a point of the triangle's plane lies inside of it.
bool IsInside(const Eigen::Vector3d& point, const Eigen::Vector3d& normal, const Eigen::Vector3d& a,
              const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b - a).cross(point - a).dot(normal) >= 0.0 && (c - b).cross(point - b).dot(normal) >= 0.0 &&
         (a - c).cross(point - c).dot(normal) >= 0.0;
}

}  // namespace

// The nearest point lies on a side of the triangle, or it lies inside. Then the cylinder either crosses the
// plane there, and as no side crosses the cylinder any common point of plane and cylinder tells; or it stands
// beside the plane, and its point that is nearest to the plane has its foot inside the triangle.
double Distance(const Cylinder& cylinder, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                const Eigen::Vector3d& c) {
  const double at_sides = std::min({DistanceToSegment(cylinder, a, b), DistanceToSegment(cylinder, b, c),
                                    DistanceToSegment(cylinder, c, a)});
  const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
  if (at_sides == 0.0 || !(normal.squaredNorm() > 0.5)) return at_sides;
  const Eigen::Vector3d front = FarthestAlong(cylinder, normal), back = FarthestAlong(cylinder, -normal);
  const double front_m = normal.dot(front - a), back_m = normal.dot(back - a);
  if (front_m >= 0.0 && back_m <= 0.0) {
    const double span_m = front_m - back_m;
    const Eigen::Vector3d common = span_m > 0.0 ? (back - back_m / span_m * (front - back)).eval() : back;
    return IsInside(common, normal, a, b, c) ? 0.0 : at_sides;
  }
  const double plane_m = back_m > 0.0 ? back_m : front_m;
  const Eigen::Vector3d foot = (back_m > 0.0 ? back : front) - plane_m * normal;
  return IsInside(foot, normal, a, b, c) ? std::min(at_sides, std::abs(plane_m)) : at_sides;
}

struct Space::Index {
  std::vector<WorldBody> bodies;
  EmbreeScene scene;
};

namespace {

struct Search {
  const std::vector<WorldBody>* bodies;
  Cylinder cylinder;
  double reach_m;  ///< From the cylinder's centre to its farthest point.
  double distance_m;
  int body = -1;
};

bool Visit(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<Search*>(arguments->userPtr);
  const Mesh& mesh = (*search.bodies)[arguments->geomID].mesh_in_map;
  const auto& [a, b, c] = mesh.triangles[arguments->primID];
  const double distance_m =
      Distance(search.cylinder, mesh.vertices_m[a], mesh.vertices_m[b], mesh.vertices_m[c]);
  if (!(distance_m < search.distance_m)) return false;
  search.distance_m = distance_m;
  search.body = static_cast<int>(arguments->geomID);
  arguments->query->radius = static_cast<float>((distance_m + search.reach_m) * 1.0001 + 1e-4);
  return true;
}

}  // namespace

Space::Space(const World& world) : index_(std::make_unique<Index>()) {
  index_->bodies = BuildBodies(world);
  for (const WorldBody& body : index_->bodies) index_->scene.Add(body.mesh_in_map);
  index_->scene.Commit();
}
Space::~Space() = default;

Space::Nearest Space::DistanceToBodies(const Cylinder& cylinder, double limit_m) const {
  Search search{&index_->bodies, cylinder, std::hypot(cylinder.radius_m, 0.5 * cylinder.height_m), limit_m};
  RTCPointQuery query{};
  query.x = static_cast<float>(cylinder.center_m.x());
  query.y = static_cast<float>(cylinder.center_m.y());
  query.z = static_cast<float>(cylinder.center_m.z());
  query.radius = static_cast<float>(limit_m + search.reach_m + 1e-3);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(index_->scene.get(), &query, &context, &Visit, &search);
  return {search.distance_m, search.body < 0 ? "" : index_->bodies[search.body].owner};
}

Space::Nearest Space::DistanceTo(const Cylinder& cylinder, double limit_m) const {
  Nearest nearest = DistanceToBodies(cylinder, limit_m);
  const double ground_m = std::max(0.0, cylinder.center_m.z() - 0.5 * cylinder.height_m);
  if (ground_m < nearest.distance_m) return {ground_m, "ground"};
  return nearest;
}

bool Space::IsFreeAlong(Cylinder cylinder, const Eigen::Vector3d& end_m) const {
  constexpr double kLeastStep_m = 0.02, kMostStep_m = 0.5;
  const Eigen::Vector3d start_m = cylinder.center_m;
  if (!(std::min(start_m.z(), end_m.z()) > 0.5 * cylinder.height_m)) return false;
  const double length_m = (end_m - start_m).norm();
  for (double at_m = 0.0;; at_m = std::min(at_m, length_m)) {
    if (length_m > 0.0) cylinder.center_m = start_m + at_m / length_m * (end_m - start_m);
    const double free_m = DistanceToBodies(cylinder, kMostStep_m).distance_m;
    if (!(free_m > 0.0)) return false;
    if (at_m >= length_m) return true;
    at_m += std::max(free_m, kLeastStep_m);
  }
}

}  // namespace soffit::sim
