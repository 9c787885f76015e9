// What soffitd publishes and answers on its local domain, without vehicles and missions: a scene of which
// everything is known. Prints what each client has to print, and goes on until its standard input ends.

#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

#include "service/edge/live/scene_server.h"
#include "test/support/arch_scene.h"

namespace soffit {
namespace {

using namespace std::chrono_literals;

constexpr VehicleEnvelope kEnvelope{0.35, 0.30, 0.25};

std::shared_ptr<const SceneSnapshot> SomeSnapshot() {
  auto snapshot = std::make_shared<SceneSnapshot>();
  snapshot->origin = {1, 77, 7};
  snapshot->stamp_utc_ns = 1'700'000'000'000'000'000;
  snapshot->understanding = std::make_shared<Understanding>(test::ArchUnderstanding());
  snapshot->vehicle = kEnvelope;
  snapshot->reference_name = "arch.png";
  DecisionReport report;
  report.mission_id = 77;
  report.decision = snapshot->understanding->decisions.front();
  report.decision.vehicle_id = 1;
  snapshot->decisions = {report};
  return snapshot;
}

VehicleState SomeState() {
  VehicleState state;
  state.vehicle_id = 1;
  state.stamp_utc_ns = 1;
  state.origin = GeodeticOrigin{50.0, 20.0, 200.0};
  return state;
}

Capture SomeCapture() {
  Capture capture;
  capture.vehicle_id = 1;
  capture.exposure_utc_ns = 1;
  capture.intrinsics = {640, 480, 500.0, 500.0, 319.5, 239.5, {}};
  capture.bytes.assign(200'000, 0xff);
  return capture;
}

void PrintTruth(const SceneSnapshot& snapshot) {
  const octomap::OcTree& tree = *snapshot.understanding->scene.octree;
  const double voxel_m3 = std::pow(tree.getResolution(), 3);
  double volumes_m3[2] = {0.0, 0.0};
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf)
    volumes_m3[tree.isNodeOccupied(*leaf) ? 1 : 0] += std::pow(leaf.getSize(), 3);
  const Scene& scene = snapshot.understanding->scene;
  std::cout << "cyclone_client: free_cells " << std::llround(volumes_m3[0] / voxel_m3)
            << "\ncyclone_client: occupied_cells " << std::llround(volumes_m3[1] / voxel_m3)
            << "\ncyclone_client: triangles " << scene.solids.front().mesh.triangles.size() << '\n';
  for (const SceneObject& object : scene.objects) {
    std::cout << "fast_dds_example: building " << object.footprint.object_id << ", " << object.footprint.color
              << ", " << object.footprint.height_m << " m high\n";
  }
  std::cout << "ready" << std::endl;
}

int Run() {
  const auto report = [](const std::string& problem) { std::cerr << problem << '\n'; };
  const auto local = Participant::Join("scene server", DefaultLocalOptions(), report);
  if (!local.ok()) {
    std::cerr << local.error().message << '\n';
    return 1;
  }
  SceneServer server(local.value(), {});
  const auto snapshot = SomeSnapshot();
  server.Publish(snapshot);
  server.ros().PublishWaypoints(1, 1, {{0, 0, 1}, {2, 0, 1}});
  const std::jthread vehicle([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      server.ros().PublishState(SomeState());
      server.ros().PublishCapture(SomeCapture());
      std::this_thread::sleep_for(100ms);
    }
  });
  PrintTruth(*snapshot);
  std::string line;
  while (std::getline(std::cin, line)) continue;
  return 0;
}

}  // namespace
}  // namespace soffit

int main() { return soffit::Run(); }
