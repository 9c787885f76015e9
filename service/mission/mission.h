#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "service/clearance/clearance.h"
#include "service/viewpoint/viewpoint.h"
#include "shared/flight/flight.h"
#include "shared/options/options.h"

namespace soffit {

enum class MissionState { kNone, kWaiting, kFlying, kPaused, kReturning, kEnded };
enum class MissionStep {
  kNone,
  kWaitForVehicle,
  kTakeOff,
  kOverview,
  kRecognize,
  kTop,
  kWalls,
  kDecide,
  kLookAgain,  ///< At what would settle an open decision, or along the corridor that is to be flown.
  kEnter,
  kReturn,
  kLand,
  kDone,
};
enum class MissionOutcome {
  kNone,
  kFlown,
  kBlocked,
  kInsufficientData,
  kNoMatch,
  kAmbiguous,
  kAborted,
  kFailed
};
const char* ToString(MissionState state);
const char* ToString(MissionStep step);
const char* ToString(MissionOutcome outcome);

struct MissionOptions {
  double area_radius_m = 0.0;
  double transit_clearance_m = 1.5;
  double transit_speed_mps = 5.0;
  double corridor_speed_mps = 0.6;
  double permit_valid_s = 120.0;
  double state_timeout_s = 2.0;
  double vehicle_lost_s = 60.0;
  double resend_s = 1.0;
  double answer_timeout_s = 20.0;
  double picture_timeout_s = 30.0;
  double retry_delay_s = 2.0;
  int tries = 3;
  int more_views = 10;
  int candidate_views = 8;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("area_radius_m", self.area_radius_m,
          OptionInfo{0, 500, "m", "Of the disc that the overview has to show, where the request gives none"});
    field("transit_clearance_m", self.transit_clearance_m,
          OptionInfo{0.5, 50, "m", "Transits are so far above everything known, beside the envelope"});
    field("transit_speed_mps", self.transit_speed_mps, OptionInfo{0.1, 20, "m/s", "Between viewpoints"});
    field("corridor_speed_mps", self.corridor_speed_mps,
          OptionInfo{0.1, 5, "m/s", "Under or through the building"});
    field("permit_valid_s", self.permit_valid_s,
          OptionInfo{5, 3600, "s", "A decision gives leave to enter for so long"});
    field("state_timeout_s", self.state_timeout_s,
          OptionInfo{0.5, 60, "s", "A vehicle that is silent for so long is commanded nothing"});
    field("vehicle_lost_s", self.vehicle_lost_s,
          OptionInfo{1, 3600, "s", "A vehicle that is silent for so long ends the mission"});
    field("resend_s", self.resend_s,
          OptionInfo{0.1, 60, "s", "An unanswered command is sent again after so long"});
    field("answer_timeout_s", self.answer_timeout_s,
          OptionInfo{1, 600, "s", "An unanswered command is given up after so long"});
    field("picture_timeout_s", self.picture_timeout_s,
          OptionInfo{1, 600, "s", "A picture that was taken has to arrive within so long"});
    field("retry_delay_s", self.retry_delay_s,
          OptionInfo{0, 60, "s", "Before a refused or failed command is tried again"});
    field("tries", self.tries, OptionInfo{1, 20, "", "Of a command or a picture, before it is given up"});
    field("more_views", self.more_views,
          OptionInfo{0, 50, "", "Pictures that open decisions may ask for, for each building"});
    field(
        "candidate_views", self.candidate_views,
        OptionInfo{0, 100, "",
                   "Pictures from straight above each building, when overviews do not tell the wanted one"});
  }
};

/// What a mission is to do.
struct MissionOrder {
  std::uint32_t vehicle_id = 0;
  std::uint64_t mission_id = 0;  ///< Unique for ever.
  Eigen::Vector2d area_center_in_map_m = Eigen::Vector2d::Zero();
  double area_radius_m = 0.0;  ///< 0: that of the options.
};

/// What a mission has to know of the scene. Made from the Understanding of all pictures that had arrived.
struct Findings {
  std::uint64_t scene_revision = 0;
  std::vector<Footprint> map;  ///< The vector map as adjusted to the models; obstacles too, without an id.
  std::vector<std::uint32_t> wanted;  ///< Ids of the recognized building or group; empty: none or several.
  bool is_ambiguous = false;
  std::vector<ClearanceDecision> decisions;
  std::vector<std::string> problems;
  std::string failure;  ///< Not empty: nothing could be made of the pictures, the rest means nothing.
};

/// What happened. A default `Tick` only lets time pass.
struct Tick {};
struct PictureResult {
  std::uint32_t capture_id = 0;
  std::string problem;  ///< Empty: it can be used.
};
enum class OperatorWish { kNone, kPause, kResume, kAbort };
using MissionEvent = std::variant<Tick, VehicleState, CommandAck, PictureResult, Findings, OperatorWish>;

