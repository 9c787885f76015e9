// How right footprints are: random worlds, photographed from above by the simulator's camera, against their
// truth.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <opencv2/core/utility.hpp>

#include "service/pipeline/pipeline.h"
#include "test/sim/draw/dice.h"
#include "test/sim/draw/draw.h"
#include "test/sim/render/renderer.h"
#include "test/sim/truth/truth.h"

namespace soffit::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Order {
  std::uint64_t first_seed = 1;
  int worlds = 60;
  double position_std_m = 0.0;
  double orientation_std_deg = 0.0;
  std::string pictures;
  bool is_verbose = false;
};

const sim::Structure* FindWanted(const sim::World& world) {
  for (const sim::Structure& building : world.buildings) {
    if (building.id == world.mission.wanted.front() && !building.is_absent) return &building;
  }
  return nullptr;
}

Eigen::Quaterniond Turn(const Vector3d& rotation) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(rotation.norm(), rotation.stableNormalized()));
}

Vector3d Draw(double std, sim::Dice& dice) {
  return std * Vector3d(dice.Normal(), dice.Normal(), dice.Normal());
}

/// The overview, one from right above the building and one from beside it, all a little tilted.
std::vector<Pose<Map, Camera>> PlacePictures(const sim::World& world, const Polygon& footprint,
                                             double height_m, sim::Dice& dice) {
  const Intrinsics& lens = world.camera.intrinsics;
  const Vector2d center = Centroid(footprint);
  double reach_m = 0.0;
  for (const Vector2d& corner : footprint.outer) reach_m = std::max(reach_m, (corner - center).norm());
  const double beside_m = dice.Between(0.8, 1.8);
  const double direction = dice.Between(-std::numbers::pi, std::numbers::pi);
  const auto altitude = [&](double reach) {
    return std::max(4.0, height_m + reach * lens.fx_px / (0.42 * lens.height_px));
  };
  const Vector2d beside = center + beside_m * Vector2d(std::cos(direction), std::sin(direction));
  const Vector2d area = world.mission.area_center_m;
  std::vector<Pose<Map, Camera>> poses;
  for (const Vector3d& from : {Vector3d(area.x(), area.y(), world.mission.overview_altitude_m),
                               Vector3d(center.x(), center.y(), altitude(reach_m)),
                               Vector3d(beside.x(), beside.y(), altitude(reach_m + beside_m))}) {
    const double yaw = dice.Between(-std::numbers::pi, std::numbers::pi);
    poses.push_back({(Turn(Draw(0.007, dice)) * CameraAttitude(yaw, -std::numbers::pi / 2)).normalized(),
                     from + Draw(0.03, dice)});
  }
  return poses;
}

std::vector<std::uint8_t> TakePicture(const sim::World& world, std::unique_ptr<sim::Renderer>& renderer,
                                      const Pose<Map, Camera>& pose, std::uint64_t seed,
                                      const std::filesystem::path& file) {
  if (std::ifstream kept(file, std::ios::binary); kept) {
    return {std::istreambuf_iterator<char>(kept), std::istreambuf_iterator<char>()};
  }
  if (!renderer) renderer = std::make_unique<sim::Renderer>(world, 1);
  std::vector<std::uint8_t> bytes =
      sim::EncodeJpeg(renderer->Render({{pose}, seed}), world.camera.jpeg_quality, 0);
  if (!file.empty()) {
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  }
  return bytes;
}

