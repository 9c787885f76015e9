#include "test/sim/flight/recorder.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace soffit::sim {
namespace {

constexpr double kHardLanding_mps = 1.5;
constexpr double kOtherSide_rad = 0.5;
constexpr double kSamePassage_m = 0.5;
constexpr double kFarthest_m = 5.0;

bool IsInside(const ObjectTruth& object, const Eigen::Vector2d& point) {
  return std::any_of(object.footprint_in_map_m.begin(), object.footprint_in_map_m.end(),
                     [&](const Polygon& polygon) { return Contains(polygon.outer, point); });
}

/// Direction, out of the footprint, of its side that is nearest to a point.
double NearestSideYaw(const ObjectTruth& object, const Eigen::Vector2d& point) {
  double least_m = std::numeric_limits<double>::infinity();
  double yaw_rad = 0.0;
  for (const Polygon& polygon : object.footprint_in_map_m) {
    for (std::size_t i = 0; i < polygon.outer.size(); ++i) {
      const Eigen::Vector2d& a = polygon.outer[i];
      const Eigen::Vector2d& b = polygon.outer[(i + 1) % polygon.outer.size()];
      const double distance_m = DistanceToSegment(point, a, b);
      if (distance_m >= least_m) continue;
      least_m = distance_m;
      yaw_rad =
          std::atan2(a.x() - b.x(), b.y() - a.y());  // To the right of a side that runs counter-clockwise.
    }
  }
  return yaw_rad;
}

/// Whether a surface of the mesh is straight above the point.
bool HasSurfaceAbove(const Mesh& mesh, const Eigen::Vector3d& point) {
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const std::array<int, 3>& corners) {
    const Eigen::Vector3d& a = mesh.vertices_m[static_cast<std::size_t>(corners[0])];
    const Eigen::Vector3d& b = mesh.vertices_m[static_cast<std::size_t>(corners[1])];
    const Eigen::Vector3d& c = mesh.vertices_m[static_cast<std::size_t>(corners[2])];
    const auto cross = [](const Eigen::Vector3d& u, const Eigen::Vector3d& v, const Eigen::Vector3d& p) {
      return (v.x() - u.x()) * (p.y() - u.y()) - (v.y() - u.y()) * (p.x() - u.x());
    };
    const double area = cross(a, b, c);
    if (std::abs(area) < 1e-12) return false;
    const double wa = cross(b, c, point) / area;
    const double wb = cross(c, a, point) / area;
    const double wc = 1.0 - wa - wb;
    return wa >= 0.0 && wb >= 0.0 && wc >= 0.0 && wa * a.z() + wb * b.z() + wc * c.z() > point.z();
  });
}

/// Whether a passable passage of the object runs about this way.
bool IsPassable(const ObjectTruth& object, const Eigen::Vector3d& entry_m, const Eigen::Vector3d& exit_m) {
  return std::any_of(object.passages.begin(), object.passages.end(), [&](const Passage& passage) {
    const Eigen::Vector2d a = passage.entry_m.head<2>();
    const Eigen::Vector2d b = passage.exit_m.head<2>();
    return passage.is_passable && DistanceToSegment(entry_m.head<2>(), a, b) < kSamePassage_m &&
           DistanceToSegment(exit_m.head<2>(), a, b) < kSamePassage_m;
  });
}

