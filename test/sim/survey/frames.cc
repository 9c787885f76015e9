#include "test/sim/survey/frames.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "test/sim/world/space.h"

namespace soffit::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kFraming = 0.78;  // Share of the picture that an object fills.
constexpr double kDeg = std::numbers::pi / 180.0;

/// A building's box along its longest side.
struct Block {
  Vector2d center_m;
  double yaw_rad;   ///< Of the longest side.
  Vector2d size_m;  ///< Along and across it.
  double height_m;
};

Block FindBlock(const ObjectTruth& object) {
  const Ring& ring = object.footprint_in_map_m[0].outer;
  Vector2d longest = Vector2d::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
    if (side.norm() > longest.norm()) longest = side;
  }
  const Eigen::Rotation2Dd turn(-std::atan2(longest.y(), longest.x()));
  Vector2d low = Vector2d::Constant(1e9), high = -low;
  for (const Vector2d& corner : ring) {
    low = low.cwiseMin(turn * corner);
    high = high.cwiseMax(turn * corner);
  }
  return {turn.inverse() * ((low + high) / 2), -turn.angle(), high - low, object.height_m};
}

/// The best way under or through it leads from side 1 to side 3, or back.
bool LeadsAlong(const ObjectTruth& object) {
  if (object.passages.empty()) return false;
  const double yaw_rad = FindBlock(object).yaw_rad;
  const Vector2d longest(std::cos(yaw_rad), std::sin(yaw_rad));
  const Vector2d way = (object.passages[0].exit_m - object.passages[0].entry_m).head<2>();
  return std::abs(way.dot(longest)) > way.norm() * std::sqrt(0.5);
}

Pose<Map, Camera> Shake(const Pose<Map, Camera>& pose, double position_m, double angle_rad, Dice& dice) {
  const Vector3d turn(dice.Normal(), dice.Normal(), dice.Normal());
  const Eigen::Quaterniond rotation(Eigen::AngleAxisd(angle_rad * turn.norm(), turn.normalized()));
  return {(rotation * pose.rotation).normalized(),
          pose.translation_m + position_m * Vector3d(dice.Normal(), dice.Normal(), dice.Normal())};
}

class Planner {
 public:
  Planner(const World& world, Dice& dice) : world_(world), space_(world), dice_(dice) {}

  void AddOverview() {
    const Vector2d center = world_.mission.area_center_m;
    Add("overview", Purpose::kOverview, "", 0.0, {center.x(), center.y(), world_.mission.overview_altitude_m},
        DrawYaw(), -90 * kDeg);
  }

  void AddTop(const ObjectTruth& object) {
    const Block block = FindBlock(object);
    const Intrinsics& lens = world_.camera.intrinsics;
    const double reach_m = block.size_m.norm() / 2;
    const double fit_m = reach_m * lens.fx_px / (kFraming * 0.5 * lens.height_px);
    const double least_m = world_.mission.overview_altitude_m * 4.0 / 9.0;
    Add("top_" + std::to_string(tops_++), Purpose::kTop, object.id, 0.0,
        {block.center_m.x(), block.center_m.y(), std::max(block.height_m + fit_m, least_m)}, DrawYaw(),
        -90 * kDeg);
  }

  /// Side 0 is the front, along the longest side; 1, 2, 3 follow clockwise.
  void AddWall(const ObjectTruth& object, int side) {
    const Block block = FindBlock(object);
    const Intrinsics& lens = world_.camera.intrinsics;
    const double outward_rad = block.yaw_rad - std::numbers::pi / 2 + side * std::numbers::pi / 2;
    const double width_m = side % 2 == 0 ? block.size_m.x() : block.size_m.y();
    const double depth_m = side % 2 == 0 ? block.size_m.y() : block.size_m.x();
    const double look_m = std::max(0.5 * block.height_m, 1.5 * world_.vehicle.height_m);
    const double fit_m = std::max(width_m * lens.fx_px / (kFraming * lens.width_px),
                                  block.height_m * lens.fy_px / (kFraming * lens.height_px));
    const Vector2d outward(std::cos(outward_rad), std::sin(outward_rad));
    const Vector2d at = block.center_m + (depth_m / 2 + fit_m * dice_.Between(1.0, 1.1)) * outward;
    const Vector3d position(at.x(), at.y(), look_m);
    const double free_m = 2.0 * (world_.vehicle.radius_m + world_.vehicle.safety_margin_m);
    const bool is_free = space_.DistanceToBodies({position, 0.01, 0.01}, free_m).distance_m >= free_m;
    if (is_free)
      Add("wall_" + std::to_string(walls_++), Purpose::kWall, object.id, outward_rad, position,
          outward_rad + std::numbers::pi, 0.0);
  }

  std::vector<SurveyFrame> Take() { return std::move(frames_); }

 private:
  double DrawYaw() { return dice_.Between(-std::numbers::pi, std::numbers::pi); }

  void Add(const std::string& name, Purpose purpose, const std::string& object, double wall_yaw_rad,
           const Vector3d& position_m, double yaw_rad, double pitch_rad) {
    const double scale = world_.mission.overview_altitude_m / 9.0;
    SurveyFrame frame{name + ".jpg", purpose, object, wall_yaw_rad, {}, {}};
    frame.map_from_camera =
        Shake({CameraAttitude(yaw_rad, pitch_rad), position_m}, 0.06 * scale, 0.6 * kDeg, dice_);
    frame.reported = Shake(frame.map_from_camera, world_.pose_noise.position_std_m,
                           world_.pose_noise.orientation_std_rad, dice_);
    frames_.push_back(frame);
  }

  const World& world_;
  Space space_;
  Dice& dice_;
  std::vector<SurveyFrame> frames_;
  int tops_ = 0;
  int walls_ = 0;
};

}  // namespace

std::vector<SurveyFrame> PlanFrames(const World& world, const Truth& truth, Dice& dice) {
  Planner planner(world, dice);
  planner.AddOverview();
  bool has_other = false;
  for (const ObjectTruth& object : truth.objects) {
    const bool is_taken = object.is_wanted || !has_other;
    has_other = has_other || !object.is_wanted;
    if (is_taken && !object.is_absent) planner.AddTop(object);
  }
  for (const ObjectTruth& object : truth.objects) {
    if (!object.is_wanted || object.is_absent) continue;
    const bool has_left = dice.Chance(0.5) || LeadsAlong(object);
    for (const int side : {0, 1, 2}) planner.AddWall(object, side);
    if (has_left) planner.AddWall(object, 3);
  }
  return planner.Take();
}

}  // namespace soffit::sim