/// Area of the intersection over that of the union, on a grid.
double IntersectionOverUnion(const Ring& a, const Ring& b) {
  constexpr int kCells = 600;
  Vector2d low = a.front(), high = low;
  for (const Ring* ring : {&a, &b}) {
    for (const Vector2d& p : *ring) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  double both = 0.0, any = 0.0;
  for (int i = 0; i < kCells * kCells; ++i) {
    const int column = i % kCells;
    const int row = i / kCells;
    const Vector2d share((column + 0.5) / kCells, (row + 0.5) / kCells);
    const Vector2d p = low + (high - low).cwiseProduct(share);
    const bool in_a = Contains(a, p);
    const bool in_b = Contains(b, p);
    both += in_a && in_b ? 1.0 : 0.0;
    any += in_a || in_b ? 1.0 : 0.0;
  }
  return both / any;
}

/// How far corners of one ring lie from the other, at most; both ways.
double FarthestCorner_m(const Ring& a, const Ring& b) {
  double farthest = 0.0;
  for (const Vector2d& p : a) farthest = std::max(farthest, DistanceToRing(p, b));
  for (const Vector2d& p : b) farthest = std::max(farthest, DistanceToRing(p, a));
  return farthest;
}

/// Without steps that no picture from above shows: of painted and shallow niches.
Ring WithoutSmallSteps(Ring ring) {
  constexpr double kSmall_m = 0.03;
  for (std::size_t i = 0; ring.size() > 3 && i < ring.size();) {
    const std::size_t n = ring.size();
    if (DistanceToSegment(ring[i], ring[(i + n - 1) % n], ring[(i + 1) % n]) < kSmall_m) {
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
      i = 0;
    } else {
      ++i;
    }
  }
  return ring;
}

/// What became of buildings of one kind, seen in so many pictures.
struct Tally {
  int buildings = 0, missed = 0, cut = 0, wrong_corner_counts = 0, unknown_heights = 0, overrated = 0;
  std::vector<double> iou, corner_m, shape_m, height_m;
};

void Add(const Footprint* seen, const Polygon& truth, double height_m, Tally& tally) {
  ++tally.buildings;
  if (seen == nullptr) {
    ++tally.missed;
    return;
  }
  if (seen->is_cut) {
    ++tally.cut;
    return;
  }
  if (seen->height_m == 0.0) {
    ++tally.unknown_heights;
    return;
  }
  Ring ring = seen->polygon_in_map_m.outer;
  tally.wrong_corner_counts += ring.size() != truth.outer.size() ? 1 : 0;
  tally.iou.push_back(IntersectionOverUnion(truth.outer, ring));
  tally.corner_m.push_back(FarthestCorner_m(truth.outer, ring));
  tally.height_m.push_back(std::abs(seen->height_m - height_m));
  const double corner_std_m = *std::max_element(seen->corner_std_m.begin(), seen->corner_std_m.end());
  tally.overrated +=
      tally.height_m.back() > 3.0 * seen->height_std_m || tally.corner_m.back() > 3.0 * corner_std_m ? 1 : 0;
  const Vector2d shift = Centroid({truth.outer, {}}) - Centroid({ring, {}});
  for (Vector2d& p : ring) p += shift;
  tally.shape_m.push_back(FarthestCorner_m(truth.outer, ring));
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::lround(share * static_cast<double>(values.size() - 1)))];
}

void Print(const std::string& name, const Tally& t) {
  std::printf("%-18s %4d %6d %4d %8d %8d %9d   %.4f %.4f   %5.3f %5.3f   %5.3f %5.3f   %5.3f %5.3f %5.3f\n",
              name.c_str(), t.buildings, t.missed, t.cut, t.unknown_heights, t.wrong_corner_counts,
              t.overrated, Quantile(t.iou, 0.5), Quantile(t.iou, 0.1), Quantile(t.shape_m, 0.5),
              Quantile(t.shape_m, 0.9), Quantile(t.corner_m, 0.5), Quantile(t.corner_m, 0.9),
              Quantile(t.height_m, 0.5), Quantile(t.height_m, 0.9), Quantile(t.height_m, 1.0));
}

/// The footprint of this colour that lies nearest to the truth.
const Footprint* FindSeen(const std::vector<Footprint>& map, const Polygon& truth) {
  const Footprint* nearest = nullptr;
  double least = 0.7;
  for (const Footprint& f : map) {
    const double distance = (Centroid(f.polygon_in_map_m) - Centroid(truth)).norm();
    if (distance < least) {
      least = distance;
      nearest = &f;
    }
  }
  return nearest;
}