/// Where a mission stands, for anyone to see.
struct MissionStatus {
  MissionState state = MissionState::kNone;
  MissionStep step = MissionStep::kNone;
  MissionOutcome outcome = MissionOutcome::kNone;  ///< Set when ended.
  double step_progress_ratio = 0.0;
  double progress_ratio = 0.0;
  std::string message;                ///< One line for people: what it does, why it ended.
  std::vector<std::string> problems;  ///< What went wrong without ending it: the latest 32, newest last.
  std::uint32_t object_id = 0;        ///< The building that is looked at; 0: none yet.
};

/// What the vehicle was told last, and how far that is. Answered is accepted, ended is done.
struct Errand {
  FlightCommand command;
  bool is_answered = false;
  bool is_ended = false;          ///< Of a look: only its picture is still awaited.
  std::int64_t sent_utc_ns = 0;   ///< The last time.
  std::int64_t since_utc_ns = 0;  ///< When it was issued, answered or ended, whichever came last.
  double start_distance_m = 0.0;  ///< From the vehicle to the end of the path when it was issued.
  double longest_s = 0.0;         ///< From its acceptance; by then it has to be done.
};

/// A mission under way. A plain value: copying it copies the mission.
struct Mission {
  MissionOrder order;
  MissionStatus status;

  std::optional<VehicleState> vehicle;  ///< Newest state of the agent that is commanded.
  std::int64_t heard_utc_ns = 0;        ///< When it arrived.
  std::int64_t landed_utc_ns = 0;  ///< Since when in this step it stands disarmed on the ground; 0: it flies.
  std::int64_t intruder_utc_ns = 0;  ///< When another agent with the same vehicle id was heard; 0: never.

  std::optional<Errand> errand;          ///< What is waited for.
  bool is_waiting_for_findings = false;  ///< Or this.
  std::int64_t retry_utc_ns = 0;         ///< Or this moment.
  int failures = 0;                      ///< Of what is being tried now.
  bool has_overrun = false;  ///< The vehicle may be busy with, or have missed, a command: stop it first.
  std::uint32_t last_sequence = 0;
  std::uint32_t last_capture_id = 0;
  std::vector<PictureResult> pictures;  ///< That have arrived.

  std::optional<Findings> findings;
  std::int64_t findings_utc_ns = 0;
  std::vector<std::uint32_t> settled;  ///< Wanted buildings that there is no way through.
  std::vector<std::string> settled_reasons;
  bool is_any_unsettled = false;  ///< One of them for lack of evidence.
  std::vector<Viewpoint> views;   ///< Still to be looked at in this step, next first.
  std::size_t views_planned = 0;
  std::vector<Viewpoint> viewed;       ///< Looked at so far.
  std::uint32_t looked_around_id = 0;  ///< The building whose surroundings were looked at from above.
  int more_views_used = 0;
  std::vector<Eigen::Vector3d> looked_along;  ///< Places from which corridors were looked along.
  std::optional<ClearanceDecision> leave;     ///< The decision whose corridor is looked along or flown.
  bool is_at_entry = false;
  bool is_in_corridor = false;                     ///< From the moment that the vehicle accepted to fly it.
  MissionOutcome outcome = MissionOutcome::kNone;  ///< What it will end with.
  std::string reason;
};

/// A mission that was interrupted for a while, made ready to go on where it was: its vehicle counts as silent
/// until it is heard again, and what it was told last is said once more, with its number.
Mission ContinueMission(Mission mission, std::int64_t now_utc_ns, const MissionOptions& options);

struct MissionUpdate {
  Mission mission;
  std::vector<FlightCommand> commands;  ///< To be sent now, in this order.
  bool wants_findings = false;  ///< Understand all pictures that have arrived, then say so with `Findings`.
};

Mission StartMission(const MissionOrder& order);

/// Lets a mission go on by one event. Pure: time is an argument, the caller sends and understands.
///
/// Order: wait for a vehicle that is ready, take off, overview, recognize, then for each wanted building:
/// picture from above, walls, decide. CLEAR: look along the corridor, decide again with that picture, fly it,
/// come home, land. INSUFFICIENT_DATA: look where the decision wants to, a bounded number of times. BLOCKED:
/// the next building, or home. Whatever the end, the reason is in the status.
///
/// It never commands a vehicle that is silent, not the agent's it started with (a second agent with the same
/// id is told as a problem), or flown by its pilot. A corridor is entered only with a CLEAR decision of the
/// newest scene revision for the envelope that the vehicle itself states. An unanswered command is sent again
/// with its number.
///
/// @param event  Findings and acknowledgements that were not asked for are ignored.
MissionUpdate Advance(Mission mission, const MissionEvent& event, std::int64_t now_utc_ns,
                      const ViewpointOptions& viewpoints, const MissionOptions& options);

}  // namespace soffit
