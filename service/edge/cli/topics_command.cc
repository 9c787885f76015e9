#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "service/edge/cli/commands.h"
#include "service/edge/cli/request_client.h"

namespace soffit {
namespace {

struct TopicsArguments {
  LocalDomain place;
  double wait_s = 2.0;
  bool prints_json = false;
};

struct TopicLine {
  std::string type;
  bool is_latched = false;
  std::set<std::string> writers;
  std::set<std::string> readers;
};

std::string Join(const std::set<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all.empty() ? "nobody" : all;
}

void RunTopics(const TopicsArguments& arguments) {
  const auto participant = JoinLocalDomain(arguments.place);
  if (!participant.ok()) {
    std::cerr << "soffit topics: " << participant.error().message << '\n';
    throw CLI::RuntimeError(1);
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(arguments.wait_s));
  std::map<std::string, TopicLine> topics;
  for (const RemoteEndpoint& endpoint : participant.value().Discovered()) {
    TopicLine& topic = topics[endpoint.topic];
    topic.type = endpoint.type;
    topic.is_latched = topic.is_latched || (endpoint.is_writer && endpoint.is_latched);
    (endpoint.is_writer ? topic.writers : topic.readers).insert(endpoint.participant);
  }
  if (arguments.prints_json) {
    nlohmann::json all = nlohmann::json::object();
    for (const auto& [name, topic] : topics) {
      all[name] = {{"type", topic.type},
                   {"latched", topic.is_latched},
                   {"writers", topic.writers},
                   {"readers", topic.readers}};
    }
    std::cout << all.dump(1) << '\n';
    return;
  }
  for (const auto& [name, topic] : topics) {
    std::cout << name << "\n    " << topic.type << (topic.is_latched ? ", latched" : "") << "; from "
              << Join(topic.writers) << " to " << Join(topic.readers) << '\n';
  }
  if (topics.empty()) std::cout << "nobody else is on this domain\n";
}

}  // namespace

void AddTopicsCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("topics", "Lists the topics of the local domain, and who writes and reads them");
  const auto arguments = std::make_shared<TopicsArguments>();
  AddLocalDomainOptions(*command, arguments->place);
  command->add_option("--wait", arguments->wait_s, "Seconds to listen")->check(CLI::Range(0.1, 60.0));
  command->add_flag("--json", arguments->prints_json, "For programs");
  command->callback([arguments] { RunTopics(*arguments); });
}

}  // namespace soffit
