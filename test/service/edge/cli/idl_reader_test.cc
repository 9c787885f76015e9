#include "service/edge/cli/idl_reader.h"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/edge/dds/service_topics.h"

namespace soffit {
namespace {

using testing::HasSubstr;

/// As Fast DDS sends it.
template <class Message>
std::vector<std::uint8_t> Serialize(const Message& message) {
  std::vector<char> bytes(1 << 16);
  eprosima::fastcdr::FastBuffer buffer(bytes.data(), bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN, eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(cdr.getSerializedDataLength())};
}

TEST(ReadIdl, KnowsTheWholeContract) {
  const IdlTypes contract = WireContract();
  for (const char* name :
       {"soffit::wire::SceneReply", "soffit::wire::Capture", "octomap_msgs::msg::dds_::Octomap_",
        "visualization_msgs::msg::dds_::MarkerArray_", "tf2_msgs::msg::dds_::TFMessage_"}) {
    EXPECT_TRUE(contract.contains(name)) << name;
  }
  EXPECT_TRUE(contract.at("soffit::wire::SceneObject")->HasKey());
  EXPECT_FALSE(contract.at("soffit::wire::SceneReply")->HasKey());
}

TEST(ReadIdl, NamesTheLineThatItDoesNotUnderstand) {
  EXPECT_THAT(ReadIdl("module a {\n struct B { c::D e; };\n};").error().message,
              HasSubstr("line 2: the type c::D"));
  EXPECT_THAT(ReadIdl("union U { };").error().message, HasSubstr("'union' is not read"));
  EXPECT_FALSE(ReadIdl("module a {").ok());
}

TEST(DecodeSample, ReadsWhatFastDdsWrites) {
  DecisionReport report;
  report.valid_until_utc_ns = -5;
  report.decision.object_id = 7;
  report.decision.side = -1;
  report.decision.verdict = Verdict::kBlocked;
  report.decision.reason = "too low by 0.05 m";
  report.decision.evidence = {1, 2, 3};
  report.decision.seen_ratio = 0.25;
  const auto sample = DecodeSample(*WireContract().at("soffit::wire::ClearanceDecision"),
                                   Serialize(ClearanceDecisionTopic::ToWire(report)));
  ASSERT_TRUE(sample.ok()) << sample.error().message;
  EXPECT_EQ(sample.value()["object_id"], 7);
  EXPECT_EQ(sample.value()["side"], -1);
  EXPECT_EQ(sample.value()["valid_until_utc_ns"], -5);
  EXPECT_EQ(sample.value()["verdict"], "VERDICT_BLOCKED");
  EXPECT_EQ(sample.value()["reason"], "too low by 0.05 m");
  EXPECT_EQ(sample.value()["evidence_capture_ids"], (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(sample.value()["seen_ratio"], 0.25);
  EXPECT_EQ(sample.value()["has_corridor"], false);
}

TEST(DecodeSample, ReadsBothByteOrders) {
  const IdlTypes types = ReadIdl("struct S { octet a; long b; double c; };").value();
  const std::vector<std::uint8_t> little = {0, 1, 0, 0, 9, 0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xf0, 0x3f};
  const std::vector<std::uint8_t> big = {0, 0, 0, 0, 9, 0, 0, 0, 0, 0, 1, 2, 0x3f, 0xf0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(DecodeSample(*types.at("S"), little).value().dump(), R"({"a":9,"b":258,"c":1.0})");
  EXPECT_EQ(DecodeSample(*types.at("S"), big).value(), DecodeSample(*types.at("S"), little).value());
}

TEST(DecodeSample, TellsLongOctetsByTheirLength) {
  const IdlTypes types = ReadIdl("struct S { sequence<octet> a; };").value();
  std::vector<std::uint8_t> bytes = {0, 1, 0, 0, 100, 0, 0, 0};
  bytes.resize(108);
  EXPECT_EQ(DecodeSample(*types.at("S"), bytes).value()["a"], "100 octets");
}

TEST(DecodeSample, RefusesEveryTruncation) {
  SceneReply reply;
  reply.message = "a message";
  reply.revisions = {{1, 2, 3, 4, 5, 6, 7, true}};
  const auto type = WireContract().at("soffit::wire::SceneReply");
  std::vector<std::uint8_t> bytes = Serialize(SceneReplyTopic::ToWire(reply));
  ASSERT_TRUE(DecodeSample(*type, bytes).ok());
  while (!bytes.empty()) {
    bytes.pop_back();
    ASSERT_FALSE(DecodeSample(*type, bytes).ok()) << bytes.size();
  }
}

TEST(DecodeSample, RefusesMoreItemsThanBytes) {
  const IdlTypes types = ReadIdl("struct S { sequence<double> a; };").value();
  EXPECT_FALSE(DecodeSample(*types.at("S"), {0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff}).ok());
}

}  // namespace
}  // namespace soffit
