#include "test/sim/flight/flight.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <thread>

#include "test/sim/autopilot/test_flight.h"

namespace soffit::sim {
namespace {

using namespace mavlink;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

/// An arch over the line x = 0, from y = 4 to y = 6: 2 m wide and 2 m high inside, and a tower at x = 6.
World ArchWorld(const std::string& more = "") {
  auto world = ParseWorld(R"(
camera: {width_px: 64, height_px: 48, fx_px: 40}
vehicle: {radius_m: 0.35, height_m: 0.30, safety_margin_m: 0.25}
mission: {wanted: [arch], area_center: [0, 5]}
buildings:
  - id: arch
    position: [0, 5]
    color: yellow
    parts:
      - {box: {center: [-1.5, 0], size: [1, 2]}, z: [0, 2]}
      - {box: {center: [1.5, 0], size: [1, 2]}, z: [0, 2]}
      - {box: {center: [0, 0], size: [4, 2]}, z: [2, 3]}
  - id: tower
    position: [6, 5]
    color: red
    parts:
      - {box: {center: [0, 0], size: [1, 1]}, z: [0, 8]}
)" + more,
                          "test", ".");
  if (!world.ok()) throw std::runtime_error(world.error().message);
  return std::move(world).value();
}

Truth ArchTruth() {
  Truth truth;
  ObjectTruth arch;
  arch.id = "arch";
  arch.is_wanted = true;
  arch.footprint_in_map_m = {{{{-2, 4}, {2, 4}, {2, 6}, {-2, 6}}, {}}};
  arch.height_m = 3.0;
  arch.passages = {{{0, 3, 1}, {0, 7, 1}, 2.0, 2.0, 1.6, true, 0.8}};
  truth.objects = {arch};
  return truth;
}

class FlightRecorderTest : public ::testing::Test {
 protected:
  /// Along a polyline, centimetre by centimetre.
  bool Fly(const std::vector<Eigen::Vector3d>& path) {
    bool is_well = true;
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const int steps = static_cast<int>(std::ceil((path[i + 1] - path[i]).norm() / 0.01));
      for (int k = 0; k <= steps; ++k, time_s_ += 0.01) {
        const Eigen::Vector3d position = path[i] + (path[i + 1] - path[i]) * (static_cast<double>(k) / steps);
        is_well = recorder_.Add({time_s_, position, position.z() <= 0.0, 0.5}) && is_well;
      }
    }
    return is_well;
  }

  const World world_ = ArchWorld();
  const Space space_{world_};
  const Truth truth_ = ArchTruth();
  FlightRecorder recorder_{world_, space_, truth_};
  double time_s_ = 0.0;
};

TEST_F(FlightRecorderTest, SeesAFlightThroughThePassage) {
  EXPECT_TRUE(Fly({{0, 0, 0}, {0, 0, 1}, {0.1, 8, 1}, {0, 8, 4}, {0, 0, 4}, {0, 0, 0}}));
  ASSERT_THAT(recorder_.flights_under(), SizeIs(1));
  const FlightUnder& flight = recorder_.flights_under()[0];
  EXPECT_EQ(flight.object, "arch");
  EXPECT_TRUE(flight.is_wanted);
  EXPECT_TRUE(flight.is_passable);
  EXPECT_NEAR(flight.entry_m.y(), 4.0, 0.02);
  EXPECT_NEAR(flight.exit_m.y(), 6.0, 0.02);
  EXPECT_NEAR(flight.least_distance_m, 0.575, 0.01);
  EXPECT_THAT(recorder_.contacts(), IsEmpty());
  const auto json = recorder_.ToJson();
  EXPECT_TRUE(json["passage_flown"]);
  EXPECT_TRUE(json["on_ground"]);
  EXPECT_NEAR(json["least_distance_m"], 0.575, 0.01);
}

TEST_F(FlightRecorderTest, DoesNotTakeAFlightOverTheRoofForOneUnderIt) {
  EXPECT_TRUE(Fly({{0, 0, 0}, {0, 0, 5}, {0, 8, 5}, {0, 0, 5}}));
  EXPECT_THAT(recorder_.flights_under(), IsEmpty());
  EXPECT_FALSE(recorder_.ToJson()["passage_flown"]);
}

