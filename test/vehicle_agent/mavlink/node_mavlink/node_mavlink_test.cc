/// Our codec against npm's node-mavlink, another implementation of the same protocol: what one writes, the
/// other reads.
#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>

#include "test/vehicle_agent/mavlink/message_samples.h"
#include "vehicle_agent/mavlink/codec.h"

namespace soffit::mavlink {
namespace {

using nlohmann::json;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Bytes = std::vector<std::uint8_t>;

constexpr SigningKey kKey = {7, 1, 250, 3};

std::int64_t NowUtc_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string ToHex(const Bytes& bytes) {
  std::string hex;
  for (const std::uint8_t byte : bytes) {
    hex += "0123456789abcdef"[byte >> 4];
    hex += "0123456789abcdef"[byte & 15];
  }
  return hex;
}

Bytes FromHex(const std::string& hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

/// Visitor that writes the fields as the peer wants them: numbers as text.
struct FieldLister {
  json& fields;

  void Extensions() {}
  template <class T>
  void operator()(std::string_view name, const T& value) {
    fields[std::string(name)] = ToText(value);
  }
  template <class T>
  static json ToText(const T& value) {
    if constexpr (std::is_same_v<T, float>) {
      std::ostringstream text;
      text.precision(12);
      text << value;
      return text.str();
    } else {
      return std::to_string(value);
    }
  }
  template <std::size_t N>
  static json ToText(const std::array<char, N>& value) {
    return TextOf(value);
  }
  template <class T, std::size_t N>
  static json ToText(const std::array<T, N>& values) {
    json list = json::array();
    for (const T& value : values) list.push_back(ToText(value));
    return list;
  }
};

/// Runs the peer in the folder that the build prepared, with `questions` as its input.
std::vector<json> AskPeer(const std::string& folder, const std::vector<json>& questions) {
  const auto file =
      std::filesystem::temp_directory_path() / ("soffit_node_mavlink_" + std::to_string(::getpid()));
  std::ofstream input(file);
  for (const json& question : questions) input << question.dump() << "\n";
  input.close();
  const std::string command = "node '" + folder + "/peer.js' < '" + file.string() + "'";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string output;
  std::array<char, 65536> chunk{};
  for (std::size_t count; (count = std::fread(chunk.data(), 1, chunk.size(), pipe)) > 0;) {
    output.append(chunk.data(), count);
  }
  EXPECT_EQ(::pclose(pipe), 0) << command;
  std::filesystem::remove(file);
  std::vector<json> answers;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) answers.push_back(json::parse(line));
  return answers;
}

TEST(NodeMavlink, AgreesWithOurCodecAboutEveryMessage) {
  const char* folder = std::getenv("SOFFIT_NODE_MAVLINK");
  ASSERT_NE(folder, nullptr) << "run this test by ctest, which installs node-mavlink first";
  if (!std::filesystem::exists(std::filesystem::path(folder) / "node_modules/node-mavlink")) {
    GTEST_SKIP() << "npm could not install node-mavlink in " << folder;
  }

  std::mt19937_64 random(11);
  std::vector<json> questions;
  std::vector<std::function<Bytes(const Frame&)>> recoders;  // Our reading of a frame, coded again.
  std::vector<const MessageInfo*> infos;
  Signer signer(kKey, 2);
  constexpr int kSamplesOfEach = 3;
  ForEachMessageType([&]<class Message>(std::type_identity<Message>) {
    for (int i = 0; i < kSamplesOfEach; ++i) {
      // The last sample is nearly empty, so that trailing zeros are left out.
      const auto message = i + 1 < kSamplesOfEach ? RandomMessage<Message>(random) : Message{};
      json fields = json::object();
      Message::Visit(message, FieldLister{fields});
      const Bytes packet = Encoder(1, 191).Encode(message);
      recoders.push_back([](const Frame& frame) { return Encoder(1, 191).Encode(*Decode<Message>(frame)); });
      infos.push_back(FindMessage(Message::kId));
      Bytes signed_packet = packet;
      signer.Sign(signed_packet, NowUtc_ns());
      questions.push_back({{"id", Message::kId},
                           {"packet", ToHex(packet)},
                           {"signed", ToHex(signed_packet)},
                           {"key", ToHex({kKey.begin(), kKey.end()})},
                           {"fields", fields}});
    }
  });

  const auto answers = AskPeer(folder, questions);
  ASSERT_EQ(answers.size(), questions.size());
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const json& answer = answers[i];
    SCOPED_TRACE(std::string(infos[i]->name));
    EXPECT_EQ(answer["name"], infos[i]->name);
    EXPECT_EQ(answer["crc_extra"], infos[i]->crc_extra);
    EXPECT_EQ(answer["base_length"], infos[i]->base_length);
    EXPECT_EQ(answer["full_length"], infos[i]->full_length);
    EXPECT_EQ(answer["fields"], questions[i]["fields"]);
    EXPECT_EQ(answer["is_signature_right"], true);
    const Bytes signed_packet = FromHex(answer["signed"]);
    EXPECT_THAT(FrameParser(SignatureGuard(kKey, NowUtc_ns())).Feed(signed_packet), SizeIs(1));
    EXPECT_THAT(FrameParser(SignatureGuard(SigningKey{}, NowUtc_ns())).Feed(signed_packet), IsEmpty());
    for (const char* version : {"v1", "v2"}) {
      if (answer[version].is_null()) continue;  // MAVLink 1 has no ids above 255.
      const auto frames = FrameParser().Feed(FromHex(answer[version]));
      ASSERT_THAT(frames, SizeIs(1)) << version;
      EXPECT_EQ(ToHex(recoders[i](frames[0])), questions[i]["packet"]) << version;
    }
  }
}

}  // namespace
}  // namespace soffit::mavlink
