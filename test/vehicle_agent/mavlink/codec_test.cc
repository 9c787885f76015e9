#include "vehicle_agent/mavlink/codec.h"

#include <gmock/gmock.h>

#include <random>

#include "test/vehicle_agent/mavlink/message_samples.h"
#include "vehicle_agent/mavlink/constants.h"

namespace soffit::mavlink {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;
using Bytes = std::vector<std::uint8_t>;

void Append(Bytes& all, const Bytes& more) { all.insert(all.end(), more.begin(), more.end()); }

Bytes EncodeOnce(const auto& message) { return Encoder(1, 191).Encode(message); }

/// The same message in MAVLink 1, made from the packet of version 2.
Bytes AsVersion1(const Bytes& v2, const MessageInfo& info) {
  Bytes payload(v2.begin() + 10, v2.end() - 2);
  payload.resize(info.base_length);
  Bytes v1 = {0xfe, static_cast<std::uint8_t>(payload.size()), v2[4], v2[5], v2[6], v2[7]};
  Append(v1, payload);
  std::uint16_t crc = 0xffff;
  for (std::size_t i = 1; i < v1.size(); ++i) crc = AddToChecksum(crc, v1[i]);
  crc = AddToChecksum(crc, info.crc_extra);
  v1.push_back(static_cast<std::uint8_t>(crc));
  v1.push_back(static_cast<std::uint8_t>(crc >> 8));
  return v1;
}

TEST(Checksum, IsThatOfTheStandardsCheckString) {
  std::uint16_t crc = 0xffff;
  for (const char c : std::string_view("123456789")) crc = AddToChecksum(crc, static_cast<std::uint8_t>(c));
  EXPECT_EQ(crc, 0x6f91);  // CRC-16/MCRF4XX.
}

TEST(FindMessage, KnowsThePublishedCrcExtraOfCommonMessages) {
  EXPECT_EQ(FindMessage(Heartbeat::kId)->crc_extra, 50);
  EXPECT_EQ(FindMessage(CommandLong::kId)->crc_extra, 152);
  EXPECT_EQ(FindMessage(SetPositionTargetLocalNed::kId)->crc_extra, 143);
  EXPECT_EQ(FindMessage(Statustext::kId)->crc_extra, 83);
  EXPECT_EQ(FindMessage(HomePosition::kId)->crc_extra, 104);
  EXPECT_EQ(FindMessage(AutopilotVersion::kId)->crc_extra, 178);
  EXPECT_EQ(FindMessage(GpsRawInt::kId)->base_length, 30u);
  EXPECT_EQ(FindMessage(GpsRawInt::kId)->full_length, 52u);
}

TEST(FindMessage, FindsNothingForAMessageThatWeDoNotUse) { EXPECT_EQ(FindMessage(12345), nullptr); }

TEST(Codec, GivesBackEveryFieldOfEveryMessage) {
  std::mt19937_64 random(1);
  ForEachMessageType([&]<class Message>(std::type_identity<Message>) {
    for (int i = 0; i < 20; ++i) {
      const Bytes packet = EncodeOnce(RandomMessage<Message>(random));
      const auto frames = FrameParser().Feed(packet);
      ASSERT_THAT(frames, SizeIs(1)) << Message::kName;
      const auto decoded = Decode<Message>(frames[0]);
      ASSERT_TRUE(decoded.has_value()) << Message::kName;
      EXPECT_EQ(EncodeOnce(*decoded), packet) << Message::kName;
    }
  });
}

TEST(Codec, ReadsMavlinkOne) {
  std::mt19937_64 random(2);
  ForEachMessageType([&]<class Message>(std::type_identity<Message>) {
    if (Message::kId > 255) return;
    const auto message = RandomMessage<Message>(random);
    const auto frames = FrameParser().Feed(AsVersion1(EncodeOnce(message), InfoOf<Message>()));
    ASSERT_THAT(frames, SizeIs(1)) << Message::kName;
    EXPECT_EQ(frames[0].version, 1);
    EXPECT_EQ(frames[0].component_id, 191);
    EXPECT_TRUE(Decode<Message>(frames[0]).has_value());
  });
}

TEST(Codec, LeavesOutTrailingZerosAndPutsThemBack) {
  Statustext text;
  text.severity = kSeverityCritical;
  text.text = ToTextField<50>("Arm: Need Position Estimate");
  const Bytes packet = EncodeOnce(text);
  EXPECT_EQ(packet.size(), 10u + 1u + 27u + 2u);
  const auto decoded = Decode<Statustext>(FrameParser().Feed(packet).at(0));
  EXPECT_EQ(TextOf(decoded->text), "Arm: Need Position Estimate");
  EXPECT_EQ(decoded->id, 0);
}

TEST(Codec, KeepsOneByteOfAMessageThatIsAllZero) { EXPECT_EQ(EncodeOnce(SystemTime{})[1], 1); }

TEST(Codec, KeepsATextThatFillsItsFieldWithoutNul) {
  ParamValue value;
  value.param_id = ToTextField<16>("SIXTEEN_CHARS_XXand more");
  EXPECT_EQ(TextOf(value.param_id), "SIXTEEN_CHARS_XX");
}

TEST(Codec, ReadsNothingFromAFrameOfAnotherMessage) {
  const auto frames = FrameParser().Feed(EncodeOnce(Heartbeat{}));
  EXPECT_FALSE(Decode<Attitude>(frames.at(0)).has_value());
}

TEST(Encoder, CountsItsPacketsAndWrapsAround) {
  Encoder encoder(7, 9);
  Bytes stream;
  for (int i = 0; i < 300; ++i) Append(stream, encoder.Encode(Heartbeat{}));
  const auto frames = FrameParser().Feed(stream);
  ASSERT_THAT(frames, SizeIs(300));
  EXPECT_EQ(frames[0].sequence, 0);
  EXPECT_EQ(frames[299].sequence, 299 - 256);
  EXPECT_EQ(frames[299].system_id, 7);
  EXPECT_EQ(frames[299].component_id, 9);
}

TEST(FrameParser, TakesAPacketThatComesByteByByte) {
  std::mt19937_64 random(3);
  FrameParser parser;
  const Bytes packet = EncodeOnce(RandomMessage<GpsRawInt>(random));
  for (std::size_t i = 0; i + 1 < packet.size(); ++i) {
    ASSERT_THAT(parser.Feed(std::span(packet).subspan(i, 1)), IsEmpty());
  }
  EXPECT_THAT(parser.Feed(std::span(packet).last(1)), SizeIs(1));
}

TEST(FrameParser, FindsEveryPacketBetweenGarbage) {
  std::mt19937_64 random(4);
  Bytes stream;
  int sent = 0;
  Encoder encoder(1, 1);
  for (int round = 0; round < 200; ++round) {
    ForEachMessageType([&]<class Message>(std::type_identity<Message>) {
      const std::size_t garbage = random() % 40;
      for (std::size_t i = 0; i < garbage; ++i) {
        // Line noise, but nothing that begins like a packet: that may swallow the next one, see below.
        const auto byte = static_cast<std::uint8_t>(random());
        stream.push_back(byte == 0xfd || byte == 0xfe ? 0 : byte);
      }
      Append(stream, encoder.Encode(RandomMessage<Message>(random)));
      ++sent;
    });
  }
  FrameParser parser;
  int received = 0;
  for (std::size_t start = 0; start < stream.size();) {
    const std::size_t count = std::min<std::size_t>(1 + random() % 700, stream.size() - start);
    received += static_cast<int>(parser.Feed(std::span(stream).subspan(start, count)).size());
    start += count;
  }
  EXPECT_EQ(received, sent);
  EXPECT_GT(parser.dropped_byte_count(), 0u);
}

TEST(FrameParser, LosesNothingToGarbageThatBeginsLikeAPacket) {
  FrameParser parser;
  Bytes stream = {0xfd, 0xff, 0, 0, 0, 1, 1, 0, 0, 0};  // A heartbeat of 255 bytes, so it says.
  Encoder encoder(1, 1);
  for (int i = 0; i < 20; ++i) Append(stream, encoder.Encode(SystemTime{1, 2}));
  EXPECT_THAT(parser.Feed(stream), SizeIs(20));
}

TEST(FrameParser, NeverTakesADamagedPacket) {
  std::mt19937_64 random(5);
  const Bytes packet = EncodeOnce(RandomMessage<LocalPositionNed>(random));
  for (std::size_t byte = 1; byte < packet.size(); ++byte) {
    for (int bit = 0; bit < 8; ++bit) {
      if (byte == 3) continue;  // Compatibility flags may be anything; the checksum still covers them.
      Bytes damaged = packet;
      damaged[byte] = static_cast<std::uint8_t>(damaged[byte] ^ 1 << bit);
      EXPECT_THAT(FrameParser().Feed(damaged), IsEmpty()) << "byte " << byte << " bit " << bit;
    }
  }
}

TEST(FrameParser, SkipsPacketsThatItDoesNotKnow) {
  Bytes unknown = {0xfd, 3, 0, 0, 0, 1, 1, 0x39, 0x30, 0, 0xfd, 0xfe, 0xfd, 0, 0};
  Bytes stream = unknown;
  Append(stream, EncodeOnce(Heartbeat{}));
  FrameParser parser;
  EXPECT_THAT(parser.Feed(stream), SizeIs(1));
  EXPECT_EQ(parser.dropped_byte_count(), 0u);
}

TEST(FrameParser, SkipsTheSignatureOfASignedPacket) {
  std::mt19937_64 random(6);
  Bytes packet = EncodeOnce(RandomMessage<Attitude>(random));
  packet.resize(packet.size() - 2);
  packet[2] = 0x01;
  std::uint16_t crc = 0xffff;
  for (std::size_t i = 1; i < packet.size(); ++i) crc = AddToChecksum(crc, packet[i]);
  crc = AddToChecksum(crc, InfoOf<Attitude>().crc_extra);
  packet.push_back(static_cast<std::uint8_t>(crc));
  packet.push_back(static_cast<std::uint8_t>(crc >> 8));
  packet.resize(packet.size() + 13, 0xfd);
  Append(packet, EncodeOnce(Heartbeat{}));
  EXPECT_THAT(FrameParser().Feed(packet), SizeIs(2));
}

TEST(FrameParser, RefusesPacketsWithFlagsThatItDoesNotUnderstand) {
  Bytes packet = EncodeOnce(Heartbeat{});
  packet[2] = 0x02;
  EXPECT_THAT(FrameParser().Feed(packet), IsEmpty());
}

TEST(FrameParser, SurvivesRandomBytesAndThenStillReads) {
  std::mt19937_64 random(7);
  FrameParser parser;
  std::size_t found_in_noise = 0;
  for (int i = 0; i < 2000; ++i) {
    Bytes noise(random() % 600);
    for (auto& byte : noise) byte = random() % 4 == 0 ? 0xfd : static_cast<std::uint8_t>(random());
    found_in_noise += parser.Feed(noise).size();
  }
  EXPECT_LE(found_in_noise, 20u);  // One in 65536 looks like a packet by chance.
  std::size_t found = 0;
  for (int i = 0; i < 40; ++i) found += parser.Feed(EncodeOnce(Heartbeat{1, 2, 3, 4, 5, 6})).size();
  EXPECT_GE(found, 20u);  // At most one false length (280 bytes) is waited for.
}

TEST(Decode, IgnoresFieldsThatANewerSenderAdds) {
  Frame frame;
  frame.message_id = Heartbeat::kId;
  frame.payload = {1, 0, 0, 0, 2, 3, 4, 5, 6, 99, 99, 99};
  const auto heartbeat = Decode<Heartbeat>(frame);
  EXPECT_EQ(heartbeat->custom_mode, 1u);
  EXPECT_EQ(heartbeat->mavlink_version, 6);
}

}  // namespace
}  // namespace soffit::mavlink
