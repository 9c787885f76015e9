#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "test/sim/world/world.h"

namespace soffit::sim {

/// A straight way under or through a building.
struct Passage {
  Eigen::Vector3d entry_m = Eigen::Vector3d::Zero();  ///< Centre of the vehicle, outside of the footprint.
  Eigen::Vector3d exit_m = Eigen::Vector3d::Zero();
  double free_width_m = 0.0;  ///< Of the free rectangle that is best relative to the need.
  double free_height_m = 0.0;
  double ratio = 0.0;  ///< min(free width / needed width, free height / needed height).
  bool is_passable =
      false;             ///< The vehicle with its margin sweeps through, approach included, touching nothing.
  double spare_m = 0.0;  ///< By how much width or height exceed the need, the smaller; negative: short by.
};

struct ObjectTruth {
  std::string id;
  bool is_wanted = false;
  bool is_absent = false;
  std::vector<Polygon>
      footprint_in_map_m;  ///< Vertical projection of everything of it; one polygon when connected.
  double height_m = 0.0;
  std::vector<Passage> passages;  ///< Best first, no two nearly the same; also those that are too tight.
};

/// Vertical projection of everything of the building, largest piece first.
std::vector<Polygon> FindFootprint(const Structure& building);

/// How a mission has to end. The zero value: nothing is flown.
enum class Outcome { kNotFlown, kFlown, kNoMatch };
const char* ToString(Outcome outcome);  ///< "not-flown", "flown", "no-match".

struct Truth {
  Outcome expected = Outcome::kNotFlown;
  std::string reason;                ///< For people.
  std::vector<ObjectTruth> objects;  ///< All buildings.
};

/// Computes the truth from the geometry alone: for each building, straight horizontal lines in all directions
/// are tried (across each side, along the largest walls, and every 5 degrees): everything between the ends of
/// the line is projected along it, and in that section the free rectangle under the building is sought that
/// is best relative to the need (resolution 5 mm); passable ones are swept with the exact cylinder. About a
/// second per building.
Truth FindTruth(const World& world);

nlohmann::json ToJson(const Truth& truth);

}  // namespace soffit::sim
