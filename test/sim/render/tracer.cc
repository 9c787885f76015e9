#include "test/sim/render/tracer.h"

#include <limits>

namespace soffit::sim {
namespace {

constexpr float kFar_m = std::numeric_limits<float>::infinity();

void Load(const RayPacket& rays, RTCRay16& out, std::array<int, kPacket>& valid) {
  for (int i = 0; i < kPacket; ++i) {
    valid[i] = i < rays.count ? -1 : 0;
    if (i >= rays.count) continue;
    out.org_x[i] = rays.origin_m[i].x();
    out.org_y[i] = rays.origin_m[i].y();
    out.org_z[i] = rays.origin_m[i].z();
    out.dir_x[i] = rays.direction[i].x();
    out.dir_y[i] = rays.direction[i].y();
    out.dir_z[i] = rays.direction[i].z();
    out.tnear[i] = 0.0F;
    out.tfar[i] = kFar_m;
    out.time[i] = 0.0F;
    out.mask[i] = ~0U;
    out.id[i] = 0;
    out.flags[i] = 0;
  }
}

}  // namespace

Tracer::Tracer(const std::vector<WorldBody>& bodies) {
  for (const WorldBody& body : bodies) scene_.Add(body.mesh_in_map);
  scene_.Commit();
}

std::array<RayHit, kPacket> Tracer::Trace(const RayPacket& rays) const {
  alignas(64) RTCRayHit16 packet;
  alignas(64) std::array<int, kPacket> valid;
  Load(rays, packet.ray, valid);
  for (int i = 0; i < kPacket; ++i) packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid.data(), scene_.get(), &context, &packet);

  std::array<RayHit, kPacket> hits;
  for (int i = 0; i < rays.count; ++i) {
    RayHit& hit = hits[i];
    const Eigen::Vector3f& direction = rays.direction[i];
    const float ground_m = direction.z() < 0.0F ? -rays.origin_m[i].z() / direction.z() : kFar_m;
    if (packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID && packet.ray.tfar[i] <= ground_m) {
      hit = {static_cast<int>(packet.hit.geomID[i]),
             static_cast<int>(packet.hit.primID[i]),
             packet.hit.u[i],
             packet.hit.v[i],
             packet.ray.tfar[i],
             Eigen::Vector3f(packet.hit.Ng_x[i], packet.hit.Ng_y[i], packet.hit.Ng_z[i]).normalized()};
      hit.is_inside = hit.normal.dot(direction) > 0.0F;
      if (hit.is_inside) hit.normal = -hit.normal;
    } else if (ground_m < kFar_m) {
      hit.body = RayHit::kGround;
      hit.distance_m = ground_m;
    }
  }
  return hits;
}

std::array<bool, kPacket> Tracer::IsBlocked(const RayPacket& rays) const {
  alignas(64) RTCRay16 packet;
  alignas(64) std::array<int, kPacket> valid;
  Load(rays, packet, valid);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded16(valid.data(), scene_.get(), &context, &packet);
  std::array<bool, kPacket> blocked{};
  for (int i = 0; i < rays.count; ++i) blocked[i] = packet.tfar[i] < 0.0F;
  return blocked;
}

}  // namespace soffit::sim
