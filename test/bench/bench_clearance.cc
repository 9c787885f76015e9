#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <set>
#include <thread>

#include "test/bench/judgement.h"
#include "test/bench/scanned.h"
#include "test/sim/draw/draw.h"

namespace soffit::bench {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Judgement, seed, kind, is_passable, spare_m, decision, reason, pictures,
                                   has_false_clear, is_unsafe, true_margin_m, claimed_margin_m, seconds)

namespace {

struct Order {
  std::uint64_t first_seed = 1;
  int worlds = 100;
  std::vector<std::uint64_t> seeds;
  int jobs = 1;
  int width_px = 640;
  int looks = 0;
  std::vector<std::filesystem::path> scans;
  std::filesystem::path log;
  std::filesystem::path out;
};

/// The same view with fewer or more pixels.
Intrinsics Resize(const Intrinsics& lens, int width_px) {
  const double scale = static_cast<double>(width_px) / lens.width_px;
  Intrinsics resized = lens;
  resized.width_px = width_px;
  resized.height_px = static_cast<int>(scale * lens.height_px);
  resized.fx_px *= scale;
  resized.fy_px *= scale;
  resized.cx_px = (lens.cx_px + 0.5) * scale - 0.5;
  resized.cy_px = (lens.cy_px + 0.5) * scale - 0.5;
  return resized;
}

std::vector<Judgement> ReadLog(const std::filesystem::path& file) {
  std::vector<Judgement> judgements;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    judgements.push_back(nlohmann::json::parse(line).get<Judgement>());
  return judgements;
}

std::vector<sim::World> ReadScans(const std::vector<std::filesystem::path>& files) {
  std::vector<sim::World> worlds;
  for (const std::filesystem::path& file : files) {
    Result<std::vector<sim::World>> scanned = BuildScannedWorlds(file);
    if (!scanned.ok()) throw std::runtime_error(scanned.error().message);
    for (sim::World& world : scanned.value()) worlds.push_back(std::move(world));
  }
  return worlds;
}

/// Judges what the log does not have yet. The seeds of scanned worlds are their numbers.
std::vector<Judgement> JudgeAll(const Order& order) {
  const std::vector<sim::World> scanned = ReadScans(order.scans);
  std::vector<Judgement> judgements = ReadLog(order.log);
  std::set<std::uint64_t> left(order.seeds.begin(), order.seeds.end());
  if (order.seeds.empty()) {
    const std::uint64_t first = scanned.empty() ? order.first_seed : 0;
    const std::uint64_t count = scanned.empty() ? static_cast<std::uint64_t>(order.worlds) : scanned.size();
    for (std::uint64_t i = 0; i < count; ++i) left.insert(first + i);
  }
  for (const Judgement& judgement : judgements) left.erase(judgement.seed);
  const std::vector<std::uint64_t> seeds(left.begin(), left.end());

  std::ofstream log(order.log, std::ios::app);
  std::atomic<std::size_t> next = 0;
  std::mutex telling;
  const auto work = [&] {
    for (std::size_t i = next++; i < seeds.size(); i = next++) {
      sim::World world = scanned.empty() ? sim::DrawNastyWorld(seeds[i]) : scanned.at(seeds[i]);
      world.camera.intrinsics = Resize(world.camera.intrinsics, order.width_px);
      const std::filesystem::path folder = order.out.empty() ? "" : order.out / world.name;
      const Judgement judgement = JudgeWorld(world, seeds[i], order.looks, folder);
      const std::lock_guard lock(telling);
      judgements.push_back(judgement);
      log << nlohmann::json(judgement).dump() << std::endl;
      std::printf("%6llu %-44s %-8s %+5.2f m  %-17s %s%s%s\n",
                  static_cast<unsigned long long>(judgement.seed), judgement.kind.c_str(),
                  judgement.is_passable ? "passable" : "closed", judgement.spare_m,
                  judgement.decision.c_str(), judgement.has_false_clear ? "FALSE CLEAR " : "",
                  judgement.is_unsafe ? "UNSAFE " : "", judgement.reason.c_str());
      std::fflush(stdout);
    }
  };
  std::vector<std::jthread> threads;
  for (int i = 0; i < order.jobs; ++i) threads.emplace_back(work);
  threads.clear();
  return judgements;
}

struct Row {
  int worlds = 0, false_clear = 0, is_unsafe = 0;
  std::map<std::string, int> decisions;

