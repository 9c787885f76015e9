#pragma once

#include <optional>
#include <vector>

#include "service/edge/ros/ros_types.h"
#include "service/scene/scene.h"
#include "shared/flight/flight.h"

namespace soffit::ros {

using geometry_msgs::msg::dds_::TransformStamped_;

TransformStamped_ MakeTransform(std::int64_t stamp_utc_ns, const std::string& parent,
                                const std::string& child, const Eigen::Vector3d& origin_m,
                                const Eigen::Quaterniond& rotation);

/// The vehicle's centre in the map: x forward, y left, z up, level.
PoseStamped_ MakePoseStamped(const VehicleState& state);
/// `map` to `vehicle_N/base_link`.
TFMessage_ MakeVehicleTransform(const VehicleState& state);

/// `earth` to `map`. The height above the sea is taken for that above the ellipsoid, so earth is off by the
/// geoid.
TransformStamped_ MakeEarthTransform(std::int64_t stamp_utc_ns, const GeodeticOrigin& origin);

/// `map` to `vehicle_N/object_M` for every building of the scene of that vehicle's mission: the centre of its
/// footprint on the ground; turned as the reference picture lies, if it is one that was looked for.
std::vector<TransformStamped_> MakeObjectTransforms(std::int64_t stamp_utc_ns, std::uint32_t vehicle_id,
                                                    const Scene& scene);

}  // namespace soffit::ros