TEST_F(FlightRecorderTest, DoesNotTakeALookInsideForAFlightThrough) {
  EXPECT_TRUE(Fly({{0, 0, 0}, {0, 0, 1}, {0, 5, 1}, {0, 0, 1}}));
  EXPECT_THAT(recorder_.flights_under(), IsEmpty());
}

TEST_F(FlightRecorderTest, RecordsEachContactOnceAndWithWhat) {
  EXPECT_FALSE(Fly({{0, 0, 0}, {0, 0, 1}, {0.8, 0, 1}, {0.8, 5, 1}, {0.8, 0, 1}, {6, 0, 4}, {6, 5, 4}}));
  ASSERT_THAT(recorder_.contacts(), SizeIs(2));
  EXPECT_EQ(recorder_.contacts()[0].with, "arch");
  EXPECT_EQ(recorder_.contacts()[1].with, "tower");
  EXPECT_NEAR(recorder_.contacts()[1].position_m.y(), 4.5 - 0.35, 0.03);
  EXPECT_EQ(recorder_.ToJson()["least_distance_m"], 0.0);
}

TEST_F(FlightRecorderTest, TakesAHardLandingForAContact) {
  recorder_.Add({0.0, {0, 0, 3}, false, 0.0});
  EXPECT_FALSE(recorder_.Add({0.5, {0, 0, 0}, true, 6.0}));
  ASSERT_THAT(recorder_.contacts(), SizeIs(1));
  EXPECT_EQ(recorder_.contacts()[0].with, "ground");
}

TEST_F(FlightRecorderTest, SaysNothingOfDistancesBeforeTheFlight) {
  EXPECT_TRUE(recorder_.Add({0.0, {0, 0, 0}, true, 0.0}));
  EXPECT_TRUE(recorder_.ToJson()["least_distance_m"].is_null());
  EXPECT_FALSE(recorder_.ToJson()["has_flown"]);
}

TEST(PoseHistory, InterpolatesAndKnowsNothingOfOtherTimes) {
  PoseHistory history;
  EXPECT_FALSE(history.At(kStart_ns).has_value());
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()));
  history.Add({kStart_ns, {0, 0, 0}, Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()});
  history.Add({kStart_ns + 10, {1, 2, 3}, turned, turned});
  const auto half = history.At(kStart_ns + 5);
  ASSERT_TRUE(half.has_value());
  EXPECT_NEAR(half->position_m.y(), 1.0, 1e-12);
  EXPECT_NEAR(YawOf(half->map_from_body), 0.5, 1e-12);
  EXPECT_FALSE(history.At(kStart_ns - 1).has_value());
  EXPECT_TRUE(history.At(kStart_ns + 50'000'000).has_value());
  EXPECT_FALSE(history.At(kStart_ns + 200'000'000).has_value());
}