  void Add(const Judgement& judgement) {
    ++worlds;
    ++decisions[judgement.decision];
    false_clear += judgement.has_false_clear ? 1 : 0;
    is_unsafe += judgement.is_unsafe ? 1 : 0;
  }
};

void Print(const std::string& kind, const char* truly, Row row) {
  std::printf("%-44s %-8s %6d %6d %8d %13d %6d %12d %7d\n", kind.c_str(), truly, row.worlds,
              row.decisions["CLEAR"], row.decisions["BLOCKED"], row.decisions["INSUFFICIENT_DATA"],
              row.decisions["none"], row.false_clear, row.is_unsafe);
}

void PrintMatrix(const std::vector<Judgement>& judgements) {
  std::map<std::pair<std::string, bool>, Row> rows;
  Row passable, closed;
  for (const Judgement& judgement : judgements) {
    rows[{judgement.kind, judgement.is_passable}].Add(judgement);
    (judgement.is_passable ? passable : closed).Add(judgement);
  }
  std::printf("\n%-44s %-8s %6s %6s %8s %13s %6s %12s %7s\n", "kind", "truly", "worlds", "clear", "blocked",
              "insufficient", "none", "false clear", "unsafe");
  for (const auto& [key, row] : rows) Print(key.first, key.second ? "passable" : "closed", row);
  Print("all", "passable", passable);
  Print("all", "closed", closed);
}

template <class Is>
void PrintSeeds(const char* what, const std::vector<Judgement>& judgements, const Is& is) {
  std::set<std::uint64_t> seeds;
  for (const Judgement& judgement : judgements) {
    if (is(judgement)) seeds.insert(judgement.seed);
  }
  std::printf("%s: %zu (%.1f %%)", what, seeds.size(),
              100.0 * static_cast<double>(seeds.size()) / static_cast<double>(judgements.size()));
  for (const std::uint64_t seed : seeds) std::printf(" %llu", static_cast<unsigned long long>(seed));
  std::printf("\n");
}

void PrintSummary(const std::vector<Judgement>& judgements) {
  PrintSeeds("false CLEAR", judgements, [](const Judgement& j) { return j.has_false_clear; });
  PrintSeeds("unsafe corridor", judgements, [](const Judgement& j) { return j.is_unsafe; });
  PrintSeeds("false BLOCKED", judgements,
             [](const Judgement& j) { return j.is_passable && j.decision == "BLOCKED"; });
  PrintSeeds("INSUFFICIENT_DATA, passable", judgements,
             [](const Judgement& j) { return j.is_passable && j.decision == "INSUFFICIENT_DATA"; });
  PrintSeeds("INSUFFICIENT_DATA, closed", judgements,
             [](const Judgement& j) { return !j.is_passable && j.decision == "INSUFFICIENT_DATA"; });
  PrintSeeds("not recognized", judgements, [](const Judgement& j) { return j.decision == "none"; });
  const Judgement* least = nullptr;
  double seconds = 0.0;
  for (const Judgement& judgement : judgements) {
    seconds += judgement.seconds;
    if (judgement.claimed_margin_m < 0.0) continue;
    if (least == nullptr || judgement.true_margin_m < least->true_margin_m) least = &judgement;
  }
  if (least != nullptr)
    std::printf("least true margin of a CLEAR corridor: %.3f m (claimed: %.3f m), seed %llu\n",
                least->true_margin_m, least->claimed_margin_m, static_cast<unsigned long long>(least->seed));
  std::printf("%.1f s of one core each\n", seconds / static_cast<double>(judgements.size()));
}

int Run(const Order& order) {
  cv::setNumThreads(1);
  const std::vector<Judgement> judgements = JudgeAll(order);
  PrintMatrix(judgements);
  PrintSummary(judgements);
  return std::any_of(judgements.begin(), judgements.end(),
                     [](const Judgement& j) { return j.has_false_clear || j.is_unsafe; })
             ? 1
             : 0;
}

}  // namespace
}  // namespace soffit::bench

int main(int argc, char** argv) {
  soffit::bench::Order order;
  CLI::App app(
      "Judges random nasty worlds from surveys of pictures from fixed places, and counts by kind of world "
      "what "
      "was decided. Ends with 1 when a CLEAR was false or its corridor without the stated margin");
  app.add_option("--first-seed", order.first_seed, "Of the first world");
  app.add_option("--worlds", order.worlds, "How many")->check(CLI::PositiveNumber);
  app.add_option("--seed", order.seeds, "Just these, instead");
  app.add_option("--jobs", order.jobs, "At the same time")->check(CLI::Range(1, 256));
  app.add_option("--width", order.width_px, "Of the pictures, in pixels")->check(CLI::Range(160, 4000));
  app.add_option("--looks", order.looks, "Pictures more, where the decision asks for them")
      ->check(CLI::Range(0, 20));
  app.add_option("--scan", order.scans, "CityGML files of buildings with a passage, instead of drawn worlds")
      ->check(CLI::ExistingFile);
  app.add_option("--log", order.log, "One line of JSON a world; those that are there are not judged again");
  app.add_option("--out", order.out, "Keeps worlds, surveys and analyses there");
  CLI11_PARSE(app, argc, argv);
  try {
    return soffit::bench::Run(order);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "bench_clearance: %s\n", problem.what());
    return 2;
  }
}
