#include "vehicle_agent/guard/guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace soffit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kNow_ns = 1'000'000'000'000;
constexpr std::int64_t kLater_ns = kNow_ns + 5'000'000'000;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

GuardContext Airborne() {
  GuardContext context;
  context.vehicle_id = 7;
  context.envelope = {0.35, 0.30, 0.25};
  context.phase = VehiclePhase::kHolding;
  context.is_in_air = true;
  context.position_in_map_m = {0.0, 0.0, 2.0};
  context.battery_ratio = 0.8;
  context.mission_id = 3;
  context.last_sequence = 4;
  context.old_missions = {1, 2};
  return context;
}

GuardContext Grounded() {
  GuardContext context = Airborne();
  context.phase = VehiclePhase::kOnGround;
  context.is_in_air = false;
  context.position_in_map_m.setZero();
  return context;
}

FlightCommand GoTo() {
  FlightCommand command;
  command.vehicle_id = 7;
  command.mission_id = 3;
  command.sequence = 5;
  command.valid_until_utc_ns = kLater_ns;
  command.kind = CommandKind::kGoTo;
  command.path_in_map_m = {{5.0, 0.0, 4.0}};
  command.speed_mps = 2.0;
  return command;
}

FlightCommand Look() {
  FlightCommand command = GoTo();
  command.kind = CommandKind::kLook;
  command.purpose = Purpose::kWall;
  command.capture_id = 9;
  return command;
}

FlightCommand TakeOff() {
  FlightCommand command = GoTo();
  command.kind = CommandKind::kTakeOff;
  command.path_in_map_m = {{0.0, 0.0, 9.0}};
  return command;
}

FlightCommand FlyCorridor() {
  FlightCommand command = GoTo();
  command.kind = CommandKind::kFlyCorridor;
  command.path_in_map_m = {{0.2, 0.0, 2.0}, {6.0, 0.0, 2.0}};
  command.speed_mps = 0.5;
  command.permit = CorridorPermit{11, 2, 6, kLater_ns, {0.35, 0.30, 0.25}, 1.65, 1.5};
  return command;
}

std::string Reason(const FlightCommand& command, const GuardContext& context,
                   const GuardOptions& options = {}) {
  return FindReasonToRefuse(command, context, options, kNow_ns);
}

TEST(FindReasonToRefuse, LetsGoodCommandsPass) {
  EXPECT_THAT(Reason(GoTo(), Airborne()), IsEmpty());
  EXPECT_THAT(Reason(Look(), Airborne()), IsEmpty());
  EXPECT_THAT(Reason(FlyCorridor(), Airborne()), IsEmpty());
  EXPECT_THAT(Reason(TakeOff(), Grounded()), IsEmpty());
  FlightCommand land = GoTo();
  land.kind = CommandKind::kLand;
  land.path_in_map_m.clear();
  EXPECT_THAT(Reason(land, Airborne()), IsEmpty());
}

TEST(FindReasonToRefuse, TakesAZeroCommandAsHold) {
  EXPECT_EQ(FlightCommand{}.kind, CommandKind::kHold);
  EXPECT_THAT(Reason(FlightCommand{}, Airborne()), IsEmpty());
}

TEST(FindReasonToRefuse, TakesHoldAndAbortEvenWhenStaleBusyOrNotReady) {
  GuardContext context = Airborne();
  context.is_busy = true;
  context.not_ready = "anything";
  context.battery_ratio = 0.0;
  FlightCommand abort;
  abort.kind = CommandKind::kAbort;
  EXPECT_THAT(Reason(abort, context), IsEmpty());
}

struct Refusal {
  const char* name;
  std::function<void(FlightCommand&, GuardContext&, GuardOptions&)> spoil;
  const char* said;
};

void PrintTo(const Refusal& refusal, std::ostream* out) { *out << refusal.name; }

using Command = FlightCommand;
using Context = GuardContext;
using Options = GuardOptions;

class Refuses : public ::testing::TestWithParam<Refusal> {};
std::string NameOf(const ::testing::TestParamInfo<Refusal>& info) { return info.param.name; }