TEST(PoseHistory, WaitsForAMomentThatIsStillToCome) {
  PoseHistory history;
  history.Add({kStart_ns, {0, 0, 0}, Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()});
  std::thread flight([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    history.Add(
        {kStart_ns + 10'000'000, {1, 0, 0}, Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()});
  });
  const auto pose = history.Await(kStart_ns + 5'000'000, std::chrono::seconds(10));
  flight.join();
  ASSERT_TRUE(pose.has_value());
  EXPECT_NEAR(pose->position_m.x(), 0.5, 1e-12);
  EXPECT_FALSE(history.Await(kStart_ns + 1'000'000'000, std::chrono::milliseconds(1)).has_value());
}

TEST(CameraPose, PointsTheFixedCamerasForwardAndDown) {
  const Eigen::Quaterniond north(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitZ()));
  const FlightPose pose{kStart_ns, {0, 0, 3}, north, Eigen::Quaterniond::Identity()};
  const auto forward = CameraPose(Mount::kForward, pose);
  const auto down = CameraPose(Mount::kDown, pose);
  EXPECT_TRUE((forward.rotation * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(0, 1, 0), 1e-9));
  EXPECT_TRUE((forward.rotation * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d(1, 0, 0), 1e-9));
  EXPECT_TRUE((down.rotation * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(0, 0, -1), 1e-9));
  EXPECT_TRUE(
      (down.rotation * -Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d(0, 1, 0), 1e-9));  // Top: ahead.
}

/// A simulated flight under a script, in simulated time.
class Script {
 public:
  explicit Script(Flight& flight) : flight_(flight) {}

  void Run(double seconds) {
    const std::int64_t end_ns = now_ns_ + static_cast<std::int64_t>(seconds * 1e9);
    for (; now_ns_ < end_ns; now_ns_ += 5'000'000) {
      flight_.Advance(now_ns_);
      for (const auto& packet : flight_.TakePackets()) {
        for (const Frame& frame : parser_.Feed(packet)) heard_(frame);
      }
    }
  }
  template <class Message>
  void Send(const Message& message) {
    for (const Frame& frame : sent_.Feed(encoder_.Encode(message))) flight_.Receive(frame, now_ns_);
  }
  void Command(std::uint16_t command, float param1 = 0, float param2 = 0, float param7 = 0) {
    CommandLong m;
    m.target_system = 1;
    m.command = command;
    m.param1 = param1;
    m.param2 = param2;
    m.param7 = param7;
    Send(m);
  }
  void GoTo(float north_m, float east_m, float down_m) {
    SetPositionTargetLocalNed m;
    m.target_system = 1;
    m.coordinate_frame = kFrameLocalNed;
    m.type_mask = kPositionAndYaw;
    m.x = north_m;
    m.y = east_m;
    m.z = down_m;
    Send(m);
  }
  void TakeOff(float height_m) {
    Run(3.5);
    Command(kCmdDoSetMode, 1, kCopterGuided);
    Command(kCmdComponentArmDisarm, 1);
    Command(kCmdNavTakeoff, 0, 0, height_m);
    Run(9.0);
  }
  void Hear(std::function<void(const Frame&)> heard) { heard_ = std::move(heard); }
  std::int64_t now_ns() const { return now_ns_; }

 private:
  Flight& flight_;
  Encoder encoder_{1, kComponentOnboardComputer};
  FrameParser sent_;
  FrameParser parser_;
  std::function<void(const Frame&)> heard_ = [](const Frame&) {};
  std::int64_t now_ns_ = kStart_ns;
};

SimulatedFlightOptions Quick(std::uint64_t seed = 0) {
  return {AutopilotKind::kArduPilot, true, seed, kStart_ns};
}

TEST(SimulatedFlight, FliesThroughTheArchOnCommand) {
  const World world = ArchWorld();
  const Space space(world);
  const auto flight = SimulateFlight(world, space, ArchTruth(), Quick());
  Script script(*flight);
  script.TakeOff(1.0F);
  script.GoTo(9, 0, -1);
  script.Run(8.0);
  script.Command(kCmdDoSetMode, 1, kCopterLand);
  script.Run(6.0);
  EXPECT_THAT(flight->recorder().contacts(), IsEmpty());
  EXPECT_THAT(flight->recorder().flights_under(), SizeIs(1));
  EXPECT_TRUE(flight->State()["landed"]);
  EXPECT_FALSE(flight->State()["armed"]);
}

TEST(SimulatedFlight, CrashesIntoWhatIsInTheWay) {
  const World world = ArchWorld();
  const Space space(world);
  const auto flight = SimulateFlight(world, space, ArchTruth(), Quick());
  Script script(*flight);
  script.TakeOff(2.5F);
  script.GoTo(9, 0, -2.5);
  script.Run(10.0);
  ASSERT_FALSE(flight->recorder().contacts().empty());
  EXPECT_EQ(flight->recorder().contacts()[0].with, "arch");
  EXPECT_FALSE(flight->State()["armed"]);
  EXPECT_TRUE(flight->recorder().ToJson()["on_ground"]);
  EXPECT_FALSE(flight->recorder().ToJson()["passage_flown"]);
}

TEST(SimulatedFlight, IsTheSameForTheSameSeed) {
  const World world =
      ArchWorld("wind: {mean_mps: [1, 0], gust_std_mps: 1}\npose_noise: {position_std_m: 0.05}\n");
  const Space space(world);
  const auto track = [&](std::uint64_t seed) {
    const auto flight = SimulateFlight(world, space, ArchTruth(), Quick(seed));
    Script script(*flight);
    script.TakeOff(3.0F);
    return flight->TrackLine();
  };
  EXPECT_EQ(track(1), track(1));
  EXPECT_NE(track(1), track(2));
}

TEST(SimulatedFlight, TakesDisturbancesAndRefusesNonsense) {
  const World world = ArchWorld();
  const Space space(world);
  const auto flight = SimulateFlight(world, space, ArchTruth(), Quick());
  for (const char* words :
       {"pilot LOITER", "gps off", "gps on", "radio off", "battery 0.1", "break", "reboot"}) {
    EXPECT_TRUE(flight->Disturb(words).ok()) << words;
  }
  for (const char* words :
       {"", "pilot", "pilot DANCE", "gps", "gps maybe", "battery", "battery 2", "battery nan", "fly"}) {
    const Status status = flight->Disturb(words);
    ASSERT_FALSE(status.ok()) << words;
    EXPECT_THAT(status.error().message, HasSubstr("none of"));
  }
}

TEST(FollowedFlight, TakesThePoseThatAnotherAutopilotReports) {
  const World world = ArchWorld();
  const Space space(world);
  const Truth truth = ArchTruth();
  const auto flown = SimulateFlight(world, space, truth, Quick());
  const auto followed = FollowFlight(world, space, truth);
  Script script(*flown);
  script.Hear([&](const Frame& frame) { followed->Receive(frame, script.now_ns()); });
  FrameParser wishes;
  const auto run = [&](double seconds) {
    for (double t = 0.0; t < seconds; t += 0.05) {
      script.Run(0.05);
      followed->Advance(script.now_ns());
      for (const auto& packet : followed->TakePackets()) {
        for (const Frame& frame : wishes.Feed(packet)) flown->Receive(frame, script.now_ns());
      }
    }
  };
  run(6.0);
  script.Command(kCmdDoSetMode, 1, kCopterGuided);
  script.Command(kCmdComponentArmDisarm, 1);
  script.Command(kCmdNavTakeoff, 0, 0, 1);
  run(9.0);
  script.GoTo(9, 0, -1);
  run(8.0);
  const auto pose = flown->poses().At(script.now_ns() - 100'000'000);
  const auto reported = followed->poses().At(script.now_ns() - 100'000'000);
  ASSERT_TRUE(pose && reported);
  EXPECT_LT((pose->position_m - reported->position_m).norm(), 0.05);
  EXPECT_LT(pose->map_from_body.angularDistance(reported->map_from_body), 0.02);
  EXPECT_THAT(followed->recorder().flights_under(), SizeIs(1));
  EXPECT_TRUE(followed->State()["armed"]);

  script.Command(kCmdDoSetMode, 1, kCopterLand);
  run(8.0);
  EXPECT_TRUE(followed->recorder().ToJson()["on_ground"]);
  EXPECT_FALSE(followed->Disturb("gps off").ok());
}

/// An autopilot of few words, and the one who follows it.
class Followed {
 public:
  template <class Message>
  void Say(const Message& message) {
    for (const Frame& frame : parser_.Feed(encoder_.Encode(message))) flight->Receive(frame, now_ns);
  }
  void SayPosition(float north_m, float east_m, float down_m) {
    Say(LocalPositionNed{.time_boot_ms = boot_ms, .x = north_m, .y = east_m, .z = down_m});
  }
  void Pass(std::int64_t ms, std::int64_t autopilot_ms) {
    now_ns += ms * 1'000'000;
    boot_ms += static_cast<std::uint32_t>(autopilot_ms);
  }
  /// The messages that it asks for now.
  std::vector<int> Asks() {
    std::vector<int> ids;
    flight->Advance(now_ns);
    for (const auto& packet : flight->TakePackets()) {
      for (const Frame& frame : parser_.Feed(packet)) {
        if (const auto m = Decode<CommandLong>(frame)) ids.push_back(static_cast<int>(m->param1));
      }
    }
    return ids;
  }

  const World world = ArchWorld();
  const Space space{world};
  const Truth truth = ArchTruth();
  const std::unique_ptr<Flight> flight = FollowFlight(world, space, truth);
  std::int64_t now_ns = kStart_ns;
  std::uint32_t boot_ms = 1000;

 private:
  Encoder encoder_{1, kComponentAutopilot};
  FrameParser parser_;
};

TEST(FollowedFlight, LaysTheWorldAboutTheFirstHomeWhereverTheLocalFrameBegins) {
  Followed followed;
  followed.SayPosition(0, 0, 0);
  EXPECT_FALSE(followed.flight->poses().At(kStart_ns).has_value());  // Nobody knows where that is.
  followed.Say(GpsGlobalOrigin{-353632610, 1491652300, 584000, 0});
  // Home as ArduPilot tells it: without its place in the local frame.
  HomePosition home;
  home.latitude = -353632610 + 1000;  // 11.1 m north of the origin,
  home.longitude = 1491652300 - 1000;
  home.altitude = 583'960;  // 4 cm below it.
  followed.Say(home);
  home.latitude += 5000;  // It is set anew when the vehicle arms.
  followed.Say(home);
  followed.Pass(20, 20);
  followed.SayPosition(11.1F, -9.1F, -2.0F);
  const auto pose = followed.flight->poses().At(followed.now_ns);
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT((pose->position_m - Eigen::Vector3d(0.0, 0.0, 2.04)).norm(), 0.05);
}

TEST(FollowedFlight, HasPosesOfThisMomentWhenTheAutopilotsClockRunsSlow) {
  Followed followed;
  followed.Say(GpsGlobalOrigin{-353632610, 1491652300, 584000, 0});
  followed.Say(HomePosition{.latitude = -353632610, .longitude = 1491652300, .altitude = 584000});
  for (int i = 0; i < 3000; ++i) {  // A minute in which the machine was too busy for 6 s of it.
    followed.Pass(20, 18);
    followed.SayPosition(0, 0, 0);
  }
  EXPECT_TRUE(followed.flight->poses().At(followed.now_ns - 400'000'000).has_value());
  EXPECT_FALSE(followed.flight->poses().At(followed.now_ns + 100'000'000).has_value());
}

TEST(FollowedFlight, AsksForWhatDoesNotComeOrComesTooSlowly) {
  Followed followed;
  EXPECT_THAT(followed.Asks(), IsEmpty());  // Nobody is there.
  followed.Say(Heartbeat{});
  EXPECT_THAT(followed.Asks(), SizeIs(6));
  followed.Pass(1000, 1000);
  EXPECT_THAT(followed.Asks(), IsEmpty());
  followed.Pass(1000, 1000);
  EXPECT_THAT(followed.Asks(), SizeIs(6));
  const auto listen = [&](int positions_hz) {
    for (int i = 0; i < 2 * positions_hz; ++i) {
      followed.Pass(1000 / positions_hz, 1000 / positions_hz);
      followed.SayPosition(0, 0, 0);
    }
    return followed.Asks();
  };
  EXPECT_THAT(listen(50), Not(::testing::Contains(static_cast<int>(LocalPositionNed::kId))));
  EXPECT_THAT(listen(4), ::testing::Contains(static_cast<int>(LocalPositionNed::kId)));
  EXPECT_THAT(listen(50), ::testing::Contains(static_cast<int>(HomePosition::kId)));
  followed.Say(HomePosition{});
  EXPECT_THAT(listen(50), Not(::testing::Contains(static_cast<int>(HomePosition::kId))));
}

TEST(SimulatedFlight, StreamsOnTheLinkThatAskedAndPassesHeartbeatsOn) {
  const World world = ArchWorld();
  const Space space(world);
  SimulatedFlightOptions options = Quick();
  options.link_count = 2;
  const auto flight = SimulateFlight(world, space, ArchTruth(), options);
  Encoder companion(1, kComponentOnboardComputer);
  FrameParser parser;
  CommandLong ask{.param1 = Attitude::kId, .param2 = 20'000, .command = kCmdSetMessageInterval};
  ask.target_system = 1;
  for (const Frame& frame : parser.Feed(companion.Encode(ask))) flight->Receive(frame, kStart_ns, 1);
  for (const Frame& frame : parser.Feed(companion.Encode(Heartbeat{}))) flight->Receive(frame, kStart_ns, 1);
  flight->Advance(kStart_ns + 1'500'000'000);
  const auto count = [&](std::size_t link, std::uint32_t id, std::uint8_t component) {
    int found = 0;
    for (const auto& packet : flight->TakePackets(link)) {
      for (const Frame& frame : parser.Feed(packet))
        found += frame.message_id == id && frame.component_id == component;
    }
    return found;
  };
  EXPECT_GT(count(1, Attitude::kId, kComponentAutopilot), 70);
  flight->Advance(kStart_ns + 2'500'000'000);
  EXPECT_EQ(count(1, Heartbeat::kId, kComponentAutopilot), 1);
  EXPECT_EQ(count(0, Heartbeat::kId, kComponentOnboardComputer), 1);
  flight->Advance(kStart_ns + 4'500'000'000);
  EXPECT_EQ(count(0, Attitude::kId, kComponentAutopilot), 0);
}

}  // namespace
}  // namespace soffit::sim
