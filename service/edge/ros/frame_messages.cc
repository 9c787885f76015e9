#include "service/edge/ros/frame_messages.h"

#include <GeographicLib/LocalCartesian.hpp>

namespace soffit::ros {

TransformStamped_ MakeTransform(std::int64_t stamp_utc_ns, const std::string& parent,
                                const std::string& child, const Eigen::Vector3d& origin_m,
                                const Eigen::Quaterniond& rotation) {
  TransformStamped_ transform;
  transform.header_(MakeHeader(stamp_utc_ns, parent));
  transform.child_frame_id_(child);
  transform.transform_().translation_(MakeVector(origin_m));
  transform.transform_().rotation_(MakeQuaternion(rotation));
  return transform;
}

PoseStamped_ MakePoseStamped(const VehicleState& state) {
  PoseStamped_ pose;
  pose.header_(MakeHeader(state.stamp_utc_ns, kMapFrame));
  pose.pose_(MakePose(state.position_in_map_m, Heading(state.yaw_rad)));
  return pose;
}

TFMessage_ MakeVehicleTransform(const VehicleState& state) {
  TFMessage_ message;
  message.transforms_(
      {MakeTransform(state.stamp_utc_ns, kMapFrame, VehicleFrame(state.vehicle_id, "base_link"),
                     state.position_in_map_m, Heading(state.yaw_rad))});
  return message;
}

TransformStamped_ MakeEarthTransform(std::int64_t stamp_utc_ns, const GeodeticOrigin& origin) {
  const GeographicLib::Geocentric& wgs84 = GeographicLib::Geocentric::WGS84();
  Eigen::Vector3d in_earth_m;
  std::vector<double> earth_from_enu(9);  // Row-major.
  wgs84.Forward(origin.latitude_deg, origin.longitude_deg, origin.altitude_amsl_m, in_earth_m.x(),
                in_earth_m.y(), in_earth_m.z(), earth_from_enu);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(earth_from_enu.data());
  return MakeTransform(stamp_utc_ns, kEarthFrame, kMapFrame, in_earth_m,
                       Eigen::Quaterniond(Eigen::Matrix3d(rotation)));
}

std::vector<TransformStamped_> MakeObjectTransforms(std::int64_t stamp_utc_ns, std::uint32_t vehicle_id,
                                                    const Scene& scene) {
  std::vector<TransformStamped_> transforms;
  for (const SceneObject& object : scene.objects) {
    const Eigen::Vector2d center_m = Centroid(object.footprint.polygon_in_map_m);
    const double yaw_rad = object.is_matched ? -object.match.rotation_cw_rad : 0.0;
    transforms.push_back(
        MakeTransform(stamp_utc_ns, kMapFrame,
                      VehicleFrame(vehicle_id, "object_" + std::to_string(object.footprint.object_id)),
                      {center_m.x(), center_m.y(), 0.0}, Heading(yaw_rad)));
  }
  return transforms;
}

}  // namespace soffit::ros
