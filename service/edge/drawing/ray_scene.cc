#include "service/edge/drawing/ray_scene.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <stdexcept>

namespace soffit {

struct RayScene::Embree {
  RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  RTCScene scene = device != nullptr ? rtcNewScene(device) : nullptr;
  ~Embree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

RayScene::RayScene() : embree_(std::make_unique<Embree>()) {
  if (embree_->scene == nullptr) throw std::runtime_error("Embree does not start on this machine");
}

RayScene::~RayScene() = default;

void RayScene::AddMesh(const Mesh& mesh, const cv::Vec3f& color) {
  if (mesh.triangles.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices =
      static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                  3 * sizeof(float), mesh.vertices_in_map_m.size()));
  for (const Eigen::Vector3d& vertex : mesh.vertices_in_map_m) {
    for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(vertex[i]);
  }
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) *indices++ = static_cast<unsigned>(index);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(embree_->scene, geometry, static_cast<unsigned>(colors_.size()));
  rtcReleaseGeometry(geometry);
  colors_.push_back(color);
}

void RayScene::AddBox(const Eigen::Vector3d& center, double edge_m, const cv::Vec3f& color) {
  Mesh box;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    box.vertices_in_map_m.push_back(center + edge_m * corner);
  }
  box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  AddMesh(box, color);
}

void RayScene::AddTube(const std::vector<Eigen::Vector3d>& line, double radius_m, const cv::Vec3f& color) {
  if (line.size() < 2) return;
  RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), line.size()));
  for (const Eigen::Vector3d& point : line) {
    for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(point[i]);
    *vertices++ = static_cast<float>(radius_m);
  }
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof(unsigned), line.size() - 1));
  for (std::size_t i = 0; i + 1 < line.size(); ++i) *indices++ = static_cast<unsigned>(i);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(embree_->scene, geometry, static_cast<unsigned>(colors_.size()));
  rtcReleaseGeometry(geometry);
  colors_.push_back(color);
}

void RayScene::Commit() { rtcCommitScene(embree_->scene); }

namespace {

RTCRay MakeRay(const Eigen::Vector3d& from, const Eigen::Vector3d& direction, double distance_m) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(from.x());
  ray.org_y = static_cast<float>(from.y());
  ray.org_z = static_cast<float>(from.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tfar = static_cast<float>(distance_m);
  ray.mask = ~0U;
  return ray;
}

}  // namespace

std::optional<RayScene::Hit> RayScene::Cast(const Eigen::Vector3d& from,
                                            const Eigen::Vector3d& direction) const {
  RTCRayHit ray{};
  ray.ray = MakeRay(from, direction, std::numeric_limits<float>::infinity());
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(embree_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  Eigen::Vector3d normal(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
  normal.normalize();
  if (normal.dot(direction) > 0.0) normal = -normal;
  return Hit{ray.ray.tfar, normal, colors_.at(ray.hit.geomID)};
}

bool RayScene::IsBlocked(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
                         double distance_m) const {
  RTCRay ray = MakeRay(from, direction, distance_m);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar < 0.0F;
}

}  // namespace soffit