nlohmann::json ListOf(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

FlightRecorder::FlightRecorder(const World& world, const Space& space, const Truth& truth)
    : world_(world), space_(space) {
  for (const ObjectTruth& object : truth.objects) {
    if (object.is_absent) continue;
    const auto building = std::find_if(world.buildings.begin(), world.buildings.end(),
                                       [&](const Structure& structure) { return structure.id == object.id; });
    if (building != world.buildings.end())
      watched_.push_back({object, BuildMesh(*building), std::nullopt, false});
  }
}

Cylinder FlightRecorder::VehicleAt(const Eigen::Vector3d& position_m) const {
  return {position_m, world_.vehicle.radius_m, world_.vehicle.height_m};
}

bool FlightRecorder::Add(const Moment& moment) {
  const bool has_landed_hard =
      moment.is_on_ground && !last_.is_on_ground && moment.touchdown_speed_mps > kHardLanding_mps;
  last_ = moment;
  greatest_height_m_ = std::max(greatest_height_m_, moment.position_m.z());
  has_flown_ = has_flown_ || !moment.is_on_ground;

  const auto nearest = space_.DistanceToBodies(VehicleAt(moment.position_m), kFarthest_m);
  if (has_flown_ && (least_distance_m_ < 0.0 || nearest.distance_m < least_distance_m_)) {
    least_distance_m_ = nearest.distance_m;
    nearest_ = nearest.owner;
  }
  for (Watched& watched : watched_) Watch(watched, moment, nearest.distance_m);

  const bool is_touching = nearest.distance_m <= 0.0 || has_landed_hard;
  const bool is_new = is_touching && !is_touching_;
  is_touching_ = is_touching;
  if (is_new)
    contacts_.push_back({moment.time_s, moment.position_m, has_landed_hard ? "ground" : nearest.owner});
  return !is_new;
}

void FlightRecorder::Watch(Watched& watched, const Moment& moment, double distance_m) {
  const Eigen::Vector2d point = moment.position_m.head<2>();
  const bool is_inside = IsInside(watched.truth, point);
  if (is_inside && !watched.inside) {
    watched.inside.emplace();
    watched.inside->object = watched.truth.id;
    watched.inside->is_wanted = watched.truth.is_wanted;
    watched.inside->entry_m = moment.position_m;
    watched.inside->begin_s = moment.time_s;
    watched.inside->least_distance_m = distance_m;
    watched.has_roof_above = false;
  }
  if (!watched.inside) return;
  FlightUnder& flight = *watched.inside;
  if (is_inside) {
    flight.least_distance_m = std::min(flight.least_distance_m, distance_m);
    watched.has_roof_above = watched.has_roof_above || HasSurfaceAbove(watched.mesh, moment.position_m);
    return;
  }
  flight.exit_m = moment.position_m;
  flight.end_s = moment.time_s;
  flight.is_passable = IsPassable(watched.truth, flight.entry_m, flight.exit_m);
  const double turn_rad = std::remainder(NearestSideYaw(watched.truth, flight.exit_m.head<2>()) -
                                             NearestSideYaw(watched.truth, flight.entry_m.head<2>()),
                                         2.0 * M_PI);
  const bool is_whole = contacts_.empty();  // A wreck does not fly.
  if (is_whole && watched.has_roof_above && std::abs(turn_rad) > kOtherSide_rad)
    flights_under_.push_back(flight);
  watched.inside.reset();
}

nlohmann::json FlightRecorder::ToJson() const {
  nlohmann::json contacts = nlohmann::json::array();
  for (const Contact& contact : contacts_) {
    contacts.push_back(
        {{"time_s", contact.time_s}, {"position", ListOf(contact.position_m)}, {"with", contact.with}});
  }
  nlohmann::json flights = nlohmann::json::array();
  bool is_passage_flown = false;
  for (const FlightUnder& flight : flights_under_) {
    is_passage_flown = is_passage_flown || flight.is_wanted;
    flights.push_back({{"object", flight.object},
                       {"wanted", flight.is_wanted},
                       {"passable", flight.is_passable},
                       {"entry", ListOf(flight.entry_m)},
                       {"exit", ListOf(flight.exit_m)},
                       {"begin_s", flight.begin_s},
                       {"end_s", flight.end_s},
                       {"least_distance_m", flight.least_distance_m}});
  }
  nlohmann::json json = {{"has_flown", has_flown_},
                         {"passage_flown", is_passage_flown},
                         {"flights_under", flights},
                         {"contacts", contacts},
                         {"on_ground", last_.is_on_ground},
                         {"position", ListOf(last_.position_m)},
                         {"greatest_height_m", greatest_height_m_}};
  json["least_distance_m"] = least_distance_m_ < 0.0 ? nlohmann::json() : nlohmann::json(least_distance_m_);
  json["nearest"] = nearest_;
  return json;
}

}  // namespace soffit::sim
