#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "service/edge/cli/commands.h"
#include "service/edge/cli/request_client.h"

namespace soffit {
namespace {

struct QueryArguments {
  LocalDomain place;
  std::uint32_t vehicle_id = 1;
  std::uint32_t object_id = 0;
  std::vector<double> numbers;
  int timeout_s = 10;
};

[[noreturn]] void Fail(const std::string& message) {
  std::cerr << "soffit query: " << message << '\n';
  throw CLI::RuntimeError(1);
}

template <class T>
T Take(Result<T> result) {
  if (!result.ok()) Fail(result.error().message);
  return std::move(result).value();
}

nlohmann::json ToJson(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

nlohmann::json ToJson(const Ring& ring) {
  nlohmann::json corners = nlohmann::json::array();
  for (const Eigen::Vector2d& corner : ring) corners.push_back({corner.x(), corner.y()});
  return corners;
}

nlohmann::json ToJson(const DecisionReport& report) {
  const ClearanceDecision& decision = report.decision;
  nlohmann::json json = {{"decision", ToString(decision.verdict)},
                         {"decision_id", decision.decision_id},
                         {"side", decision.side},
                         {"reason", decision.reason},
                         {"valid_until_utc_ns", report.valid_until_utc_ns},
                         {"seen_ratio", decision.seen_ratio}};
  if (decision.corridor) {
    json["entry"] = ToJson(decision.corridor->entry_in_map_m);
    json["exit"] = ToJson(decision.corridor->exit_in_map_m);
    json["free_width_m"] = decision.corridor->free_width_m;
    json["free_height_m"] = decision.corridor->free_height_m;
  }
  return json;
}

nlohmann::json ToJson(const SceneReply& reply, SceneQueryKind kind) {
  nlohmann::json json = {{"scene_revision", reply.scene_revision}};
  if (kind == SceneQueryKind::kPoint || kind == SceneQueryKind::kBox)
    json["state"] = ToString(reply.occupancy);
  if (kind == SceneQueryKind::kBox) {
    json["free_ratio"] = reply.free_ratio;
    json["occupied_ratio"] = reply.occupied_ratio;
    json["unknown_ratio"] = reply.unknown_ratio;
  }
  if (reply.object) {
    const SceneObject& object = reply.object->object;
    json["object"] = {{"id", object.footprint.object_id},
                      {"color", object.footprint.color},
                      {"footprint", ToJson(object.footprint.polygon_in_map_m.outer)},
                      {"holes", nlohmann::json::array()},
                      {"height_m", object.footprint.height_m},
                      {"matched", object.is_matched},
                      {"neighbours", object.neighbours}};
    for (const Ring& hole : object.footprint.polygon_in_map_m.holes)
      json["object"]["holes"].push_back(ToJson(hole));
  }
  if (reply.model) {
    json["model"] = {{"volume_m3", reply.model->volume_m3},
                     {"triangles", reply.model->mesh.triangles.size()},
                     {"openings", reply.model->openings.size()}};
  }
  for (const DecisionReport& report : reply.decisions) json["clearance"].push_back(ToJson(report));
  return json;
}

void RunQuery(const QueryArguments& arguments, SceneQueryKind kind) {
  SceneQuery query;
  query.kind = kind;
  query.vehicle_id = arguments.vehicle_id;
  query.object_id = arguments.object_id;
  const std::vector<double>& n = arguments.numbers;
  if (kind == SceneQueryKind::kPoint || kind == SceneQueryKind::kBox) query.min_in_map_m = {n[0], n[1], n[2]};
  if (kind == SceneQueryKind::kBox) query.max_in_map_m = {n[3], n[4], n[5]};
  const Participant participant = Take(JoinLocalDomain(arguments.place));
  SceneClient client(participant);
  const SceneReply reply = Take(client.Ask(query, std::chrono::seconds(arguments.timeout_s)));
  if (!reply.is_answered) Fail(reply.message);
  std::cout << ToJson(reply, kind).dump(1) << '\n';
}

CLI::App* AddKind(CLI::App& query, const std::shared_ptr<QueryArguments>& arguments, SceneQueryKind kind,
                  const std::string& name, const std::string& help) {
  CLI::App* command = query.add_subcommand(name, help);
  command->add_option("--config", arguments->place.config_file,
                      "The configuration of soffitd, for its local domain");
  command->add_option("--domain", arguments->place.domain_id,
                      "Its local domain, before that of the configuration");
  command->add_option("--vehicle", arguments->vehicle_id, "Whose mission's scene");
  command->add_option("--timeout", arguments->timeout_s, "Seconds to wait for the service")
      ->check(CLI::Range(1, 3600));
  command->callback([arguments, kind] { RunQuery(*arguments, kind); });
  return command;
}

}  // namespace

void AddQueryCommand(CLI::App& app) {
  CLI::App* query = app.add_subcommand("query", "Asks a running soffitd about its scene; answers in JSON");
  query->require_subcommand(1);
  const auto arguments = std::make_shared<QueryArguments>();
  AddKind(*query, arguments, SceneQueryKind::kPoint, "point", "Free, occupied or unknown, at a place")
      ->add_option("place", arguments->numbers, "x y z in metres")
      ->expected(3)
      ->required();
  AddKind(*query, arguments, SceneQueryKind::kBox, "box", "Free, occupied or unknown, within a box")
      ->add_option("corners", arguments->numbers, "Lowest and highest corner: x y z x y z in metres")
      ->expected(6)
      ->required();
  AddKind(*query, arguments, SceneQueryKind::kObject, "object",
          "One building of the vector map, and its model")
      ->add_option("id", arguments->object_id, "Id of the object")
      ->required();
  AddKind(*query, arguments, SceneQueryKind::kClearance, "clearance",
          "Whether the vehicle may fly through a building")
      ->add_option("id", arguments->object_id, "Id of the object")
      ->required();
}

}  // namespace soffit
