#include "service/edge/ros/ros_topics.h"

#include "service/edge/ros/camera_messages.h"
#include "service/edge/ros/frame_messages.h"
#include "service/edge/ros/marker_messages.h"
#include "service/edge/ros/octomap_message.h"
#include "service/edge/ros/path_message.h"

namespace soffit {
namespace {

constexpr std::size_t kMaxVehicles = 64;  ///< More are not shown: whoever invents vehicles fills no memory.

}  // namespace

struct RosTopics::Vehicle {
  Vehicle(const Participant& participant, const std::string& prefix)
      : pose(participant, prefix + "pose"),
        image(participant, prefix + "camera/image_raw/compressed"),
        camera(participant, prefix + "camera/camera_info"),
        waypoints(participant, prefix + "waypoints"),
        corridor(participant, prefix + "corridor"),
        scene(participant, prefix + "scene"),
        voxels(participant, prefix + "occupied_cells_vis_array"),
        binary_octomap(participant, prefix + "octomap_binary"),
        full_octomap(participant, prefix + "octomap_full") {}

  Writer<ros::PoseTopic> pose;
  Writer<ros::ImageTopic> image;
  Writer<ros::CameraTopic> camera;
  Writer<ros::PathTopic> waypoints;
  Writer<ros::PathTopic> corridor;
  Writer<ros::MarkersTopic> scene;
  Writer<ros::MarkersTopic> voxels;
  Writer<ros::OctomapTopic> binary_octomap;
  Writer<ros::OctomapTopic> full_octomap;
  std::optional<GeodeticOrigin> origin;
  std::vector<ros::TransformStamped_> object_frames;
};

RosTopics::RosTopics(const Participant& participant)
    : participant_(participant),
      transforms_(participant, "rt/tf"),
      static_transforms_(participant, "rt/tf_static") {}

RosTopics::~RosTopics() = default;

/// Null when there are too many of them.
RosTopics::Vehicle* RosTopics::FindOrMakeVehicle(std::uint32_t vehicle_id) {
  const auto known = vehicles_.find(vehicle_id);
  if (known != vehicles_.end()) return known->second.get();
  if (vehicles_.size() >= kMaxVehicles) return nullptr;
  const std::string prefix = "rt/soffit/" + ros::VehicleFrame(vehicle_id) + "/";
  return vehicles_.emplace(vehicle_id, std::make_unique<Vehicle>(participant_, prefix)).first->second.get();
}

void RosTopics::PublishState(const VehicleState& state) {
  const std::lock_guard lock(mutex_);
  Vehicle* vehicle = FindOrMakeVehicle(state.vehicle_id);
  if (vehicle == nullptr) return;
  vehicle->pose.Write(ros::MakePoseStamped(state));
  transforms_.Write(ros::MakeVehicleTransform(state));
  if (!vehicle->origin && state.origin) {
    vehicle->origin = state.origin;
    PublishStaticTransforms(state.stamp_utc_ns);
  }
}

void RosTopics::PublishCapture(const Capture& capture) {
  const std::lock_guard lock(mutex_);
  Vehicle* vehicle = FindOrMakeVehicle(capture.vehicle_id);
  if (vehicle == nullptr) return;
  transforms_.Write(ros::MakeCameraTransform(capture));
  vehicle->camera.Write(ros::MakeCameraInfo(capture));
  vehicle->image.Write(ros::MakeCompressedImage(capture));
}

void RosTopics::PublishWaypoints(std::uint32_t vehicle_id, std::int64_t stamp_utc_ns,
                                 const std::vector<Eigen::Vector3d>& path_in_map_m) {
  const std::lock_guard lock(mutex_);
  Vehicle* vehicle = FindOrMakeVehicle(vehicle_id);
  if (vehicle != nullptr) vehicle->waypoints.Write(ros::MakePath(stamp_utc_ns, path_in_map_m));
}

void RosTopics::PublishScene(std::uint32_t vehicle_id, std::int64_t stamp_utc_ns, const Scene& scene,
                             const std::vector<ClearanceDecision>& decisions) {
  static const octomap::OcTree kNothingKnown(SceneOptions().voxel_m);
  const octomap::OcTree& octree = scene.octree ? *scene.octree : kNothingKnown;
  const auto binary_octomap = ros::MakeBinaryOctomap(octree, stamp_utc_ns);
  const auto full_octomap = ros::MakeFullOctomap(octree, stamp_utc_ns);
  const auto voxels = ros::MakeVoxelMarkers(stamp_utc_ns, octree);
  const auto markers = ros::MakeSceneMarkers(stamp_utc_ns, scene, decisions);

  const std::lock_guard lock(mutex_);
  Vehicle* vehicle = FindOrMakeVehicle(vehicle_id);
  if (vehicle == nullptr) return;
  vehicle->corridor.Write(ros::MakeCorridorPath(stamp_utc_ns, decisions));
  vehicle->scene.Write(markers);
  vehicle->voxels.Write(voxels);
  vehicle->binary_octomap.Write(binary_octomap);
  vehicle->full_octomap.Write(full_octomap);
  vehicle->object_frames = ros::MakeObjectTransforms(stamp_utc_ns, vehicle_id, scene);
  PublishStaticTransforms(stamp_utc_ns);
}

/// All of them at once, as ROS 2's own broadcaster does: the newest message tells a late joiner everything.
void RosTopics::PublishStaticTransforms(std::int64_t stamp_utc_ns) {
  ros::TFMessage_ message;
  std::optional<GeodeticOrigin> origin;
  for (const auto& [id, vehicle] : vehicles_) {
    if (!origin) origin = vehicle->origin;
    message.transforms_().insert(message.transforms_().end(), vehicle->object_frames.begin(),
                                 vehicle->object_frames.end());
  }
  if (origin) message.transforms_().push_back(ros::MakeEarthTransform(stamp_utc_ns, *origin));
  static_transforms_.Write(message);
}

}  // namespace soffit
