#include <chrono>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <iostream>
#include <memory>
#include <thread>

#include "service/edge/cli/commands.h"
#include "service/edge/cli/idl_reader.h"
#include "service/edge/cli/request_client.h"
#include "shared/dds/bus.h"

namespace soffit {
namespace {

using namespace std::chrono_literals;
namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

constexpr auto kPatience = 5s;

/// Texts that are no UTF-8 are shown as far as they are.
std::string Show(const nlohmann::ordered_json& value, int indent) {
  return value.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

struct EchoArguments {
  LocalDomain place;
  std::string topic;
  int count = 0;
  double duration_s = 0.0;
};

[[noreturn]] void Fail(const std::string& message) {
  std::cerr << "soffit echo: " << message << '\n';
  throw CLI::RuntimeError(1);
}

/// Samples of a type that is known by its IDL, as the bytes that they are.
class SerializedType : public dds::TopicDataType {
 public:
  using Bytes = std::vector<std::uint8_t>;

  SerializedType(const std::string& name, std::shared_ptr<const IdlType> type) : type_(std::move(type)) {
    setName(name.c_str());
    m_isGetKeyDefined = type_->HasKey();
    m_typeSize = 1024;  // To begin with: what is longer is allocated as it comes.
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void*, rtps::SerializedPayload_t*) override { return false; }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
    return [] { return 0U; };
  }
  void* createData() override { return new Bytes(); }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }

  /// Where a writer sends no hash of the key: one of our own.
  bool getKey(void* data, rtps::InstanceHandle_t* handle, bool) override {
    const auto sample = DecodeSample(*type_, *static_cast<Bytes*>(data));
    if (!type_->HasKey() || !sample.ok()) return false;
    std::string key;
    for (const IdlType::Member& member : type_->members) {
      if (member.is_key) key += Show(sample.value()[member.name], -1) + '/';
    }
    const std::size_t hash = std::hash<std::string>()(key);
    for (std::size_t i = 0; i < 16; ++i) handle->value[i] = static_cast<std::uint8_t>(hash >> 8 * (i % 8));
    return true;
  }

 private:
  std::shared_ptr<const IdlType> type_;
};

/// The writer of the topic, once there is one.
RemoteEndpoint AwaitWriter(const Participant& participant, const std::string& topic) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < end) {
    for (const RemoteEndpoint& endpoint : participant.Discovered()) {
      if (endpoint.is_writer && endpoint.topic == topic) return endpoint;
    }
    std::this_thread::sleep_for(50ms);
  }
  Fail("nobody writes " + topic + " (soffit topics lists what there is)");
}

TopicKind KindOf(const RemoteEndpoint& writer) {
  if (writer.is_latched) return TopicKind::kLatched;
  return writer.is_reliable ? TopicKind::kStream : TopicKind::kState;
}

void RunEcho(const EchoArguments& arguments) {
  const auto participant = JoinLocalDomain(arguments.place);
  if (!participant.ok()) Fail(participant.error().message);
  const RemoteEndpoint writer = AwaitWriter(participant.value(), arguments.topic);
  const IdlTypes contract = WireContract();
  const auto type = contract.find(writer.type);
  if (type == contract.end())
    Fail("the type " + writer.type + " of " + arguments.topic + " is none of Soffit's");

  const auto& bus = participant.value().bus();
  dds::DataReader* reader = bus->MakeReader(
      arguments.topic, dds::TypeSupport(new SerializedType(writer.type, type->second)), KindOf(writer));
  const auto began = std::chrono::steady_clock::now();
  const auto is_over = [&] {
    return arguments.duration_s > 0.0 &&
           std::chrono::steady_clock::now() - began > std::chrono::duration<double>(arguments.duration_s);
  };
  SerializedType::Bytes bytes;
  dds::SampleInfo info;
  for (int shown = 0; !is_over() && (arguments.count == 0 || shown < arguments.count);) {
    if (reader->take_next_sample(&bytes, &info) != eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      std::this_thread::sleep_for(10ms);
      continue;
    }
    if (!info.valid_data) continue;
    const auto sample = DecodeSample(*type->second, bytes);
    if (!sample.ok()) Fail("a sample of " + arguments.topic + " is malformed: " + sample.error().message);
    std::cout << Show(sample.value(), 1) << std::endl;
    ++shown;
  }
  bus->Remove(reader);
}

}  // namespace

void AddEchoCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("echo", "Prints what is sent on a topic of the local domain, as JSON");
  const auto arguments = std::make_shared<EchoArguments>();
  AddLocalDomainOptions(*command, arguments->place);
  command
      ->add_option("topic", arguments->topic, "As DDS names it, for example rt/tf or soffit/scene_object/v1")
      ->required();
  command->add_option("--count", arguments->count, "Samples after which to end; 0: never")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--for", arguments->duration_s, "Seconds after which to end; 0: never")
      ->check(CLI::NonNegativeNumber);
  command->callback([arguments] { RunEcho(*arguments); });
}

}  // namespace soffit