void Look(const Order& order, std::uint64_t seed, std::map<std::string, Tally>& tallies) {
  const sim::World world = sim::DrawWorld(seed);
  const sim::Structure* wanted = FindWanted(world);
  if (wanted == nullptr) return;
  const std::vector<Polygon> pieces = sim::FindFootprint(*wanted);
  if (pieces.size() != 1) return;
  const Polygon truth{WithoutSmallSteps(pieces.front().outer), {}};
  double height_m = 0.0;
  for (const sim::Part& part : wanted->parts) {
    const auto* prism = std::get_if<sim::Prism>(&part.shape);
    if (prism == nullptr) return;
    if (!prism->is_lying) {
      height_m = std::max(height_m, prism->high_m);
    } else {
      for (const Vector2d& p : prism->section.outer) height_m = std::max(height_m, p.y());
    }
  }
  sim::Dice dice(seed);
  std::unique_ptr<sim::Renderer> renderer;
  std::vector<Footprint> map;
  std::uint32_t id = 0;
  for (const Pose<Map, Camera>& pose : PlacePictures(world, truth, height_m, dice)) {
    ++id;
    const std::string name = std::to_string(seed) + "_" + std::to_string(id) + ".jpg";
    Capture capture;
    capture.capture_id = id;
    capture.name = name;
    capture.purpose = id == 1 ? Purpose::kOverview : Purpose::kTop;
    capture.intrinsics = world.camera.intrinsics;
    capture.position_std_m = order.position_std_m;
    capture.orientation_std_rad = order.orientation_std_deg * std::numbers::pi / 180.0;
    capture.map_from_camera = {(Turn(Draw(capture.orientation_std_rad, dice)) * pose.rotation).normalized(),
                               pose.translation_m + Draw(order.position_std_m, dice)};
    capture.bytes = TakePicture(world, renderer, pose, seed + id,
                                order.pictures.empty() ? "" : std::filesystem::path(order.pictures) / name);
    const Result<Observation> seen = Observe(capture, {});
    if (!seen.ok()) throw std::runtime_error(seen.error().message);
    map = MergeFootprints(map, seen.value().footprints);
    const Footprint* found = FindSeen(map, truth);
    const std::string kind = truth.outer.size() == 4 ? "box" : "concave";
    Tally one;
    Add(found, truth, height_m, one);
    Add(found, truth, height_m, tallies[kind + ", " + std::to_string(id) + " pictures"]);
    if (order.is_verbose) {
      Print(std::to_string(seed) + " " + kind.substr(0, 7) + " " + std::to_string(id), one);
      if (found != nullptr) {
        std::printf("    %zu corners of %zu, height %.3f +- %.3f of %.3f\n",
                    found->polygon_in_map_m.outer.size(), truth.outer.size(), found->height_m,
                    found->height_std_m, height_m);
      }
    }
  }
}

int Run(const Order& order) {
  cv::setNumThreads(1);
  std::printf("%-18s %4s %6s %4s %8s %8s %9s   %6s %6s   %11s   %11s   %s\n", "median, 90 %", "n", "missed",
              "cut", "unknown", "corners", ">3 sigma", "IoU", "", "shape m", "outline m", "height m, worst");
  std::map<std::string, Tally> tallies;
  for (int i = 0; i < order.worlds; ++i)
    Look(order, order.first_seed + static_cast<std::uint64_t>(i), tallies);
  for (const auto& [name, tally] : tallies) Print(name, tally);
  return 0;
}

}  // namespace
}  // namespace soffit::bench

int main(int argc, char** argv) {
  soffit::bench::Order order;
  CLI::App app("Measures footprints from one, two and three pictures from above of random worlds");
  app.add_option("--first-seed", order.first_seed, "Of the first world");
  app.add_option("--worlds", order.worlds, "How many")->check(CLI::PositiveNumber);
  app.add_option("--position-std", order.position_std_m, "Noise of the reported poses, m per axis");
  app.add_option("--orientation-std-deg", order.orientation_std_deg,
                 "And of their attitude, degrees per axis");
  app.add_option("--pictures", order.pictures,
                 "Keeps the pictures in this folder, and takes them from there");
  app.add_flag("--verbose", order.is_verbose, "A line for each building");
  CLI11_PARSE(app, argc, argv);
  try {
    return soffit::bench::Run(order);
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "bench_footprint: %s\n", problem.what());
    return 2;
  }
}
