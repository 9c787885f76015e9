#include "shared/dds/fragment_counter.h"

#include <gtest/gtest.h>

#include <random>

namespace soffit::dds_internal {
namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes kHeader = {'R', 'T', 'P', 'S', 2, 3, 1, 15, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
const Bytes kInfoTimestamp = {0x09, 1, 8, 0, 1, 2, 3, 4, 5, 6, 7, 8};

/// A DATA_FRAG submessage, little-endian, with four bytes of data.
Bytes Fragments(std::uint8_t writer, std::uint8_t sample, std::uint8_t first, std::uint8_t count) {
  return {0x16,   1, 36, 0, 0,     0, 28, 0, 0,     0, 0, 0, 0,  0, 0, writer, 0, 0, 0, 0,
          sample, 0, 0,  0, first, 0, 0,  0, count, 0, 4, 0, 64, 0, 0, 0,      1, 2, 3, 4};
}

Bytes Message(const std::vector<Bytes>& submessages) {
  Bytes message = kHeader;
  for (const Bytes& submessage : submessages)
    message.insert(message.end(), submessage.begin(), submessage.end());
  return message;
}

TEST(FragmentCounter, TellsFragmentsThatWereSentBefore) {
  FragmentCounter counter;
  counter.Note(Message({kInfoTimestamp, Fragments(1, 1, 1, 4)}));
  counter.Note(Message({kInfoTimestamp, Fragments(1, 1, 5, 1)}));
  EXPECT_EQ(counter.sent(), 5u);
  EXPECT_EQ(counter.sent_again(), 0u);
  counter.Note(Message({kInfoTimestamp, Fragments(1, 1, 4, 3)}));
  EXPECT_EQ(counter.sent(), 8u);
  EXPECT_EQ(counter.sent_again(), 2u);
}

TEST(FragmentCounter, KeepsSamplesAndWritersApart) {
  FragmentCounter counter;
  counter.Note(Message({Fragments(1, 1, 1, 2), Fragments(1, 2, 1, 2), Fragments(2, 1, 1, 2)}));
  EXPECT_EQ(counter.sent(), 6u);
  EXPECT_EQ(counter.sent_again(), 0u);
}

TEST(FragmentCounter, LeavesAloneWhatIsNoMessage) {
  FragmentCounter counter;
  counter.Note({});
  counter.Note(Fragments(1, 1, 1, 1));
  counter.Note(Message({kInfoTimestamp}));
  Bytes cut = Message({Fragments(1, 1, 1, 1)});
  cut.resize(kHeader.size() + 20);
  counter.Note(cut);
  EXPECT_EQ(counter.sent(), 0u);
}

TEST(FragmentCounter, SurvivesRandomDamage) {
  FragmentCounter counter;
  std::mt19937 random(1);
  const Bytes whole = Message({kInfoTimestamp, Fragments(1, 1, 1, 2), Fragments(1, 2, 1, 2)});
  for (int i = 0; i < 100'000; ++i) {
    Bytes damaged = whole;
    for (int n = 0; n < 3; ++n) damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
    damaged.resize(random() % (damaged.size() + 1));
    counter.Note(damaged);
  }
}

}  // namespace
}  // namespace soffit::dds_internal
