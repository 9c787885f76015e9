#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <opencv2/core/utility.hpp>
#include <thread>

#include "test/bench/rehearsal.h"
#include "test/sim/draw/draw.h"

namespace soffit::bench {
namespace {

struct Order {
  std::uint64_t first_seed = 1;
  int worlds = 50;
  int jobs = 2;
  std::vector<std::string> files;
  std::filesystem::path out;
};

struct Count {
  int worlds = 0, right = 0, flown = 0, blocked = 0, insufficient = 0, no_match = 0, other = 0, unsafe = 0;
};

void Add(const RehearsalResult& result, Count& count) {
  ++count.worlds;
  count.right += result.IsRight() ? 1 : 0;
  count.unsafe += result.contacts > 0 || result.was_flown_wrongly ? 1 : 0;
  switch (result.outcome) {
    case MissionOutcome::kFlown:
      ++count.flown;
      break;
    case MissionOutcome::kBlocked:
      ++count.blocked;
      break;
    case MissionOutcome::kInsufficientData:
      ++count.insufficient;
      break;
    case MissionOutcome::kNoMatch:
      ++count.no_match;
      break;
    default:
      ++count.other;
  }
}

void Print(const std::string& name, const Count& c) {
  std::printf("%-28s %6d %6d %6d %8d %13d %9d %6d %7d\n", name.c_str(), c.worlds, c.right, c.flown, c.blocked,
              c.insufficient, c.no_match, c.other, c.unsafe);
}

/// The kind of a world is what its title says before the first comma.
std::string KindOf(const sim::World& world) { return world.title.substr(0, world.title.find(',')); }

int Run(const Order& order) {
  cv::setNumThreads(1);
  const int count = order.files.empty() ? order.worlds : static_cast<int>(order.files.size());
  std::atomic<int> next = 0;
  std::mutex printing;
  std::map<std::string, Count> kinds;
  Count all;
  const auto work = [&] {
    for (int i = next++; i < count; i = next++) {
      const std::uint64_t seed = order.first_seed + static_cast<std::uint64_t>(i);
      sim::World world;
      if (order.files.empty()) {
        world = sim::DrawWorld(seed);
      } else {
        auto read = sim::LoadWorld(order.files[static_cast<std::size_t>(i)]);
        if (!read.ok()) throw std::runtime_error(read.error().message);
        world = std::move(read).value();
      }
      const std::filesystem::path folder = order.out.empty() ? "" : order.out / world.name;
      const RehearsalResult result = Rehearse(world, seed, {}, {}, folder);
      const std::lock_guard lock(printing);
      std::printf("%-12s %-5s %-24s %-10s %-18s %2d pictures, least %5.2f m (%s)  %s%s\n", world.name.c_str(),
                  result.IsRight() ? "ok" : "WRONG", KindOf(world).c_str(), sim::ToString(result.expected),
                  ToString(result.outcome), result.pictures, result.least_distance_m, result.nearest.c_str(),
                  result.first_contact.c_str(), result.message.c_str());
      std::fflush(stdout);
      Add(result, all);
      Add(result, kinds[KindOf(world)]);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < order.jobs; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  std::printf("\n%-28s %6s %6s %6s %8s %13s %9s %6s %7s\n", "kind", "worlds", "right", "flown", "blocked",
              "insufficient", "no match", "other", "unsafe");
  for (const auto& [name, kind] : kinds) Print(name, kind);
  Print("all", all);
  return all.unsafe == 0 && all.right >= 0.96 * all.worlds ? 0 : 1;
}

}  // namespace
}  // namespace soffit::bench

int main(int argc, char** argv) {
  soffit::bench::Order order;
  CLI::App app("Rehearses missions over random worlds, and counts by kind of world how they ended");
  app.add_option("--first-seed", order.first_seed, "Of the first world");
  app.add_option("--worlds", order.worlds, "How many")->check(CLI::PositiveNumber);
  app.add_option("--jobs", order.jobs, "At the same time")->check(CLI::Range(1, 256));
  app.add_option("--out", order.out, "Keeps worlds and pictures there, as `soffit analyze` reads them");
  app.add_option("--world", order.files, "World files, instead of drawn ones");
  CLI11_PARSE(app, argc, argv);
  try {
    return soffit::bench::Run(order);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "bench_rehearsal: %s\n", problem.what());
    return 2;
  }
}
