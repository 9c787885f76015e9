#include <iostream>
#include <memory>
#include <mutex>
#include <thread>

#include "service/edge/cli/commands.h"
#include "service/edge/cli/request_client.h"
#include "shared/result/say.h"

namespace soffit {
namespace {

struct WatchArguments {
  LocalDomain place;
  double duration_s = 0.0;
};

void Print(std::uint32_t vehicle_id, std::uint64_t revision, const std::string& text) {
  std::cout << Say("vehicle ", vehicle_id, ", revision ", revision, ": ", text) << std::endl;
}

void PrintObject(const SceneObjectReport& report) {
  const Footprint& footprint = report.object.footprint;
  Print(report.origin.vehicle_id, report.origin.scene_revision,
        Say("building ", footprint.object_id, ", ", footprint.color, ", ",
            footprint.polygon_in_map_m.outer.size(), " corners, ", Area(footprint.polygon_in_map_m), " m2, ",
            footprint.height_m, " m high", report.object.is_matched ? ", the wanted one" : ""));
}

void PrintModel(const BuildingModelReport& report) {
  Print(report.origin.vehicle_id, report.origin.scene_revision,
        Say("model of building ", report.object_id, ": ", report.volume_m3, " m3, ",
            report.mesh.triangles.size(), " triangles, ", report.openings.size(), " openings"));
}

void PrintDecision(const DecisionReport& report) {
  const ClearanceDecision& decision = report.decision;
  Print(decision.vehicle_id, decision.scene_revision,
        Say("building ", decision.object_id, ", side ", decision.side, ": ", ToString(decision.verdict), ": ",
            decision.reason));
}

/// All callbacks run on one thread of the participant.
void RunWatch(const WatchArguments& arguments) {
  const auto participant = JoinLocalDomain(arguments.place);
  if (!participant.ok()) {
    std::cerr << "soffit scene: " << participant.error().message << '\n';
    throw CLI::RuntimeError(1);
  }
  const Reader<SceneObjectTopic> objects(participant.value(), PrintObject);
  const Reader<BuildingModelTopic> models(participant.value(), PrintModel);
  const Reader<ClearanceDecisionTopic> decisions(participant.value(), PrintDecision);
  if (arguments.duration_s > 0.0) {
    std::this_thread::sleep_for(std::chrono::duration<double>(arguments.duration_s));
  } else {
    while (true) std::this_thread::sleep_for(std::chrono::hours(1));
  }
}

}  // namespace

void AddSceneCommand(CLI::App& app) {
  CLI::App* scene = app.add_subcommand("scene", "The scene of a running soffitd");
  scene->require_subcommand(1);
  CLI::App* watch =
      scene->add_subcommand("watch", "Prints buildings, models and decisions as they become known");
  const auto arguments = std::make_shared<WatchArguments>();
  AddLocalDomainOptions(*watch, arguments->place);
  watch->add_option("--for", arguments->duration_s, "Seconds after which to end; 0: never")
      ->check(CLI::NonNegativeNumber);
  watch->callback([arguments] { RunWatch(*arguments); });
}

}  // namespace soffit
