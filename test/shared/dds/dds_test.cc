#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>

#include "shared/dds/reader.h"
#include "shared/dds/writer.h"
#include "shared/wire/topics.h"

namespace soffit {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Values that arrive on another thread.
template <class T>
class Inbox {
 public:
  void Put(T value) {
    {
      const std::lock_guard lock(mutex_);
      items_.push_back(std::move(value));
    }
    changed_.notify_all();
  }
  /// Everything so far, once there are `count` of them, or after `timeout`.
  std::vector<T> Await(std::size_t count, std::chrono::milliseconds timeout = 5s) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [&] { return items_.size() >= count; });
    return items_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<T> items_;
};

/// Two participants on loopback, in a domain that other test programs are not likely to use.
class Dds : public testing::Test {
 protected:
  static DdsOptions Loopback() {
    DdsOptions options;
    options.domain_id = 100 + static_cast<int>(getpid() % 100);
    options.udp_only = true;
    options.interfaces = {"127.0.0.1"};
    return options;
  }
  Participant Join(const char* name) {
    auto participant =
        Participant::Join(name, Loopback(), [this](const std::string& problem) { problems_.Put(problem); });
    if (!participant.ok()) throw std::runtime_error(participant.error().message);
    return std::move(participant).value();
  }

  Inbox<std::string> problems_;
  Participant ground_ = Join("ground");
  Participant drone_ = Join("drone");
};

Capture Picture(std::uint32_t id, std::size_t size) {
  Capture capture;
  capture.vehicle_id = 1;
  capture.capture_id = id;
  capture.intrinsics = {640, 480, 500.0, 500.0, 320.0, 240.0, {}};
  capture.bytes.assign(size, static_cast<std::uint8_t>(id));
  return capture;
}

TEST_F(Dds, BringsAPictureOfAMegabyteWhole) {
  Inbox<Capture> inbox;
  const Reader<CaptureTopic> reader(ground_, [&](Capture capture) { inbox.Put(std::move(capture)); });
  Writer<CaptureTopic> writer(drone_);
  ASSERT_TRUE(writer.WaitForReader(5s));
  ASSERT_TRUE(writer.Write(Picture(9, 1 << 20)));
  const auto received = inbox.Await(1);
  ASSERT_EQ(received.size(), 1u);
  EXPECT_EQ(received[0].bytes, Picture(9, 1 << 20).bytes);
}

TEST_F(Dds, TellsWhenTheReaderOfAPictureIsGone) {
  auto reader = std::make_unique<Reader<CaptureTopic>>(ground_, [](const Capture&) {});
  Writer<CaptureTopic> writer(drone_);
  ASSERT_TRUE(writer.WaitForReader(5s));
  EXPECT_EQ(writer.CountDepartedReaders(), 0);
  reader.reset();
  for (int i = 0; i < 100 && writer.CountDepartedReaders() == 0; ++i) std::this_thread::sleep_for(50ms);
  EXPECT_EQ(writer.CountDepartedReaders(), 1);
  EXPECT_EQ(writer.matched_readers(), 0);
}

TEST_F(Dds, BringsCommandsInOrder) {
  Inbox<std::uint32_t> inbox;
  const Reader<FlightCommandTopic> reader(drone_,
                                          [&](const FlightCommand& command) { inbox.Put(command.sequence); });
  Writer<FlightCommandTopic> writer(ground_);
  ASSERT_TRUE(writer.WaitForReader(5s));
  for (std::uint32_t sequence = 1; sequence <= 3; ++sequence) {
    FlightCommand command;
    command.vehicle_id = 1;
    command.sequence = sequence;
    ASSERT_TRUE(writer.Write(command));
  }
  EXPECT_THAT(inbox.Await(3), ElementsAre(1u, 2u, 3u));
}

TEST_F(Dds, NeverGivesAnOldCommandToALateReader) {
  Writer<FlightCommandTopic> writer(ground_);
  ASSERT_TRUE(writer.Write(FlightCommand()));
  Inbox<FlightCommand> inbox;
  const Reader<FlightCommandTopic> reader(drone_,
                                          [&](FlightCommand command) { inbox.Put(std::move(command)); });
  ASSERT_TRUE(writer.WaitForReader(5s));
  EXPECT_THAT(inbox.Await(1, 300ms), IsEmpty());
}

