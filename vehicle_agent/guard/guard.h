#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/flight/flight.h"
#include "shared/options/options.h"
#include "vehicle_agent/vehicle/vehicle.h"

namespace soffit {

struct FenceCorner {
  double east_m = 0.0;
  double north_m = 0.0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("east_m", self.east_m, OptionInfo{-1e5, 1e5, "m", "In the map, from home"});
    field("north_m", self.north_m, OptionInfo{-1e5, 1e5, "m", ""});
  }
};

struct GuardOptions {
  double max_speed_mps = 8.0;
  double max_corridor_speed_mps = 1.0;
  double max_distance_m = 150.0;
  double max_path_m = 1000.0;
  double floor_m = 0.3;
  double ceiling_m = 60.0;
  double min_battery_ratio = 0.25;
  double corridor_join_m = 1.5;
  double corridor_climb_m = 0.05;
  double bounds_slack_m = 1.0;
  double overspeed_ratio = 1.5;
  std::vector<FenceCorner> fence;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("max_speed_mps", self.max_speed_mps, OptionInfo{0.1, 30.0, "m/s", "Faster commands are refused"});
    field("max_corridor_speed_mps", self.max_corridor_speed_mps,
          OptionInfo{0.1, 10.0, "m/s", "The same, inside a corridor"});
    field("max_distance_m", self.max_distance_m, OptionInfo{1.0, 1e5, "m", "From home, over the ground"});
    field("max_path_m", self.max_path_m, OptionInfo{1.0, 1e6, "m", "Length of one command's path"});
    field("floor_m", self.floor_m, OptionInfo{0.0, 100.0, "m", "Lowest height of a path over home"});
    field("ceiling_m", self.ceiling_m, OptionInfo{1.0, 1e4, "m", "Greatest height of a path over home"});
    field("min_battery_ratio", self.min_battery_ratio,
          OptionInfo{0.0, 0.95, "",
                     "Below: nothing but hold, land and abort is taken, and the vehicle returns"});
    field(
        "corridor_join_m", self.corridor_join_m,
        OptionInfo{0.1, 10.0, "m", "Greatest distance from the vehicle to a corridor that it is sent into"});
    field("corridor_climb_m", self.corridor_climb_m,
          OptionInfo{0.0, 1.0, "m", "Greatest climb along a corridor: never climb under a soffit"});
    field(
        "bounds_slack_m", self.bounds_slack_m,
        OptionInfo{0.0, 20.0, "m", "So far outside fence, ceiling or distance the vehicle is out of bounds"});
    field("overspeed_ratio", self.overspeed_ratio,
          OptionInfo{1.0, 10.0, "", "So many times its speed limit the vehicle is out of bounds"});
    field("fence", self.fence);
  }
};

/// What the guard has to know of the vehicle to judge a command.
struct GuardContext {
  std::uint32_t vehicle_id = 0;
  VehicleEnvelope envelope;
  VehiclePhase phase = VehiclePhase::kNotReady;
  std::string not_ready;  ///< Why it is not ready; empty: it is.
  bool is_in_air = false;
  bool is_in_corridor = false;
  bool is_busy = false;  ///< A command is being carried out.
  Eigen::Vector3d position_in_map_m = Eigen::Vector3d::Zero();
  double battery_ratio = -1.0;      ///< Negative: not known.
  std::uint64_t mission_id = 0;     ///< The mission that is flown; 0: none yet.
  std::uint32_t last_sequence = 0;  ///< Of that mission; 0: none yet.
  std::vector<std::uint64_t> old_missions;
  std::uint64_t newest_scene_revision = 0;   ///< Of all permits that were seen in this mission.
  std::vector<std::string> missing_cameras;  ///< Problems of the cameras that do not work, for people.
  bool has_camera = true;                    ///< The camera that a kLook of this command would use works.
};

/// Hold and abort: what makes the vehicle safer is asked fewer questions.
bool IsStopping(CommandKind kind);

/// Why a command is not the next one of the mission for this vehicle, in words; empty: it is. Such a command
/// is refused and forgotten: it does not use up its sequence number.
std::string FindAddressProblem(const FlightCommand& command, const GuardContext& context);

/// Why a well-addressed command must not be carried out, in words with numbers; empty: it may. Whatever is
/// NaN, unknown or out of range is refused. Pure.
std::string FindReasonToRefuse(const FlightCommand& command, const GuardContext& context,
                               const GuardOptions& options, std::int64_t now_utc_ns);

/// Why a permit must not be used now, in words; empty: it may.
std::string FindPermitProblem(const CorridorPermit& permit, const VehicleEnvelope& own,
                              std::uint64_t newest_scene_revision, std::int64_t now_utc_ns);

/// How a vehicle in flight is outside its bounds or too fast for them, in words; empty: it is not, or its
/// position is not known. The floor is not looked at: vehicles take off and land.
std::string FindBoundsProblem(const Telemetry& telemetry, bool is_in_corridor, const GuardOptions& options);

}  // namespace soffit
