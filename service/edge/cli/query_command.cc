#include <cmath>
#include <iostream>
#include <memory>

#include "service/edge/cli/commands.h"
#include "service/edge/cli/query_output.h"
#include "service/edge/cli/request_client.h"

namespace soffit {
namespace {

struct QueryArguments {
  LocalDomain place;
  SceneQuery query;
  std::vector<double> places;  // x y, x y z, or x y z x y z
  bool prints_json = false;
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

void RunQuery(const QueryArguments& arguments) {
  SceneQuery query = arguments.query;
  std::vector<double> places = arguments.places;
  places.resize(6);
  query.from_in_map_m = {places[0], places[1], places[2]};
  query.to_in_map_m = {places[3], places[4], places[5]};
  const Participant participant = Take(JoinLocalDomain(arguments.place));
  SceneClient client(participant);
  const auto patience = std::chrono::seconds(static_cast<int>(std::ceil(query.timeout_s)) + 1);
  const SceneReply reply = Take(client.Ask(query, patience));
  if (reply.status != AnswerStatus::kOk) Fail(std::string(ToString(reply.status)) + ": " + reply.message);
  if (arguments.prints_json) {
    std::cout << AnswerToJson(query.kind, reply).dump(1) << '\n';
  } else {
    std::cout << "scene revision " << reply.origin.scene_revision << " of mission " << reply.origin.mission_id
              << '\n'
              << DescribeAnswer(query.kind, reply);
  }
}

/// One subcommand for each kind of question, with the options that count for it.
class QueryCommands {
 public:
  QueryCommands(CLI::App& query, std::shared_ptr<QueryArguments> arguments)
      : query_(query), arguments_(std::move(arguments)) {}

  CLI::App& Add(SceneQueryKind kind, const std::string& name, const std::string& help) {
    CLI::App* command = query_.add_subcommand(name, help);
    AddLocalDomainOptions(*command, arguments_->place);
    command->add_option("--vehicle", arguments_->query.vehicle_id, "Whose mission's scene");
    command->add_option("--revision", arguments_->query.scene_revision,
                        "Of the scene; without it the newest");
    command->add_option("--timeout", arguments_->query.timeout_s, "Seconds that the answer may take")
        ->check(CLI::Range(0.1, 60.0));
    command->add_flag("--json", arguments_->prints_json, "For programs");
    command->callback([arguments = arguments_, kind] {
      arguments->query.kind = kind;
      RunQuery(*arguments);
    });
    return *command;
  }
  void TakesPlace(CLI::App& command, int numbers) {
    command.add_option("place", arguments_->places, numbers == 2 ? "x y in metres" : "x y z in metres")
        ->expected(numbers)
        ->required();
  }
  void TakesEnds(CLI::App& command) {
    command.add_option("places", arguments_->places, "x y z of one and x y z of the other, in metres")
        ->expected(6)
        ->required();
  }
  void TakesResolution(CLI::App& command) {
    command.add_option("--resolution", arguments_->query.resolution_m,
                       "Edge of the cells, m; without it the finest");
  }
  void TakesRange(CLI::App& command, const std::string& help) {
    command.add_option("--range", arguments_->query.range_m, help);
  }
  void TakesObject(CLI::App& command) {
    command.add_option("id", arguments_->query.object_id, "Id of the building")->required();
  }
  void TakesVehicle(CLI::App& command) {
    command.add_option("--radius", arguments_->query.vehicle.radius_m,
                       "Of the vehicle, m; without it the mission's");
    command.add_option("--height", arguments_->query.vehicle.height_m, "Of the vehicle, m");
    command.add_option("--margin", arguments_->query.vehicle.safety_margin_m, "To keep from everything, m");
  }

 private:
  CLI::App& query_;
  std::shared_ptr<QueryArguments> arguments_;
};

}  // namespace

void AddQueryCommand(CLI::App& app) {
  CLI::App* query = app.add_subcommand("query", "Asks a running soffitd about its scene");
  query->require_subcommand(1);
  const auto arguments = std::make_shared<QueryArguments>();
  arguments->query.vehicle_id = 1;
  arguments->query.timeout_s = 10.0;
  QueryCommands commands(*query, arguments);
  using enum SceneQueryKind;

  CLI::App& point = commands.Add(kPoint, "point", "Free, occupied or unknown, at a place");
  commands.TakesPlace(point, 3);
  commands.TakesResolution(point);
  CLI::App& box = commands.Add(kBox, "box", "Free, occupied or unknown, between two corners");
  commands.TakesEnds(box);
  commands.TakesResolution(box);
  CLI::App& ray = commands.Add(kRay, "ray", "What a ray comes to: hit, free, unknown or out of range");
  commands.TakesEnds(ray);
  commands.TakesRange(ray, "How far, m; without it as far as the second place");
  CLI::App& nearest =
      commands.Add(kNearest, "nearest", "The nearest obstacle, unknown cell and model surface");
  commands.TakesPlace(nearest, 3);
  commands.TakesRange(nearest, "How far to look, m");
  commands.TakesPlace(
      commands.Add(kColumn, "column", "What is above each other, how high it is, and whose it is"), 2);
  commands.TakesObject(commands.Add(kObjects, "object", "One building of the vector map, and its model"));
  CLI::App& objects = commands.Add(kObjects, "objects", "The buildings of the vector map, nearest first");
  objects.add_option("--near", arguments->places, "x y in metres")->expected(2);
  commands.TakesRange(objects, "No farther than this, m");
  objects.add_option("--reference", arguments->query.reference_name,
                     "Only those recognized from this picture");
  CLI::App& clearance =
      commands.Add(kClearance, "clearance", "Whether a vehicle may fly under or through a building");
  commands.TakesObject(clearance);
  commands.TakesVehicle(clearance);
  CLI::App& way = commands.Add(kWay, "way", "Whether a vehicle may fly straight between two places");
  commands.TakesEnds(way);
  commands.TakesVehicle(way);
  CLI::App& path = commands.Add(kPath, "path", "A way between two places in space that is known to be free");
  commands.TakesEnds(path);
  commands.TakesVehicle(path);
  commands.Add(kChanges, "changes", "What has changed since a revision")
      .add_option("--since", arguments->query.since_revision, "Revision; without it everything");
  commands.Add(kRevisions, "revisions", "The revisions of the scene");
}

}  // namespace soffit