class RefusesGoTo : public Refuses {};
TEST_P(RefusesGoTo, SayingWhy) {
  Command command = GoTo();
  Context context = Airborne();
  Options options;
  GetParam().spoil(command, context, options);
  EXPECT_THAT(Reason(command, context, options), HasSubstr(GetParam().said));
}
INSTANTIATE_TEST_SUITE_P(
    Guard, RefusesGoTo,
    ::testing::Values(
        Refusal{"Stale", [](Command& c, Context&, Options&) { c.valid_until_utc_ns = kNow_ns - 1; }, "stale"},
        Refusal{"UnknownKind", [](Command& c, Context&, Options&) { c.kind = static_cast<CommandKind>(99); },
                "unknown kind of command: 99"},
        Refusal{"NanSpeed", [](Command& c, Context&, Options&) { c.speed_mps = kNan; }, "not finite"},
        Refusal{"NanYaw", [](Command& c, Context&, Options&) { c.yaw_rad = kNan; }, "not finite"},
        Refusal{"InfinitePoint", [](Command& c, Context&, Options&) { c.path_in_map_m[0].z() = kInfinity; },
                "not finite"},
        Refusal{"NoPath", [](Command& c, Context&, Options&) { c.path_in_map_m.clear(); }, "path is empty"},
        Refusal{"NoSpeed", [](Command& c, Context&, Options&) { c.speed_mps = 0.0; }, "must be positive"},
        Refusal{"TooFast", [](Command& c, Context&, Options&) { c.speed_mps = 8.5; }, "too fast: 8.50 m/s"},
        Refusal{"AboveCeiling", [](Command& c, Context&, Options&) { c.path_in_map_m[0].z() = 61.0; },
                "ceiling"},
        Refusal{"BelowFloor", [](Command& c, Context&, Options&) { c.path_in_map_m[0].z() = -1.0; }, "floor"},
        Refusal{"TooFar", [](Command& c, Context&, Options&) { c.path_in_map_m[0].x() = 200.0; }, "too far"},
        Refusal{"TooLong",
                [](Command& c, Context&, Options& o) {
                  o.max_path_m = 20.0;
                  c.path_in_map_m = {{9.0, 0.0, 2.0}, {0.0, 0.0, 2.0}, {9.0, 0.0, 2.0}};
                },
                "longer than 20.00 m"},
        Refusal{"OutsideFence",
                [](Command&, Context&, Options& o) {
                  o.fence = {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};
                },
                "outside the geofence"},
        Refusal{"AcrossTheFencesNotch",
                [](Command& c, Context& k, Options& o) {
                  o.fence = {{-9, -9}, {9, -9}, {9, 9}, {1, 9}, {0, 0}, {-1, 9}, {-9, 9}};
                  k.position_in_map_m = {-5.0, 5.0, 2.0};
                  c.path_in_map_m = {{5.0, 5.0, 2.0}};
                },
                "outside the geofence"},
        Refusal{"LowBattery", [](Command&, Context& k, Options&) { k.battery_ratio = 0.2; },
                "battery is at 20.00 %"},
        Refusal{"PilotInControl",
                [](Command&, Context& k, Options&) { k.phase = VehiclePhase::kPilotInControl; }, "pilot"},
        Refusal{"NotReady", [](Command&, Context& k, Options&) { k.not_ready = "no 3D fix"; }, "no 3D fix"},
        Refusal{"OnGround", [](Command&, Context& k, Options&) { k.is_in_air = false; }, "on the ground"},
        Refusal{"Landing", [](Command&, Context& k, Options&) { k.phase = VehiclePhase::kLanding; },
                "landing"},
        Refusal{"Busy", [](Command&, Context& k, Options&) { k.is_busy = true; }, "another command"},
        Refusal{"InsideACorridor", [](Command&, Context& k, Options&) { k.is_in_corridor = true; },
                "inside a corridor"}),
    NameOf);

class RefusesTakeOff : public Refuses {};
TEST_P(RefusesTakeOff, SayingWhy) {
  Command command = TakeOff();
  Context context = Grounded();
  Options options;
  GetParam().spoil(command, context, options);
  EXPECT_THAT(Reason(command, context, options), HasSubstr(GetParam().said));
}
INSTANTIATE_TEST_SUITE_P(
    Guard, RefusesTakeOff,
    ::testing::Values(
        Refusal{"InTheAir", [](Command&, Context& k, Options&) { k.is_in_air = true; }, "in the air already"},
        Refusal{"WithoutHeight", [](Command& c, Context&, Options&) { c.path_in_map_m.clear(); },
                "one point"},
        Refusal{"TooLow", [](Command& c, Context&, Options&) { c.path_in_map_m[0].z() = 0.2; }, "less than"},
        Refusal{"NanHeight", [](Command& c, Context&, Options&) { c.path_in_map_m[0].z() = kNan; },
                "not finite"},
        Refusal{"TooHigh", [](Command& c, Context&, Options&) { c.path_in_map_m[0].z() = 99.0; }, "ceiling"}),
    NameOf);

