#include "service/edge/export/flight_plan.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "service/edge/files/geodetic.h"

namespace soffit {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kWaypoint = 16;  // MAV_CMD
constexpr int kReturn = 20;
constexpr int kTakeOff = 22;
constexpr int kSpeed = 178;
constexpr int kRelativeFrame = 3;  // MAV_FRAME_GLOBAL_RELATIVE_ALT
constexpr int kMissionFrame = 2;   // MAV_FRAME_MISSION
constexpr double kTransit_mps = 5.0;
constexpr double kCorridor_mps = 0.6;
constexpr double kAbove_m = 3.0;
constexpr double kLowestTransit_m = 5.0;

class Plan {
 public:
  explicit Plan(const GeodeticOrigin& origin) : frame_(origin) {}

  void TakeOff(double height_m) { AddPlace(kTakeOff, {0, 0, height_m}, nullptr); }
  void FlyTo(const Eigen::Vector3d& place, double heading_deg) { AddPlace(kWaypoint, place, heading_deg); }
  void SetSpeed(double speed_mps) { Add(kSpeed, kMissionFrame, {1, speed_mps, -1, 0, 0, 0, 0}); }
  void Return() { Add(kReturn, kMissionFrame, {0, 0, 0, 0, 0, 0, 0}); }

  const Json& items() const { return items_; }

 private:
  void AddPlace(int command, const Eigen::Vector3d& place, const Json& heading_deg) {
    const GeodeticPoint p = frame_.Place(place);
    Add(command, kRelativeFrame, {0, 0, 0, heading_deg, p.latitude_deg, p.longitude_deg, place.z()});
    items_.back()["AMSLAltAboveTerrain"] = nullptr;
    items_.back()["Altitude"] = place.z();
    items_.back()["AltitudeMode"] = 1;
  }
  void Add(int command, int frame, const Json& params) {
    items_.push_back({{"type", "SimpleItem"},
                      {"autoContinue", true},
                      {"command", command},
                      {"doJumpId", items_.size() + 1},
                      {"frame", frame},
                      {"params", params}});
  }

  GeodeticFrame frame_;
  Json items_ = Json::array();
};

const ClearanceDecision* WidestClear(const std::vector<ClearanceDecision>& decisions) {
  const ClearanceDecision* widest = nullptr;
  for (const ClearanceDecision& decision : decisions) {
    if (decision.verdict != Verdict::kClear || !decision.corridor) continue;
    if (!widest || decision.corridor->free_width_m > widest->corridor->free_width_m) widest = &decision;
  }
  return widest;
}

double TransitHeight_m(const Scene& scene) {
  double highest_m = kLowestTransit_m - kAbove_m;
  for (const SceneObject& object : scene.objects)
    highest_m = std::max(highest_m, object.footprint.height_m + 3.0 * object.footprint.height_std_m);
  for (const Obstacle& obstacle : scene.obstacles)
    highest_m = std::max(highest_m, obstacle.base_in_map_m.z() + obstacle.height_m);
  return highest_m + kAbove_m;
}

}  // namespace

Result<std::string> ToFlightPlan(const Understanding& understanding,
                                 const std::optional<GeodeticOrigin>& origin) {
  if (!origin)
    return Error{Error::Code::kNotFound, "a plan is in WGS 84, and where the map lies is not known"};
  const ClearanceDecision* decision = WidestClear(understanding.decisions);
  if (!decision) return Error{Error::Code::kNotFound, "no corridor of the scene is CLEAR"};
  const Eigen::Vector3d entry = decision->corridor->entry_in_map_m;
  const Eigen::Vector3d exit = decision->corridor->exit_in_map_m;
  const double heading_deg =
      std::fmod(360.0 + std::atan2(exit.x() - entry.x(), exit.y() - entry.y()) * 180.0 / M_PI, 360.0);
  const double transit_m = TransitHeight_m(understanding.scene);

  Plan plan(*origin);
  plan.TakeOff(transit_m);
  plan.SetSpeed(kTransit_mps);
  plan.FlyTo({entry.x(), entry.y(), transit_m}, heading_deg);
  plan.FlyTo(entry, heading_deg);
  plan.SetSpeed(kCorridor_mps);
  plan.FlyTo(exit, heading_deg);
  plan.SetSpeed(kTransit_mps);
  plan.FlyTo({exit.x(), exit.y(), transit_m}, heading_deg);
  plan.Return();

  constexpr int kArduPilot = 3;
  constexpr int kQuadrotor = 2;
  const Json json = {
      {"fileType", "Plan"},
      {"version", 1},
      {"groundStation", "QGroundControl"},
      {"geoFence", {{"circles", Json::array()}, {"polygons", Json::array()}, {"version", 2}}},
      {"rallyPoints", {{"points", Json::array()}, {"version", 2}}},
      {"mission",
       {{"version", 2},
        {"firmwareType", kArduPilot},
        {"vehicleType", kQuadrotor},
        {"cruiseSpeed", kTransit_mps},
        {"hoverSpeed", kTransit_mps},
        {"globalPlanAltitudeMode", 1},
        {"plannedHomePosition", {origin->latitude_deg, origin->longitude_deg, origin->altitude_amsl_m}},
        {"items", plan.items()}}}};
  return json.dump(1) + "\n";
}

}  // namespace soffit
