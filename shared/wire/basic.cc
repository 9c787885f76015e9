#include "shared/wire/basic.h"

#include <algorithm>
#include <iterator>

namespace soffit {
namespace {

template <class Out, class In>
std::vector<Out> ConvertAll(const std::vector<In>& items, Out (*convert)(const In&)) {
  std::vector<Out> out;
  out.reserve(items.size());
  std::transform(items.begin(), items.end(), std::back_inserter(out), convert);
  return out;
}

}  // namespace

wire::Vector2 ToWire(const Eigen::Vector2d& v) {
  wire::Vector2 out;
  out.x(v.x());
  out.y(v.y());
  return out;
}

wire::Vector3 ToWire(const Eigen::Vector3d& v) {
  wire::Vector3 out;
  out.x(v.x());
  out.y(v.y());
  out.z(v.z());
  return out;
}

wire::Quaternion ToWire(const Eigen::Quaterniond& q) {
  wire::Quaternion out;
  out.x(q.x());
  out.y(q.y());
  out.z(q.z());
  out.w(q.w());
  return out;
}

wire::Ring ToWire(const Ring& ring) {
  wire::Ring out;
  out.corners_m(ConvertAll<wire::Vector2, Eigen::Vector2d>(ring, ToWire));
  return out;
}

wire::Polygon ToWire(const Polygon& polygon) {
  wire::Polygon out;
  out.outer(ToWire(polygon.outer));
  out.holes(ConvertAll<wire::Ring, Ring>(polygon.holes, ToWire));
  return out;
}

wire::VehicleEnvelope ToWire(const VehicleEnvelope& envelope) {
  wire::VehicleEnvelope out;
  out.radius_m(envelope.radius_m);
  out.height_m(envelope.height_m);
  out.safety_margin_m(envelope.safety_margin_m);
  return out;
}

wire::Purpose ToWire(Purpose purpose) { return static_cast<wire::Purpose>(purpose); }

std::vector<wire::Vector3> ToWire(const std::vector<Eigen::Vector3d>& points) {
  return ConvertAll<wire::Vector3, Eigen::Vector3d>(points, ToWire);
}

Eigen::Vector2d FromWire(const wire::Vector2& v) { return {v.x(), v.y()}; }
Eigen::Vector3d FromWire(const wire::Vector3& v) { return {v.x(), v.y(), v.z()}; }

Ring FromWire(const wire::Ring& ring) {
  return ConvertAll<Eigen::Vector2d, wire::Vector2>(ring.corners_m(), FromWire);
}

Polygon FromWire(const wire::Polygon& polygon) {
  return {FromWire(polygon.outer()), ConvertAll<Ring, wire::Ring>(polygon.holes(), FromWire)};
}

VehicleEnvelope FromWire(const wire::VehicleEnvelope& e) {
  return {e.radius_m(), e.height_m(), e.safety_margin_m()};
}

std::vector<Eigen::Vector3d> FromWire(const std::vector<wire::Vector3>& points) {
  return ConvertAll<Eigen::Vector3d, wire::Vector3>(points, FromWire);
}

}  // namespace soffit
