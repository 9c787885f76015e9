#include "vehicle_agent/mavlink/signing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "vehicle_agent/mavlink/codec.h"

namespace soffit::mavlink {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kNow_ns = 1'700'000'000'000'000'000;
constexpr SigningKey kKey = {1, 2, 3, 4};

Bytes MakeSigned(Signer& signer, std::int64_t utc_ns, std::uint8_t system_id = 1) {
  Heartbeat heartbeat;
  heartbeat.custom_mode = 4;
  Bytes packet = Encoder(system_id, 1).Encode(heartbeat);
  signer.Sign(packet, utc_ns);
  return packet;
}

TEST(Signing, LetsThroughWhatIsSignedByTheKeyOnce) {
  Signer signer(kKey, 1);
  FrameParser parser(SignatureGuard(kKey, kNow_ns));
  const Bytes packet = MakeSigned(signer, kNow_ns);
  EXPECT_THAT(parser.Feed(packet), SizeIs(1));
  EXPECT_THAT(parser.Feed(packet), IsEmpty());                       // Replayed.
  EXPECT_THAT(parser.Feed(MakeSigned(signer, kNow_ns)), SizeIs(1));  // Its stamp is a new one.
  EXPECT_EQ(parser.refused_packet_count(), 1U);
}

TEST(Signing, RefusesWhatIsUnsignedForgedOrOfAnotherKey) {
  Signer stranger(SigningKey{9}, 1);
  Signer signer(kKey, 1);
  FrameParser parser(SignatureGuard(kKey, kNow_ns));
  EXPECT_THAT(parser.Feed(Encoder(1, 1).Encode(Heartbeat{})), IsEmpty());
  EXPECT_THAT(parser.Feed(MakeSigned(stranger, kNow_ns)), IsEmpty());
  Bytes forged = MakeSigned(signer, kNow_ns);
  forged.back() ^= 1;
  EXPECT_THAT(parser.Feed(forged), IsEmpty());
  EXPECT_EQ(parser.refused_packet_count(), 3U);
}

TEST(Signing, RefusesWhatIsOlderThanWhatWasHeard) {
  Signer early(kKey, 1);
  Signer late(kKey, 1);
  FrameParser parser(SignatureGuard(kKey, kNow_ns));
  const Bytes old = MakeSigned(early, kNow_ns);
  EXPECT_THAT(parser.Feed(MakeSigned(late, kNow_ns + 1'000'000)), SizeIs(1));
  EXPECT_THAT(parser.Feed(old), IsEmpty());
}

TEST(Signing, RefusesASenderThatIsAMinuteBehindWhenItIsFirstHeard) {
  Signer signer(kKey, 1);
  Signer other(kKey, 2);
  FrameParser parser(SignatureGuard(kKey, kNow_ns));
  EXPECT_THAT(parser.Feed(MakeSigned(signer, kNow_ns - 61'000'000'000)), IsEmpty());
  EXPECT_THAT(parser.Feed(MakeSigned(other, kNow_ns - 59'000'000'000)), SizeIs(1));
}

TEST(Signing, IsSkippedWhereThereIsNoKey) {
  Signer signer(kKey, 1);
  EXPECT_THAT(FrameParser().Feed(MakeSigned(signer, kNow_ns)), SizeIs(1));
}

TEST(ParseSigningKey, ReadsHexadecimalDigitsAndSaysWhatIsWrong) {
  const auto key = ParseSigningKey(" 00ff" + std::string(60, 'A') + "\n");
  ASSERT_TRUE(key.ok());
  EXPECT_EQ(key.value()[1], 0xff);
  EXPECT_EQ(key.value()[31], 0xaa);
  EXPECT_THAT(ParseSigningKey("").error().message, HasSubstr("64 hexadecimal digits, not 0"));
  EXPECT_THAT(ParseSigningKey(std::string(64, 'x')).error().message, HasSubstr("hexadecimal digits only"));
  EXPECT_THAT(ParseSigningKey(std::string(63, '1') + " ").error().message, HasSubstr("not 63"));
}

}  // namespace
}  // namespace soffit::mavlink