class RefusesLook : public Refuses {};
TEST_P(RefusesLook, SayingWhy) {
  Command command = Look();
  Context context = Airborne();
  Options options;
  GetParam().spoil(command, context, options);
  EXPECT_THAT(Reason(command, context, options), HasSubstr(GetParam().said));
}
INSTANTIATE_TEST_SUITE_P(
    Guard, RefusesLook,
    ::testing::Values(
        Refusal{"WithoutCaptureId", [](Command& c, Context&, Options&) { c.capture_id = 0; }, "no id"},
        Refusal{"WithoutPurpose", [](Command& c, Context&, Options&) { c.purpose = Purpose::kUnknown; },
                "no purpose"},
        Refusal{"UnknownPurpose",
                [](Command& c, Context&, Options&) { c.purpose = static_cast<Purpose>(77); }, "no purpose"},
        Refusal{"WildPitch", [](Command& c, Context&, Options&) { c.camera_pitch_rad = 3.0; },
                "out of range"},
        Refusal{"WithoutCamera",
                [](Command&, Context& k, Options&) {
                  k.has_camera = false;
                  k.missing_cameras = {"down camera: no such device"};
                },
                "no camera for this look; down camera: no such device"}),
    NameOf);

class RefusesCorridor : public Refuses {};
TEST_P(RefusesCorridor, SayingWhy) {
  Command command = FlyCorridor();
  Context context = Airborne();
  Options options;
  GetParam().spoil(command, context, options);
  EXPECT_THAT(Reason(command, context, options), HasSubstr(GetParam().said));
}
INSTANTIATE_TEST_SUITE_P(
    Guard, RefusesCorridor,
    ::testing::Values(
        Refusal{"WithoutPermit", [](Command& c, Context&, Options&) { c.permit.reset(); }, "no permit"},
        Refusal{"DefaultPermit", [](Command& c, Context&, Options&) { c.permit = CorridorPermit{}; },
                "no decision"},
        Refusal{"ExpiredPermit",
                [](Command& c, Context&, Options&) { c.permit->valid_until_utc_ns = kNow_ns - 1; },
                "expired"},
        Refusal{"SmallerVehiclesPermit",
                [](Command& c, Context&, Options&) { c.permit->envelope.radius_m = 0.3; }, "another vehicle"},
        Refusal{"LesserMarginsPermit",
                [](Command& c, Context&, Options&) { c.permit->envelope.safety_margin_m = 0.2; },
                "another vehicle"},
        Refusal{"NanPermit", [](Command& c, Context&, Options&) { c.permit->envelope.height_m = kNan; },
                "another vehicle"},
        Refusal{"TooNarrow", [](Command& c, Context&, Options&) { c.permit->free_width_m = 1.19; },
                "needed are 1.20"},
        Refusal{"TooLow", [](Command& c, Context&, Options&) { c.permit->free_height_m = 0.79; },
                "needed are 0.80"},
        Refusal{"NanWidth", [](Command& c, Context&, Options&) { c.permit->free_width_m = kNan; }, "wide"},
        Refusal{"OldScene", [](Command&, Context& k, Options&) { k.newest_scene_revision = 7; },
                "scene revision 6"},
        Refusal{"TooFast", [](Command& c, Context&, Options&) { c.speed_mps = 1.5; }, "too fast"},
        Refusal{"WithoutExit", [](Command& c, Context&, Options&) { c.path_in_map_m.pop_back(); },
                "no entry and exit"},
        Refusal{"ExitAtEntry",
                [](Command& c, Context&, Options&) {
                  c.path_in_map_m[1] = {0.3, 0.0, 2.0};
                },
                "closer together"},
        Refusal{"Bent",
                [](Command& c, Context&, Options&) {
                  c.path_in_map_m.insert(c.path_in_map_m.begin() + 1, Eigen::Vector3d(3.0, 0.3, 2.0));
                },
                "not straight"},
        Refusal{"TurningBack",
                [](Command& c, Context&, Options&) {
                  c.path_in_map_m = {{0.2, 0.0, 2.0}, {4.0, 0.0, 2.0}, {2.0, 0.0, 2.0}, {6.0, 0.0, 2.0}};
                },
                "turns back"},
        Refusal{"Climbing", [](Command& c, Context&, Options&) { c.path_in_map_m[1].z() = 2.3; },
                "climbs by 0.30 m"},
        Refusal{"FarFromEntry",
                [](Command&, Context& k, Options&) {
                  k.position_in_map_m = {0.0, 3.0, 2.0};
                },
                "away from the corridor's entry"},
        Refusal{"InsideAnotherCorridor",
                [](Command&, Context& k, Options&) {
                  k.is_in_corridor = true;
                  k.position_in_map_m = {3.0, 3.0, 2.0};
                },
                "away from the corridor's path"}),
    NameOf);

TEST(FindReasonToRefuse, LetsACorridorBeGoneOnWithFromItsMiddle) {
  GuardContext context = Airborne();
  context.is_in_corridor = true;
  context.position_in_map_m = {3.0, 0.1, 2.0};
  EXPECT_THAT(Reason(FlyCorridor(), context), IsEmpty());
}

