#pragma once

#include <Eigen/Geometry>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "test/sim/truth/truth.h"
#include "test/sim/world/space.h"
#include "test/sim/world/world.h"

namespace soffit::sim {

/// One flight under a building: in over one side of its footprint, below its roof, and out over another,
/// without having touched anything.
struct FlightUnder {
  std::string object;
  bool is_wanted = false;
  bool is_passable = false;                           ///< The truth knows a passable passage this way.
  Eigen::Vector3d entry_m = Eigen::Vector3d::Zero();  ///< Where the footprint was entered and left.
  Eigen::Vector3d exit_m = Eigen::Vector3d::Zero();
  double begin_s = 0.0;
  double end_s = 0.0;
  double least_distance_m = 0.0;  ///< Of the bare vehicle to any surface, while inside.
};

struct Contact {
  double time_s = 0.0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  std::string with;
};

/// What really happened in a flight: how near the vehicle (the bare cylinder of its envelope, about its
/// reference point) came to anything but the ground, what it touched, and what it flew under. Meeting the
/// ground faster than 1.5 m/s is a contact too.
class FlightRecorder {
 public:
  FlightRecorder(const World& world, const Space& space, const Truth& truth);

  struct Moment {
    double time_s = 0.0;
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    bool is_on_ground = true;
    double touchdown_speed_mps = 0.0;
  };
  /// To be called at least every centimetre of the way. False: the vehicle has just touched something.
  bool Add(const Moment& moment);

  const std::vector<Contact>& contacts() const { return contacts_; }
  const std::vector<FlightUnder>& flights_under() const { return flights_under_; }

  /// least_distance_m and of what, contacts, flights_under, passage_flown (of a wanted building), has_flown,
  /// is_landed.
  nlohmann::json ToJson() const;

 private:
  struct Watched {
    ObjectTruth truth;
    Mesh mesh;
    std::optional<FlightUnder> inside;  ///< While over or in the footprint.
    bool has_roof_above = false;
  };

  void Watch(Watched& watched, const Moment& moment, double distance_m);
  Cylinder VehicleAt(const Eigen::Vector3d& position_m) const;

  const World& world_;
  const Space& space_;
  std::vector<Watched> watched_;
  std::vector<Contact> contacts_;
  std::vector<FlightUnder> flights_under_;
  Moment last_;
  double least_distance_m_ = -1.0;  ///< Negative: has not flown.
  std::string nearest_;
  double greatest_height_m_ = 0.0;
  bool has_flown_ = false;
  bool is_touching_ = false;
};

}  // namespace soffit::sim