TEST_F(Dds, NoticesThatAWriterOfStatesIsSilentOrGone) {
  Inbox<int> alive;
  ReaderHandlers<VehicleStateTopic> handlers{[](const VehicleState&) {},
                                             [&](int writers) { alive.Put(writers); }};
  const Reader<VehicleStateTopic> reader(ground_, handlers);
  Writer<VehicleStateTopic> writer(drone_);
  ASSERT_TRUE(writer.WaitForReader(5s));
  // The reader may not know of the writer yet, and what it misses is not sent again.
  for (int i = 0; i < 100 && alive.Await(1, 50ms).empty(); ++i) ASSERT_TRUE(writer.Write(VehicleState()));
  EXPECT_THAT(alive.Await(2, 3s), ElementsAre(1, 0));
}

TEST_F(Dds, ReportsAMessageThatIsNotValidAndGoesOn) {
  Inbox<CommandAck> inbox;
  const Reader<CommandAckTopic> reader(ground_, [&](CommandAck ack) { inbox.Put(std::move(ack)); });
  Writer<CommandAckTopic> writer(drone_);
  ASSERT_TRUE(writer.WaitForReader(5s));
  CommandAck bad;
  bad.status = static_cast<AckStatus>(77);
  ASSERT_TRUE(writer.Write(bad));
  ASSERT_TRUE(writer.Write(CommandAck()));
  EXPECT_EQ(inbox.Await(1).size(), 1u);
  EXPECT_THAT(problems_.Await(1), ElementsAre(HasSubstr("status has an unknown value")));
}

/// The commands' topic with another quality of service: what a foreign program might ask for.
struct LatchedCommandTopic : FlightCommandTopic {
  static constexpr TopicKind kKind = TopicKind::kLatched;
};

TEST_F(Dds, SaysWhoseReaderDoesNotMatchAndWhy) {
  const Reader<LatchedCommandTopic> reader(drone_, [](const FlightCommand&) {});
  const Writer<FlightCommandTopic> writer(ground_);
  EXPECT_THAT(
      problems_.Await(2),
      testing::UnorderedElementsAre(
          "soffit/flight_command/v1: the reader of 'drone' does not fit: durability (transient local "
          "is asked for, volatile is offered)",
          "soffit/flight_command/v1: the writer of 'ground' does not fit: durability (transient local "
          "is asked for, volatile is offered)"));
}

TEST_F(Dds, ListsWhatOthersHave) {
  const Reader<LatchedCommandTopic> reader(
      drone_, [](const FlightCommand&) {}, "soffit/test");
  std::vector<RemoteEndpoint> found;
  for (int i = 0; i < 100 && found.empty(); ++i, std::this_thread::sleep_for(50ms)) {
    found = ground_.Discovered();
  }
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].topic, "soffit/test");
  EXPECT_EQ(found[0].type, "soffit::wire::FlightCommand");
  EXPECT_EQ(found[0].participant, "'drone'");
  EXPECT_FALSE(found[0].is_writer);
  EXPECT_TRUE(found[0].is_latched);
}

TEST(LocalDomain, IsThatOfRos2WhereItIsSet) {
  unsetenv("ROS_DOMAIN_ID");
  EXPECT_EQ(DefaultLocalOptions().domain_id, 42);
  setenv("ROS_DOMAIN_ID", "7", 1);
  EXPECT_EQ(DefaultLocalOptions().domain_id, 7);
  setenv("ROS_DOMAIN_ID", "seven", 1);
  EXPECT_FALSE(Participant::Join("test", DefaultLocalOptions(), {}).ok());
  unsetenv("ROS_DOMAIN_ID");
}

TEST(Join, RefusesAnInterfaceThatIsNoAddress) {
  DdsOptions options;
  options.udp_only = true;
  options.interfaces = {"eth-what"};
  const auto participant = Participant::Join("test", options, {});
  ASSERT_FALSE(participant.ok());
  EXPECT_THAT(participant.error().message, HasSubstr("eth-what"));
}

}  // namespace
}  // namespace soffit