TEST(FindReasonToRefuse, LetsAVehicleThatIsOutsideTheFenceComeBack) {
  GuardOptions options;
  options.fence = {{-6, -6}, {6, -6}, {6, 6}, {-6, 6}};
  GuardContext context = Airborne();
  context.position_in_map_m = {8.0, 0.0, 2.0};
  EXPECT_THAT(Reason(GoTo(), context, options), IsEmpty());
}

struct Misaddressed {
  const char* name;
  std::function<void(FlightCommand&, GuardContext&)> spoil;
  const char* said;
};
void PrintTo(const Misaddressed& it, std::ostream* out) { *out << it.name; }

class FindAddressProblemRefuses : public ::testing::TestWithParam<Misaddressed> {};
TEST_P(FindAddressProblemRefuses, SayingWhy) {
  Command command = GoTo();
  Context context = Airborne();
  GetParam().spoil(command, context);
  EXPECT_THAT(FindAddressProblem(command, context), HasSubstr(GetParam().said));
}
INSTANTIATE_TEST_SUITE_P(
    Guard, FindAddressProblemRefuses,
    ::testing::Values(Misaddressed{"AnotherVehicle", [](Command& c, Context&) { c.vehicle_id = 8; },
                                   "is for vehicle 8, this is 7"},
                      Misaddressed{"OldMission", [](Command& c, Context&) { c.mission_id = 2; },
                                   "mission 2 is over"},
                      Misaddressed{"NoMission", [](Command& c, Context&) { c.mission_id = 0; }, "no mission"},
                      Misaddressed{"NoNumber", [](Command& c, Context&) { c.sequence = 0; }, "no number"},
                      Misaddressed{"Gap", [](Command& c, Context&) { c.sequence = 6; },
                                   "out of order: number 6, expected 5"},
                      Misaddressed{"Past", [](Command& c, Context&) { c.sequence = 3; },
                                   "out of order: number 3, expected 5"},
                      Misaddressed{"NewMissionWhileBusy",
                                   [](Command& c, Context& k) {
                                     c.mission_id = 4;
                                     k.is_busy = true;
                                   },
                                   "busy with mission 3"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(FindAddressProblem, TakesTheNextNumberANewMissionAndAnEarlyStop) {
  EXPECT_THAT(FindAddressProblem(GoTo(), Airborne()), IsEmpty());
  Command first = GoTo();
  first.mission_id = 4;
  first.sequence = 12;  // The agent may have been started in the middle of it.
  EXPECT_THAT(FindAddressProblem(first, Airborne()), IsEmpty());
  Command abort = GoTo();
  abort.kind = CommandKind::kAbort;
  abort.sequence = 9;
  EXPECT_THAT(FindAddressProblem(abort, Airborne()), IsEmpty());
}

Telemetry FlyingAt(const Eigen::Vector3d& position_m, const Eigen::Vector3d& velocity_mps = {0.0, 0.0, 0.0}) {
  Telemetry telemetry;
  telemetry.has_position = true;
  telemetry.position_in_map_m = position_m;
  telemetry.velocity_in_map_mps = velocity_mps;
  return telemetry;
}

TEST(FindBoundsProblem, SeesAVehicleThatLeftItsBounds) {
  GuardOptions options;
  options.max_speed_mps = 3.0;
  options.fence = {{-10.0, -10.0}, {10.0, -10.0}, {10.0, 10.0}, {-10.0, 10.0}};
  const auto find = [&](const Telemetry& telemetry, bool is_in_corridor = false) {
    return FindBoundsProblem(telemetry, is_in_corridor, options);
  };
  EXPECT_THAT(find(FlyingAt({0.0, 0.0, 5.0}, {3.0, 0.0, 0.0})), IsEmpty());
  EXPECT_THAT(find(FlyingAt({10.9, 0.0, 5.0})), IsEmpty());  // Within the slack.
  EXPECT_THAT(find(FlyingAt({0.0, 0.0, -1.0})), IsEmpty());  // Landing in a hollow.
  EXPECT_THAT(find(FlyingAt({11.1, 0.0, 5.0})), HasSubstr("outside the geofence"));
  EXPECT_THAT(find(FlyingAt({0.0, 0.0, 61.1})), HasSubstr("above the geofence's ceiling"));
  EXPECT_THAT(find(FlyingAt({0.0, 0.0, kNan})), HasSubstr("ceiling"));
  EXPECT_THAT(find(FlyingAt({0.0, 0.0, 5.0}, {4.6, 0.0, 0.0})), HasSubstr("too fast"));
  EXPECT_THAT(find(FlyingAt({0.0, 0.0, 5.0}, {1.6, 0.0, 0.0}), true), HasSubstr("too fast"));
  options.fence.clear();
  EXPECT_THAT(find(FlyingAt({151.1, 0.0, 5.0})), HasSubstr("too far"));
  EXPECT_THAT(find(Telemetry{}), IsEmpty());  // Not known: that is another failure.
}

}  // namespace
}  // namespace soffit
